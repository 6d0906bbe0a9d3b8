#pragma once
/// Bringing moving surfaces into correspondence in space and time: spatial registration jointly over several times, then the
/// principal components of all, then temporal registration of the curves they trace.
#include <dsns/elastic/registered_surface.hpp>
#include <dsns/elastic/spatial_registration.hpp>
#include <dsns/elastic/temporal_registration.hpp>
#include <dsns/mesh/triangle_mesh.hpp>
#include <dsns/stats/pca.hpp>

namespace dsns {

struct RegistrationOptions {
  SpatialOptions spatial;
  TemporalOptions temporal;
  PcaOptions pca;
  int spatial_times = 5;  ///< spatial registration compares the surfaces at this many times
  /// At most. After the first each refines, in space and in time, until the clock does not move: then space would meet the
  /// problem that it has just solved.
  int rounds = 4;
  double clock_settled = 1e-3;  ///< L2 from one round to the next, in shares of the clip
  int snapshots = 32;           ///< times a sequence gives to the principal components
  int velocities = 128;         ///< intervals at which its velocity is evaluated
};

/// The second moving surface F2 is brought to the first by O F2(gamma(s), temporal.second_time(t)), which stands beside
/// F1(s, temporal.first_time(t)): zeta(t) and t, except in partial and cyclic alignment.
struct MovingRegistration {
  SpatialResult spatial;
  TemporalResult temporal;
  int rounds = 0;          ///< of space and time
  double clock_moved = 0;  ///< in the last round: L2, in shares of the clip
};

/// A moving surface on the vertices of a sphere mesh, seen through its spatial registration but at its own times.
struct SurfaceSamples {
  std::vector<Mat3X> snapshots;   ///< at equidistant times, each 3 x n
  std::vector<Mat3X> velocities;  ///< at equidistant times
};

/// Values and velocities of O F(gamma(s), t) at the vertices of a sphere mesh.
template <AnimatedSurface F>
SurfaceSamples sample(const F& surface, const SpatialResult& registration, const Mat3X& sphere,
                      const RegistrationOptions& options) {
  const Mat3X y = registration.gamma(sphere);
  SurfaceSamples samples;
  samples.snapshots.resize(std::size_t(options.snapshots));
  samples.velocities.resize(std::size_t(options.velocities) + 1);
  const int total = options.snapshots + options.velocities + 1;
  parallel_for(total, options.spatial.threads, [&](int k) {
    if (k < options.snapshots) {
      const double t = double(k) / (options.snapshots - 1);
      samples.snapshots[std::size_t(k)] = registration.rotation * positions(surface, y, t);
    } else {
      const int j = k - options.snapshots;
      samples.velocities[std::size_t(j)] =
          registration.rotation * velocities(surface, y, double(j) / options.velocities);
    }
  });
  return samples;
}

/// One basis for all samples at the vertices of the sphere mesh. Weights: a third of the area around each vertex, averaged
/// over all surfaces and times, where options.spatial.mask lets it.
inline FunctionalPca joint_pca(const std::vector<SurfaceSamples>& samples, const TriangleMesh& sphere,
                               const RegistrationOptions& options) {
  std::vector<Mat3X> all;
  for (const auto& s : samples) all.insert(all.end(), s.snapshots.begin(), s.snapshots.end());
  require(!all.empty(), "joint_pca: no samples, give at least one surface");
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(all.front().cols());
  for (const auto& x : all) weights += vertex_areas(x, sphere.faces) / double(all.size());
  if (options.spatial.mask) weights.array() *= options.spatial.mask(sphere.vertices).array();
  return {all, weights, options.pca};
}

/// The curve that a sampled surface traces in the space of the components; velocities are projected, never differenced.
inline Curve shape_curve(const SurfaceSamples& samples, const FunctionalPca& pca) {
  Eigen::MatrixXd velocity(pca.modes(), Index(samples.velocities.size()));
  for (std::size_t k = 0; k < samples.velocities.size(); ++k)
    velocity.col(Index(k)) = pca.project_velocity(samples.velocities[k]);
  return {pca.project(samples.snapshots.front()), std::move(velocity)};
}

namespace detail {

/// Projections of a moving surface on harmonics at equidistant times.
template <AnimatedSurface F>
std::vector<HarmonicSurface> harmonic_stack(const F& surface, const RegistrationOptions& options) {
  const int degree = surface_degree(options.spatial);
  const SphereQuadrature q = projection_nodes(degree);
  const TimeWarp clock;
  std::vector<HarmonicSurface> stack;
  for (const Mat3X& values :
       MovingStack<F, TimeWarp>{surface, clock, std::max(1, options.spatial_times), options.spatial.threads}.positions(
           q.points))
    stack.push_back(project_on_harmonics(values, q, degree));
  return stack;
}

/// With both on clocks of their own.
template <AnimatedSurface F1, AnimatedSurface F2, class Time1, class Time2>
SpatialResult refined(const F1& first, const F2& second, const SpatialResult& former, const Time1& first_time,
                      const Time2& second_time, const RegistrationOptions& options, const Progress& progress) {
  const int times = std::max(1, options.spatial_times), threads = options.spatial.threads;
  return refine_registration(MovingStack<F1, Time1>{first, first_time, times, threads},
                             MovingStack<F2, Time2>{second, second_time, times, threads}, former, options.spatial,
                             progress);
}

}  // namespace detail

/// Registers the second moving surface to the first in space alone: equal times correspond. Both should be centred and of mean
/// area 1 (see normalize).
template <AnimatedSurface F1, AnimatedSurface F2>
SpatialResult register_in_space(const F1& first, const F2& second, const RegistrationOptions& options = {},
                                const Progress& progress = {}) {
  const SpatialResult found = register_harmonic(detail::harmonic_stack(first, options),
                                                detail::harmonic_stack(second, options), options.spatial, progress);
  return detail::refined(first, second, found, TimeWarp(), TimeWarp(), options, progress);
}

/// Registers the second moving surface to the first. Both should be centred and of mean area 1 (see normalize).
/// sphere   unit vertices and triangles on which the surfaces are compared in time
template <AnimatedSurface F1, AnimatedSurface F2>
MovingRegistration register_moving(const F1& first, const F2& second, const TriangleMesh& sphere,
                                   const RegistrationOptions& options = {}, const Progress& progress = {}) {
  MovingRegistration result;
  const auto first_time = [&](double t) { return result.temporal.first_time(t); };
  const auto second_time = [&](double t) { return result.temporal.second_time(t); };
  const SurfaceSamples target_samples = sample(first, {}, sphere.vertices, options);
  const auto settled = [&] { return result.rounds > 1 && result.clock_moved < options.clock_settled; };
  for (int round = 0; round < std::max(1, options.rounds) && !settled(); ++round) {
    const TimeWarp clock = result.temporal.warp;
    if (round == 0)
      result.spatial = register_harmonic(detail::harmonic_stack(first, options),
                                         detail::harmonic_stack(second, options), options.spatial, progress);
    else
      result.spatial = detail::refined(first, second, result.spatial, first_time, second_time, options, progress);
    const std::vector<SurfaceSamples> samples{target_samples, sample(second, result.spatial, sphere.vertices, options)};
    const FunctionalPca pca = joint_pca(samples, sphere, options);
    result.temporal = register_temporally(shape_curve(samples[0], pca), shape_curve(samples[1], pca), options.temporal);
    result.rounds = round + 1;
    result.clock_moved = distance(clock, result.temporal.warp);
    report(progress, "temporal registration", settled() ? 1 : double(round + 1) / options.rounds);
  }
  return result;
}

}  // namespace dsns
