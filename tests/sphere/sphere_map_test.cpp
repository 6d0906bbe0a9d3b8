#include <dsns/sphere/sphere_map.hpp>

#include "catch.hpp"
#include "support/sphere_points.hpp"
#include "support/sphere_warps.hpp"

namespace sphere_map_test {

using namespace dsns;

static_assert(SphereMap<SphereDiffeomorphism>);
static_assert(!SphereMap<SphereVectorField>);

TEST_CASE("sphere map: the path to a smooth map begins at the identity and ends at the map", "[sphere]") {
  const Mat3X s = test::sphere_points();
  const SphereDiffeomorphism gamma = test::turned_warp(4, 5, 9, Vec3d(1, 0.3, -0.5));
  CHECK((interpolated(gamma, 0)(s) - s).cwiseAbs().maxCoeff() < 1e-14);
  CHECK((interpolated(gamma, 1)(s) - gamma(s)).cwiseAbs().maxCoeff() < 1e-13);
  CHECK(certify(interpolated(gamma, 0.5)).holds());
  CHECK_THROWS_AS(interpolated(gamma, -0.1), InvalidArgument);
  CHECK_THROWS_AS(interpolated(gamma, 1.1), InvalidArgument);
}

TEST_CASE("sphere map: on the path of one increment points move at constant speed, of a rotation too", "[sphere]") {
  const Mat3X s = test::sphere_points();
  SphereDiffeomorphism flow;
  flow.append(test::turned_warp(2, 3, 6, Vec3d::Zero()).increments().front());
  const SphereDiffeomorphism turn(rotation_exp(Vec3d(0.9, -0.4, 1.3)));
  CHECK((interpolated(turn, 0.25)(s) - rotation_exp(0.25 * Vec3d(0.9, -0.4, 1.3)) * s).cwiseAbs().maxCoeff() < 1e-13);
  const Mat3X third = interpolated(flow, 1.0 / 3)(s), end = flow(s);
  for (Index i = 0; i < s.cols(); ++i)
    CHECK(angle_between(s.col(i), third.col(i)) == Approx(angle_between(s.col(i), end.col(i)) / 3).margin(1e-12));
}

TEST_CASE("sphere map: a path over a fold is refused", "[sphere]") {
  SphereVectorField v = SphereVectorField::zero(4);
  v.a[20] = 1.5;
  SphereDiffeomorphism folded;
  folded.append(v);
  CHECK(certify(interpolated(folded, 0.01)).holds());
  CHECK_THROWS_AS(interpolated(folded, 1), Error);
}

TEST_CASE("sphere map: distances of maps are angles", "[sphere]") {
  const SphereQuadrature q = sphere_quadrature(12);
  const SphereDiffeomorphism identity, turn(rotation_exp(Vec3d(0, 0, 0.3)));
  // a turn about z moves s by the angle 2 asin(sin(0.15) r) with r^2 = 1 - z^2
  double square = 0;
  const GaussLegendre z = gauss_legendre(40);
  for (Index i = 0; i < z.nodes.size(); ++i)
    square += z.weights[i] / 2 * std::pow(2 * std::asin(std::sin(0.15) * std::sqrt(1 - z.nodes[i] * z.nodes[i])), 2);
  const AngularDistance d = angular_distance(identity, turn, q);
  CHECK(d.rms == Approx(std::sqrt(square)).epsilon(1e-10));
  CHECK(d.largest == Approx(0.3).epsilon(0.01));
  CHECK_THROWS_AS(angular_distance(q.points, q.points, Eigen::VectorXd::Ones(3)), InvalidArgument);
}

TEST_CASE("sphere map: the smallest Jacobian on a grid of one's own", "[sphere]") {
  const SphereDiffeomorphism gamma = test::turned_warp(4, 5, 9, Vec3d(1, 0.3, -0.5));
  const double least = min_jacobian(gamma, fibonacci_sphere(4000).points);
  CHECK(least < 0.9);
  CHECK(least == Approx(certify(gamma).min_jacobian).epsilon(0.02));
}

}  // namespace sphere_map_test
