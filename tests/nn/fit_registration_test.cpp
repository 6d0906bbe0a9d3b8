#include "catch.hpp"

#include <dsns/elastic/spatial_registration.hpp>
#include <dsns/mesh/sphere_mesh.hpp>
#include <dsns/nn/fit.hpp>
#include <dsns/surface/analytic.hpp>
#include <dsns/surface/any_surface.hpp>
#include <dsns/surface/motion.hpp>
#include <dsns/surface/sampled.hpp>

namespace fit_registration_test {

using namespace dsns;

TEST_CASE("an ellipsoid, its sampled mesh and its network register alike, to within the fit", "[elastic]") {
  const auto ellipsoid = resting(Ellipsoid{1.1, 0.7, 0.65});
  const AnyAnimatedSurface target(resting(Ellipsoid{1, 0.8, 0.6})), exact(ellipsoid);
  const TriangleMesh sphere = icosphere(4);
  const AnyAnimatedSurface sampled(SampledSurface(sequence_of(ellipsoid, sphere, 2), sphere.vertices));
  FitOptions fit;
  fit.width = 32;
  fit.points = 4000;
  fit.times = 8;
  fit.encoding.harmonic_degree = 4;
  fit.encoding.harmonic_decay = 2;
  fit.encoding.time_frequencies = 2;
  fit.batch = 512;
  fit.steps = 1500;
  const AnyAnimatedSurface network(fit_neural_surface(ellipsoid, fit).surface);

  const auto first = at_time(target, 0.0);
  SpatialOptions options;
  options.levels = {{1, 6, 0.03, 0.5}, {2, 6, 0.02, 0.5}, {3, 8, 0.0, 0.5}, {4, 10, 0.0, 0.0}};
  options.latitudes = 14;
  options.refinement = {};
  options.search = RotationSearch::upright;
  const SpatialResult a = register_spatially(first, at_time(exact, 0.0), options);
  const SpatialResult m = register_spatially(first, at_time(sampled, 0.0), options);
  const SpatialResult n = register_spatially(first, at_time(network, 0.0), options);
  const SphereQuadrature q = sphere_quadrature(20);
  const Mat3X h = srnf(at_time(exact, 0.0), q.points);
  // |d(E^1/2)| <= |h - h'|: what the representations differ by bounds how far the distances can be apart. The registration
  // sees band-limited surfaces, so the fields are compared there too.
  const auto difference = [&](const auto& surface) {
    const Mat3X other = srnf(project_on_harmonics(surface, 10), q.points);
    return std::sqrt((other - h).colwise().squaredNorm() * q.weights);
  };
  const double distance = std::sqrt(a.summary.energy_after);
  const double mesh_bound = difference(at_time(sampled, 0.0)), network_bound = difference(at_time(network, 0.0));
  INFO("distances " << distance << ", " << std::sqrt(m.summary.energy_after) << ", "
                    << std::sqrt(n.summary.energy_after) << "; bounds " << mesh_bound << ", " << network_bound);
  CHECK(mesh_bound < 0.2 * distance);
  CHECK(network_bound < 0.5 * distance);
  CHECK(std::abs(std::sqrt(m.summary.energy_after) - distance) <= mesh_bound + 1e-3 * distance);
  CHECK(std::abs(std::sqrt(n.summary.energy_after) - distance) <= network_bound + 1e-3 * distance);
}

}  // namespace fit_registration_test
