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
  std::vector<double> pca_variances;
  double pca_residual = 0;    ///< mean squared coordinate error of the components
  KarcherMean curves;         ///< its warps take every surface to the mean's clock
  std::vector<Mat3X> frames;  ///< the mean at equidistant times on the vertices of the sphere mesh
};

/// surfaces  centred and of mean area 1 (see normalize), at least one
/// sphere    unit vertices and triangles of the result
/// frames    how many times the result is evaluated at, at least two
template <AnimatedSurface F>
MovingMean mean_of_moving(const std::vector<F>& surfaces, const TriangleMesh& sphere, int frames,
                          const MovingMeanOptions& options = {}, const Progress& progress = {}) {
  require(!surfaces.empty() && frames >= 2, "mean_of_moving: ", surfaces.size(), " surfaces at ", frames,
          " times, give at least one surface and two times");
  MovingMean result;
  std::vector<SurfaceSamples> samples;
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    result.registrations.push_back(
        i == 0 ? MovingRegistration{}
               : register_moving(surfaces[0], surfaces[i], sphere, options.registration, progress));
    samples.push_back(sample(surfaces[i], result.registrations[i].spatial, sphere.vertices, options.registration));
  }
  const FunctionalPca pca = joint_pca(samples, sphere, options.registration);
  result.pca_variances.assign(pca.variances().begin(), pca.variances().end());
  result.pca_residual = pca.residual();
  std::vector<Curve> curves;
  for (const auto& s : samples) curves.push_back(shape_curve(s, pca));
  result.curves = karcher_mean(curves, options.karcher, progress);
  const Eigen::MatrixXd points = integrate_srvf(result.curves.start, result.curves.q, time_grid());
  for (int k = 0; k < frames; ++k)
    result.frames.push_back(pca.reconstruct(interpolate(points, double(k) / (frames - 1))));
  return result;
}

}  // namespace dsns
