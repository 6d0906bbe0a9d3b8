#include <dsns/core/spline.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

#include "catch.hpp"

namespace spline_test {

using namespace dsns;

namespace {

Eigen::VectorXd sampled(Index knots, double (*f)(double)) {
  Eigen::VectorXd values(knots);
  for (Index k = 0; k < knots; ++k) values[k] = f(knots > 1 ? double(k) / double(knots - 1) : 0);
  return values;
}

double cubic(double t) { return 2 - 3 * t + 5 * t * t - 4 * t * t * t; }
double parabola(double t) { return 1 + 2 * t - 3 * t * t; }
double wave(double t) { return std::sin(5 * t); }

}  // namespace

TEST_CASE("a spline of four knots or more is exact for cubics, with its derivatives and beyond its ends", "[spline]") {
  const Index n = GENERATE(4, 5, 6, 9, 30);
  const UniformSpline spline(n);
  const Eigen::VectorXd y = sampled(n, cubic);
  for (const double t : {0.0, 1e-9, 0.1, 0.25, 0.4999, 0.77, 1.0, -0.2, 1.3}) {
    CHECK(spline.weights(t).dot(y) == Approx(cubic(t)).margin(1e-13));
    CHECK(spline.derivative_weights(t).dot(y) == Approx(-3 + 10 * t - 12 * t * t).margin(1e-12));
    CHECK(spline.second_derivative_weights(t).dot(y) == Approx(10 - 24 * t).margin(1e-9));
  }
}

TEST_CASE("three knots give the parabola, two the line, one the constant", "[spline]") {
  for (const double t : {0.0, 0.3, 0.5, 0.9, 1.0}) {
    const UniformSpline three(3), two(2), one(1);
    const Eigen::VectorXd y = sampled(3, parabola);
    CHECK(three.weights(t).dot(y) == Approx(parabola(t)).margin(1e-14));
    CHECK(three.derivative_weights(t).dot(y) == Approx(2 - 6 * t).margin(1e-13));
    CHECK(three.second_derivative_weights(t).dot(y) == Approx(-6));
    CHECK(two.weights(t).isApprox(Eigen::Vector2d(1 - t, t)));
    CHECK(two.derivative_weights(t) == Eigen::Vector2d(-1, 1));
    CHECK(two.second_derivative_weights(t) == Eigen::Vector2d(0, 0));
    CHECK(one.weights(t)[0] == 1);
    CHECK(one.derivative_weights(t)[0] == 0);
    CHECK(one.second_derivative_weights(t)[0] == 0);
  }
}

TEST_CASE("a spline passes through its knots and its weights sum to one", "[spline]") {
  const Index n = GENERATE(1, 2, 3, 4, 7, 24);
  const UniformSpline spline(n);
  REQUIRE(spline.knots() == n);
  for (Index k = 0; k < n; ++k) {
    const double t = n > 1 ? double(k) / double(n - 1) : 0;
    CHECK((spline.weights(t) - Eigen::VectorXd::Unit(n, k)).cwiseAbs().maxCoeff() < 1e-13);
    CHECK(spline.weights(t + 0.3 / double(n)).sum() == Approx(1));
    CHECK(std::abs(spline.derivative_weights(t + 0.3 / double(n)).sum()) < 1e-10);
  }
}

TEST_CASE("a spline is twice continuously differentiable, and three times at the knots next to the ends", "[spline]") {
  const Index n = 8;
  const UniformSpline spline(n);
  const Eigen::VectorXd y = sampled(n, wave);
  const double eps = 1e-9;
  for (Index k = 1; k < n - 1; ++k) {
    const double t = double(k) / double(n - 1);
    CHECK(spline.derivative_weights(t - eps).dot(y) == Approx(spline.derivative_weights(t + eps).dot(y)).epsilon(1e-6));
    CHECK(spline.second_derivative_weights(t - eps).dot(y) ==
          Approx(spline.second_derivative_weights(t + eps).dot(y)).margin(1e-5));
  }
  const auto third = [&](double a, double b) {
    return (spline.second_derivative_weights(b) - spline.second_derivative_weights(a)).dot(y) / (b - a);
  };
  const double h = 1.0 / 7;
  CHECK(third(0.1 * h, 0.9 * h) == Approx(third(1.1 * h, 1.9 * h)));
  CHECK(third(5.1 * h, 5.9 * h) == Approx(third(6.1 * h, 6.9 * h)));
  CHECK(third(1.1 * h, 1.9 * h) != Approx(third(2.1 * h, 2.9 * h)));
}

TEST_CASE("the error of a spline falls with the fourth power of the knot distance", "[spline]") {
  const auto error = [](Index n) {
    const UniformSpline spline(n);
    const Eigen::VectorXd y = sampled(n, wave);
    double worst = 0;
    for (double t = 0; t <= 1; t += 0.003) worst = std::max(worst, std::abs(spline.weights(t).dot(y) - wave(t)));
    return worst;
  };
  CHECK(error(41) < error(21) / 12);
  CHECK(error(41) < 1e-5);
}

TEST_CASE("a spline refuses no knots and times that are not finite", "[spline]") {
  CHECK_THROWS_AS(UniformSpline(0), InvalidArgument);
  CHECK_THROWS_AS(UniformSpline(5).weights(std::nan("")), InvalidArgument);
  CHECK_THROWS_AS(UniformSpline(5).derivative_weights(std::numeric_limits<double>::infinity()), InvalidArgument);
}

}  // namespace spline_test
