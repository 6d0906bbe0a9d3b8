#include "catch.hpp"
#include "support/sphere_points.hpp"

#include <dsns/sphere/diffeomorphism.hpp>
#include <dsns/surface/jets.hpp>

namespace diffeomorphism_test {

using namespace dsns;

TEST_CASE("the identity and rotations are themselves", "[sphere]") {
  const Mat3X s = test::sphere_points();
  CHECK((SphereDiffeomorphism()(s) - s).norm() < 1e-14);
  const Mat3 R = rotation_exp(Vec3d(0.2, 1.1, -0.4));
  const SphereDiffeomorphism turn(R);
  CHECK((turn(s) - R * s).norm() < 1e-13);
  CHECK(certify(turn).min_jacobian == Approx(1));
}

TEST_CASE("a composition of fields has the differential of its jets", "[sphere]") {
  SphereDiffeomorphism gamma(rotation_exp(Vec3d(0.5, 0, 1)));
  const SphereDiffeomorphism random = random_diffeomorphism(3, 5, 0.15);
  for (const auto& v : random.increments()) gamma.append(v);
  const ChartBatch c = charts_at(test::sphere_points(100));  // more than one tile
  const SphereDisplacement d = gamma.displacement(c);
  double worst = 0;
  for (Index i = 0; i < c.size(); ++i) {
    const auto jet = gamma(detail::chart_jet(c, i));
    for (int k = 0; k < 3; ++k)
      worst = std::max({worst, std::abs(jet[k].f - d.y(k, i)), std::abs(jet[k].g[0] - d.y1(k, i)),
                        std::abs(jet[k].g[1] - d.y2(k, i))});
  }
  CHECK(worst < 1e-12);
  CHECK((gamma(c.s) - d.y).norm() < 1e-12);
}

TEST_CASE("the Jacobian of a diffeomorphism integrates to the sphere's area", "[sphere]") {
  const SphereDiffeomorphism gamma = random_diffeomorphism(8, 3, 0.1);
  const SphereQuadrature q = sphere_quadrature(40);
  CHECK(gamma.displacement(charts_at(q.points)).J.dot(q.weights) == Approx(4 * pi).epsilon(1e-8));
}

TEST_CASE("the inverse brings points back", "[sphere]") {
  const Mat3X s = test::sphere_points();
  SphereDiffeomorphism gamma(rotation_exp(Vec3d(1, 0.3, 0)));
  const SphereDiffeomorphism random = random_diffeomorphism(11, 4, 0.18);
  for (const auto& v : random.increments()) gamma.append(v);
  REQUIRE(certify(gamma).holds());
  CHECK((gamma.inverse(gamma(s)) - s).cwiseAbs().maxCoeff() < 1e-12);
  CHECK((gamma(gamma.inverse(s)) - s).cwiseAbs().maxCoeff() < 1e-12);
}

TEST_CASE("a composition is one after the other, rotations and fields alike", "[sphere]") {
  const Mat3X s = test::sphere_points();
  const auto warped = [](const Vec3d& turn, std::uint64_t seed) {
    SphereDiffeomorphism gamma(rotation_exp(turn));
    const SphereDiffeomorphism random = random_diffeomorphism(seed, 4, 0.15);
    for (const auto& v : random.increments()) gamma.append(v);
    return gamma;
  };
  const SphereDiffeomorphism outer = warped(Vec3d(1, 0.3, -2), 5), inner = warped(Vec3d(0.1, -1.3, 0.7), 6);
  CHECK((compose(outer, inner)(s) - outer(inner(s))).cwiseAbs().maxCoeff() < 1e-12);
  CHECK((compose(inner, outer)(s) - outer(inner(s))).cwiseAbs().maxCoeff() > 0.1);
}

TEST_CASE("an inverse is a map of the same kind, with its differential", "[sphere]") {
  SphereDiffeomorphism gamma(rotation_exp(Vec3d(0.5, 0, 1)));
  const SphereDiffeomorphism random = random_diffeomorphism(3, 5, 0.15);
  for (const auto& v : random.increments()) gamma.append(v);
  const SphereDiffeomorphism back = inverted(gamma);
  const ChartBatch c = charts_at(test::sphere_points(70));
  CHECK((back(gamma(c.s)) - c.s).cwiseAbs().maxCoeff() < 1e-12);
  CHECK((back(c.s) - gamma.inverse(c.s)).cwiseAbs().maxCoeff() < 1e-12);
  CHECK((back.inverse(c.s) - gamma(c.s)).cwiseAbs().maxCoeff() < 1e-12);
  CHECK((inverted(back)(c.s) - gamma(c.s)).cwiseAbs().maxCoeff() < 1e-12);
  CHECK((compose(back, gamma)(c.s) - c.s).cwiseAbs().maxCoeff() < 1e-12);

  const SphereDisplacement d = back.displacement(c);
  double worst = 0;
  for (Index i = 0; i < c.size(); ++i) {
    const auto jet = back(detail::chart_jet(c, i));
    const auto round = gamma(jet);  // derivatives of both orders are those of the point itself
    const auto point = detail::chart_jet(c, i);
    for (int k = 0; k < 3; ++k) {
      worst = std::max({worst, std::abs(jet[k].f - d.y(k, i)), std::abs(jet[k].g[0] - d.y1(k, i)),
                        std::abs(jet[k].g[1] - d.y2(k, i)), std::abs(round[k].g[0] - point[k].g[0])});
      for (std::size_t h = 0; h < point[k].h.size(); ++h)
        worst = std::max(worst, std::abs(round[k].h[h] - point[k].h[h]));
    }
  }
  CHECK(worst < 1e-11);
  CHECK(certify(back).min_jacobian ==
        Approx(1 / gamma.displacement(charts_at(sphere_quadrature(60).points)).J.maxCoeff()).epsilon(0.02));
}

TEST_CASE("a map with a fold is not certified", "[sphere]") {
  SphereVectorField v = SphereVectorField::zero(4);
  v.a[20] = 1.5;
  SphereDiffeomorphism folded;
  folded.append(v);
  CHECK_FALSE(certify(folded).holds());
}

TEST_CASE("random diffeomorphisms have the size asked for and repeat", "[sphere]") {
  const double size = 8 * pi / 180;
  const SphereQuadrature q = fibonacci_sphere(1000);
  const Mat3X y = random_diffeomorphism(5, 3, size)(q.points);
  double square = 0;
  for (Index i = 0; i < y.cols(); ++i)
    square += std::pow(angle_between(y.col(i), q.points.col(i)), 2) / double(y.cols());
  CHECK(std::sqrt(square) == Approx(size).epsilon(1e-3));
  CHECK(random_diffeomorphism(5, 3, size)(q.points) == y);
  CHECK(random_diffeomorphism(5, 3, 0)(q.points).isApprox(q.points, 1e-15));
  CHECK_THROWS_AS(random_diffeomorphism(5, 3, 2.0), InvalidArgument);
  CHECK_THROWS_AS(random_diffeomorphism(5, 0, 0.1), InvalidArgument);
}

}  // namespace diffeomorphism_test
