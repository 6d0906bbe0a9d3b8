#include "catch.hpp"
#include "support/sphere_points.hpp"

#include <dsns/elastic/registered_surface.hpp>
#include <dsns/elastic/srnf.hpp>
#include <dsns/geometry/integrals.hpp>
#include <dsns/surface/analytic.hpp>

namespace srnf_test {

using namespace dsns;

namespace {

LimbedBody srnf_body() {
  LimbedBody body;
  body.axes = {1, 0.8, 0.6};
  body.limbs = {{Vec3d(1, 1, 0).normalized(), 5, Vec3d(0.6, 0.3, 0.2), Vec3d(0, 0.2, 0.1), 0.2},
                {Vec3d(-1, 0.2, 0.4).normalized(), 4, Vec3d(-0.4, 0.1, 0.1)}};
  return body;
}

}  // namespace

TEST_CASE("the squared norm of an SRNF is the area", "[elastic]") {
  const SphereQuadrature q = sphere_quadrature(60);
  CHECK(srnf(Ellipsoid{2, 2, 2}, q.points).colwise().squaredNorm() * q.weights == Approx(16 * pi).epsilon(1e-12));
  const LimbedBody body = srnf_body();
  const auto f = at_time(body, 0.4);
  CHECK(srnf(f, q.points).colwise().squaredNorm() * q.weights == Approx(measure(f, q).area).epsilon(1e-12));
}

TEST_CASE("derivatives of the SRNF agree with central differences", "[elastic]") {
  const LimbedBody body = srnf_body();
  const auto f = at_time(body, 0.4);
  const ChartBatch c = charts_at(test::sphere_points());
  const SrnfJets q = srnf(jets(f, c));
  constexpr double h = 1e-5;
  const Mat3X du =
      (srnf(f, std::cos(h) * c.s + std::sin(h) * c.e1) - srnf(f, std::cos(h) * c.s - std::sin(h) * c.e1)) / (2 * h);
  const Mat3X dv =
      (srnf(f, std::cos(h) * c.s + std::sin(h) * c.e2) - srnf(f, std::cos(h) * c.s - std::sin(h) * c.e2)) / (2 * h);
  CHECK((q.hu - du).cwiseAbs().maxCoeff() < 1e-7);
  CHECK((q.hv - dv).cwiseAbs().maxCoeff() < 1e-7);
}

TEST_CASE("the SRNF of a turned and reparametrised surface is O sqrt(J) h(gamma)", "[elastic]") {
  const LimbedBody body = srnf_body();
  const SphereDiffeomorphism gamma = random_diffeomorphism(6, 4, 0.15);
  const Mat3 O = rotation_exp(Vec3d(0.7, -0.2, 0.4));
  const RegisteredSurface moved(body, O, gamma);
  const ChartBatch c = charts_at(test::sphere_points());
  const SphereDisplacement d = gamma.displacement(c);
  const Mat3X expected = O * srnf(at_time(body, 0.4), d.y) * d.J.cwiseSqrt().asDiagonal();
  CHECK((srnf(at_time(moved, 0.4), c.s) - expected).cwiseAbs().maxCoeff() < 1e-11);
}

TEST_CASE("an SRNF at a crushed point is refused", "[elastic]") {
  CHECK_THROWS_AS(srnf(Ellipsoid{0, 0, 1}, test::sphere_points()), DegenerateSurface);
}

}  // namespace srnf_test
