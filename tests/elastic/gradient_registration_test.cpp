#include "catch.hpp"

#include <dsns/elastic/gradient_registration.hpp>
#include <dsns/elastic/known_warp.hpp>
#include <dsns/elastic/registered_surface.hpp>
#include <dsns/surface/analytic.hpp>

namespace gradient_registration_test {

using namespace dsns;

TEST_CASE("gradient schemes lower their energies, and leave of a warp what a Gauss-Newton iteration removes",
          "[elastic]") {
  constexpr double degree = pi / 180;
  LimbedBody body;
  body.axes = {1, 0.8, 0.6};
  body.limbs = {{Vec3d(1, 0.3, 0.2).normalized(), 6, Vec3d(0.7, 0.2, 0.1)},
                {Vec3d(-1, 0.5, 0.4).normalized(), 5, Vec3d(-0.5, 0.3, 0.3)}};
  const KnownWarp truth = known_warp(3, 2, 4 * degree, KnownTurns::none);
  const RegisteredSurface moved(body, truth.rotation, truth.gamma);
  const std::vector<HarmonicSurface> first{project_on_harmonics(at_time(moved, 0.0), 12)},
      second{project_on_harmonics(at_time(body, 0.0), 12)};
  SpatialOptions options;
  options.latitudes = 12;
  for (const GradientScheme scheme : {GradientScheme::paper, GradientScheme::released}) {
    const SpatialResult r = register_by_gradient(first, second, scheme, {}, options, 60);
    const WarpRecovery w = recovery(truth, r.rotation, r.gamma);
    INFO("missed by " << w.missed / degree << " degrees");
    CHECK(r.summary.energy_after < 0.9 * r.summary.energy_before);
    CHECK(w.missed > 0.3 * degree);
    CHECK(w.min_jacobian > 0);
  }
  options.search = RotationSearch::none;
  options.levels = {{2, 12, 0.0, 0.5}, {4, 12, 0.0, 0.5}};
  const SpatialResult ours = register_harmonic(first, second, options);
  CHECK(recovery(truth, ours.rotation, ours.gamma).missed < 0.1 * degree);
}

}  // namespace gradient_registration_test
