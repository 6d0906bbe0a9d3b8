#include "catch.hpp"

#include <dsns/sphere/harmonics.hpp>
#include <dsns/sphere/quadrature.hpp>

namespace quadrature_test {

using namespace dsns;

TEST_CASE("Gauss-Legendre nodes of three points are the textbook's", "[sphere]") {
  const GaussLegendre rule = gauss_legendre(3);
  CHECK(rule.nodes[0] == Approx(-std::sqrt(0.6)).epsilon(1e-14));
  CHECK(std::abs(rule.nodes[1]) < 1e-15);
  CHECK(rule.weights[0] == Approx(5.0 / 9).epsilon(1e-14));
  CHECK(rule.weights[1] == Approx(8.0 / 9).epsilon(1e-14));
}

TEST_CASE("Gauss-Legendre is exact to degree 2n - 1 and no further", "[sphere]") {
  const int n = GENERATE(1, 2, 5, 16, 40);
  const GaussLegendre rule = gauss_legendre(n);
  const auto integral = [&](int power) { return rule.nodes.array().pow(power).matrix().dot(rule.weights); };
  CHECK(integral(2 * n - 2) == Approx(2.0 / (2 * n - 1)).epsilon(1e-12));
  if (n <= 5) CHECK(std::abs(integral(2 * n) - 2.0 / (2 * n + 1)) > 1e-6);
}

TEST_CASE("sphere quadrature integrates polynomials", "[sphere]") {
  const SphereQuadrature q = sphere_quadrature(6);
  const Eigen::ArrayXd x = q.points.row(0), y = q.points.row(1), z = q.points.row(2), w = q.weights;
  CHECK(w.sum() == Approx(4 * pi).epsilon(1e-14));
  CHECK((w * x.pow(4)).sum() == Approx(4 * pi / 5).epsilon(1e-13));
  CHECK((w * x.square() * y.square() * z.square()).sum() == Approx(4 * pi / 105).epsilon(1e-13));
  CHECK(std::abs((w * x * z).sum()) < 1e-14);
  CHECK_THROWS_AS(sphere_quadrature(0), InvalidArgument);
}

TEST_CASE("sphere quadrature is exact to degree 2n - 1 and no further", "[sphere]") {
  const int n = GENERATE(1, 2, 7, 20);
  const SphereQuadrature q = sphere_quadrature(n);
  CHECK(q.size() == 2 * n * n);
  CHECK(q.weights.sum() == Approx(4 * pi).epsilon(1e-14));
  const Eigen::VectorXd integrals = harmonics(q.points, 2 * n).transpose() * q.weights;
  CHECK(integrals[0] == Approx(std::sqrt(4 * pi)).epsilon(1e-13));
  CHECK(integrals.segment(1, 4 * n * n - 1).cwiseAbs().maxCoeff() < 1e-13);
  CHECK(std::abs(integrals[4 * n * n + 2 * n]) > 1);  // Y_(2n)0: too few nodes in z
  CHECK(std::abs(integrals[4 * n * n + 4 * n]) > 1);  // Y_(2n)(2n): too few longitudes
}

TEST_CASE("nodes of a large rule increase, are symmetric and have positive weights", "[sphere]") {
  const int n = GENERATE(2, 129, 1000);
  const GaussLegendre rule = gauss_legendre(n);
  CHECK((rule.nodes + rule.nodes.reverse()).cwiseAbs().maxCoeff() < 1e-15);
  CHECK((rule.nodes.tail(n - 1) - rule.nodes.head(n - 1)).minCoeff() > 0);
  CHECK(rule.weights.minCoeff() > 0);
  CHECK(rule.weights.sum() == Approx(2).epsilon(1e-13));
}

TEST_CASE("the spiral covers the sphere evenly", "[sphere]") {
  const SphereQuadrature q = fibonacci_sphere(2000);
  CHECK(q.weights.sum() == Approx(4 * pi));
  CHECK(q.points.rowwise().mean().norm() < 1e-3);
  CHECK((q.points * q.points.transpose() / 2000 - Mat3::Identity() / 3).norm() < 1e-3);
}

}  // namespace quadrature_test
