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
  int rounds = 2;         ///< each further round compares the surfaces as registered so far, in space and in time
  int snapshots = 32;     ///< times a sequence gives to the principal components
  int velocities = 128;   ///< intervals at which its velocity is evaluated
};

/// The second moving surface F2 is brought to the first by O F2(gamma(s), temporal.second_time(t)), which stands beside
/// F1(s, temporal.first_time(t)): zeta(t) and t, except in partial and cyclic alignment.
struct MovingRegistration {
  SpatialResult spatial;
  TemporalResult temporal;
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

/// Projections of O F(gamma(s), time(t)) on harmonics at equidistant t.
template <AnimatedSurface F, class Time>
std::vector<HarmonicSurface> harmonic_stack(const F& surface, const SpatialResult& registration, const Time& time,
                                            const RegistrationOptions& options) {
  const int times = std::max(1, options.spatial_times), degree = surface_degree(options.spatial);
  const SphereQuadrature q = projection_nodes(degree);
  const Mat3X y = registration.gamma(q.points);
  std::vector<HarmonicSurface> stack(std::size_t(times), HarmonicSurface(Eigen::MatrixX3d::Zero(1, 3)));
  parallel_for(times, options.spatial.threads, [&](int k) {
    const double t = times > 1 ? double(k) / (times - 1) : 0.0;
    const Mat3X values = registration.rotation * positions(surface, y, time(t));
    stack[std::size_t(k)] = project_on_harmonics(values, q, degree);
  });
  return stack;
}

}  // namespace detail

/// Registers the second moving surface to the first. Both should be centred and of mean area 1 (see normalize).
/// sphere   unit vertices and triangles on which the surfaces are compared in time
template <AnimatedSurface F1, AnimatedSurface F2>
MovingRegistration register_moving(const F1& first, const F2& second, const TriangleMesh& sphere,
                                   const RegistrationOptions& options = {}, const Progress& progress = {}) {
  MovingRegistration result;
  const auto first_time = [&](double t) { return result.temporal.first_time(t); };
  const auto second_time = [&](double t) { return result.temporal.second_time(t); };
  const SurfaceSamples target_samples = sample(first, {}, sphere.vertices, options);
  for (int round = 0; round < std::max(1, options.rounds); ++round) {
    const auto target = detail::harmonic_stack(first, {}, first_time, options);
    const auto moved = detail::harmonic_stack(second, result.spatial, second_time, options);
    result.spatial = round == 0 ? register_harmonic(target, moved, options.spatial, progress)
                                : refine_harmonic(target, moved, result.spatial, options.spatial, progress);
    const std::vector<SurfaceSamples> samples{target_samples, sample(second, result.spatial, sphere.vertices, options)};
    const FunctionalPca pca = joint_pca(samples, sphere, options);
    result.temporal = register_temporally(shape_curve(samples[0], pca), shape_curve(samples[1], pca), options.temporal);
    report(progress, "temporal registration", double(round + 1) / options.rounds);
  }
  return result;
}

}  // namespace dsns
