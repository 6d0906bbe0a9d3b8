#pragma once
/// The mean of moving surfaces: all are registered in space to the first, their curves in the space of joint principal
/// components are averaged up to warps of time, and the mean curve is a moving surface on the first one's sphere mesh.
#include <dsns/elastic/geodesic.hpp>
#include <dsns/stats/co_registration.hpp>
#include <dsns/stats/karcher_mean.hpp>

namespace dsns {

struct MovingMeanOptions {
  RegistrationOptions registration;
  KarcherOptions karcher;
};

struct MovingMean {
  std::vector<MovingRegistration> registrations;  ///< of every surface to the first; the first's own is the identity
  FunctionalPca pca;                              ///< of all, registered in space
  std::vector<Curve> members;                     ///< the surfaces in its components, on their own clocks
  KarcherMean curves;                             ///< its warps take every surface to the mean's clock

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
};

/// surfaces  centred and of mean area 1 (see normalize), at least one
/// sphere    unit vertices and triangles of the result
template <AnimatedSurface F>
MovingMean mean_of_moving(const std::vector<F>& surfaces, const TriangleMesh& sphere,
                          const MovingMeanOptions& options = {}, const Progress& progress = {}) {
  require(!surfaces.empty(), "mean_of_moving: no surfaces, give at least one");
  std::vector<MovingRegistration> registrations;
  std::vector<SurfaceSamples> samples;
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    registrations.push_back(i == 0
                                ? MovingRegistration{}
                                : register_moving(surfaces[0], surfaces[i], sphere, options.registration, progress));
    samples.push_back(sample(surfaces[i], registrations[i].spatial, sphere.vertices, options.registration));
  }
  MovingMean result{std::move(registrations), joint_pca(samples, sphere, options.registration), {}, {}};
  for (const auto& s : samples) result.members.push_back(shape_curve(s, result.pca));
  result.curves = karcher_mean(result.members, options.karcher, progress);
  return result;
}

}  // namespace dsns
