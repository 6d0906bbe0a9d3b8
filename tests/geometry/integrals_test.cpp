#include "catch.hpp"

#include <dsns/geometry/integrals.hpp>
#include <dsns/surface/analytic.hpp>

namespace integrals_test {

using namespace dsns;

TEST_CASE("area, volume, centroid and total curvature of a spheroid are the closed forms", "[geometry]") {
  const double c = 2, eccentricity = std::sqrt(1 - 1 / (c * c));
  const SurfaceMeasures m = measure(Ellipsoid{1, 1, c}, sphere_quadrature(60));
  CHECK(m.area == Approx(2 * pi * (1 + c / eccentricity * std::asin(eccentricity))).epsilon(1e-10));
  CHECK(m.volume == Approx(4 * pi / 3 * c).epsilon(1e-12));
  CHECK(m.area_centroid.norm() < 1e-12);
  CHECK(m.total_curvature == Approx(4 * pi).epsilon(1e-8));
}

TEST_CASE("Gauss-Bonnet holds for a body with limbs, and measures move with it", "[geometry]") {
  LimbedBody body;
  body.axes = {1, 0.8, 0.6};
  body.limbs = {{Vec3d(1, 1, 0).normalized(), 5, Vec3d(0.6, 0.3, 0.2), Vec3d(0, 0.2, 0.1), 0.2},
                {Vec3d(-1, 0.2, 0.4).normalized(), 4, Vec3d(-0.4, 0.1, 0.1)}};
  const SphereQuadrature q = sphere_quadrature(80);
  const SurfaceMeasures m = measure(at_time(body, 0.3), q);
  CHECK(m.total_curvature == Approx(4 * pi).epsilon(1e-6));
  CHECK(m.volume > 0);
}

}  // namespace integrals_test
