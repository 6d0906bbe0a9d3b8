#pragma once
/// The mean of moving surfaces: co-registered in space to their own mean, their curves in the space of joint principal components
/// are averaged up to warps of time, and the mean curve is a moving surface on a mesh of the sphere.
#include <dsns/elastic/geodesic.hpp>
#include <dsns/stats/group_registration.hpp>
#include <dsns/stats/karcher_mean.hpp>
#include <dsns/surface/sampled.hpp>

namespace dsns {

struct MovingMeanOptions {
  RegistrationOptions registration;  ///< spatial.threads: members at a time
  GroupOptions group;                ///< its own `registration` is not used
  KarcherOptions karcher;
};

struct MovingMean {
  GroupRegistration group;
  TriangleMesh sphere;         ///< unit vertices and triangles: where the frames are
  FunctionalPca pca;           ///< of all, registered in space
  std::vector<Curve> members;  ///< the surfaces in its components, on their own clocks
  KarcherMean curves;          ///< its warps take every surface to the mean's clock

  /// Points of a curve on the grid of time_grid() as frames at equidistant times on the vertices of the sphere mesh.
  std::vector<Mat3X> frames(const Eigen::MatrixXd& points, int count) const {
    require(count >= 2, "MovingMean: ", count, " frames, give at least two");
    std::vector<Mat3X> out;
    for (int k = 0; k < count; ++k) out.push_back(pca.reconstruct(interpolate(points, double(k) / (count - 1))));
    return out;
  }
  /// The mean's.
  std::vector<Mat3X> frames(int count) const {
    return frames(integrate_srvf(curves.start, curves.q, time_grid()), count);
  }
  /// The mean as a function of place and time, through so many frames.
  /// throws  UnusableMesh where the sphere's triangles do not cover it once: where a map to the template is steeper than they are
  ///         fine; on the template's sphere they do
  SampledSurface surface(int count) const {
    MeshSequence sequence;
    sequence.faces = sphere.faces;
    sequence.frames = frames(count);
    return {sequence, sphere.vertices};
  }
};

/// The mean of members whose registration in space is given; their warps are found, unless options.karcher.iterations is 0.
/// sphere  unit vertices and triangles of the result
template <LoadsSurfaces Load>
MovingMean mean_of_registered(const Load& load, GroupRegistration group, TriangleMesh sphere,
                              const MovingMeanOptions& options = {}, const Progress& progress = {}) {
  const RegistrationOptions& r = options.registration;
  RegistrationOptions each = r;
  each.spatial.threads = 1;
  SnapshotBasis basis({std::min(1e-10, 1e-3 * r.pca.residual)});
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(sphere.vertices.cols());
  const double snapshots = double(group.members.size()) * r.snapshots;
  std::vector<std::size_t> place(group.members.size());
  detail::fold_members(
      group.chosen, r.spatial.threads,
      [&](std::size_t i) { return sample(load(i), group.members[i].spatial, sphere.vertices, each); },
      [&](std::size_t i, const SurfaceSamples& s) {
        for (const Mat3X& x : s.snapshots) weights += vertex_areas(x, sphere.faces) / snapshots;
        place[i] = basis.members();
        basis.add(s.snapshots, s.velocities);
        report(progress, "principal components", double(basis.members()) / double(group.members.size()));
      });
  if (const auto mask = detail::group_mask(r, group.members[group.chosen.member].spatial.gamma))
    weights.array() *= mask(sphere.vertices).array();
  FunctionalPca pca(basis, std::move(weights), r.pca);
  std::vector<Curve> members;
  for (const std::size_t k : place)
    members.emplace_back(pca.project_coordinates(basis.coordinates(k).leftCols<1>()).col(0),
                         pca.project_velocity_coordinates(basis.vector_coordinates(k)));
  // In an order of their own: sums over members do not depend on that in which they came.
  std::vector<Curve> ordered;
  KarcherOptions karcher = options.karcher;
  for (std::size_t k = 0; k < members.size(); ++k) {
    const std::size_t i = group.chosen.order[k];
    ordered.push_back(members[i]);
    if (!options.karcher.weights.empty()) karcher.weights[k] = options.karcher.weights.at(i);
  }
  KarcherMean curves = karcher_mean(ordered, karcher, progress);
  std::vector<TimeWarp> warps(members.size());
  for (std::size_t k = 0; k < members.size(); ++k) warps[group.chosen.order[k]] = curves.warps[k];
  curves.warps = std::move(warps);
  return {std::move(group), std::move(sphere), std::move(pca), std::move(members), std::move(curves)};
}

/// load      gives the surfaces, centred and of mean area 1 (see normalize)
/// chosen    by choose_template
/// sphere    unit vertices and triangles on the template's sphere, of the result on the mean's, where they show the same points
template <LoadsSurfaces Load>
MovingMean mean_of_group(const Load& load, const GroupTemplate& chosen, const TriangleMesh& sphere,
                         const MovingMeanOptions& options = {}, const ResultStore& store = {},
                         const Progress& progress = {}) {
  GroupOptions group = options.group;
  group.registration = options.registration;
  GroupRegistration registered = register_group(load, chosen, sphere, group, store, progress);
  TriangleMesh mesh{registered.members[chosen.member].spatial.gamma.inverse(sphere.vertices), sphere.faces};
  return mean_of_registered(load, std::move(registered), std::move(mesh), options, progress);
}

/// Of surfaces that are all at hand, at least one.
/// accuracy another order of the surfaces gives the same mean [stats/moving_mean_test]
template <AnimatedSurface F>
MovingMean mean_of_moving(const std::vector<F>& surfaces, const TriangleMesh& sphere,
                          const MovingMeanOptions& options = {}, const Progress& progress = {}) {
  require(!surfaces.empty(), "mean_of_moving: no surfaces, give at least one");
  const auto load = [&](std::size_t i) -> const F& { return surfaces[i]; };
  const GroupTemplate chosen = choose_template(load, surfaces.size(), options.registration.spatial.threads);
  return mean_of_group(load, chosen, sphere, options, {}, progress);
}

}  // namespace dsns
