#include <dsns/core/spline.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

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

/// Knots on [0, 1] whose distances differ up to fivefold.
std::vector<double> uneven(Index n) {
  std::vector<double> knots{0};
  for (Index k = 1; k < n; ++k) knots.push_back(knots.back() + 0.3 + std::abs(std::sin(2.0 * double(k))));
  for (double& t : knots) t /= knots.back();
  return knots;
}

/// The four coefficients of every piece, in powers of t - knot, from all conditions at once: values at both ends, equal first
/// and second derivatives, and equal third ones at the knots next to the ends.
Eigen::MatrixXd dense_pieces(const std::vector<double>& knots, const Eigen::VectorXd& y) {
  const auto pieces = static_cast<Index>(knots.size()) - 1;
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(4 * pieces, 4 * pieces);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(4 * pieces);
  Index row = 0;
  for (Index k = 0; k < pieces; ++k) {
    const double h = knots[std::size_t(k + 1)] - knots[std::size_t(k)];
    a(row, 4 * k) = 1, b[row++] = y[k];
    a.row(row).segment<4>(4 * k) << 1, h, h * h, h * h * h;
    b[row++] = y[k + 1];
    if (k + 1 == pieces) break;
    a.row(row).segment<4>(4 * k) << 0, 1, 2 * h, 3 * h * h;
    a(row++, 4 * k + 5) = -1;
    a.row(row).segment<4>(4 * k) << 0, 0, 2, 6 * h;
    a(row++, 4 * k + 6) = -2;
  }
  for (const Index k : {Index(0), pieces - 2}) a(row, 4 * k + 3) = 1, a(row++, 4 * k + 7) = -1;
  REQUIRE(row == 4 * pieces);
  return a.fullPivLu().solve(b).reshaped(4, pieces);
}

}  // namespace

TEST_CASE("a spline of four knots or more is exact for cubics, with its derivatives and beyond its ends", "[spline]") {
  const Index n = GENERATE(4, 5, 6, 9, 30);
  const CubicSpline spline(n);
  const Eigen::VectorXd y = sampled(n, cubic);
  for (const double t : {0.0, 1e-9, 0.1, 0.25, 0.4999, 0.77, 1.0, -0.2, 1.3}) {
    CHECK(spline.weights(t).dot(y) == Approx(cubic(t)).margin(1e-13));
    CHECK(spline.derivative_weights(t).dot(y) == Approx(-3 + 10 * t - 12 * t * t).margin(1e-12));
    CHECK(spline.second_derivative_weights(t).dot(y) == Approx(10 - 24 * t).margin(1e-9));
  }
}

TEST_CASE("three knots give the parabola, two the line, one the constant", "[spline]") {
  for (const double t : {0.0, 0.3, 0.5, 0.9, 1.0}) {
    const CubicSpline three(3), two(2), one(1);
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
  const CubicSpline spline(n);
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
  const CubicSpline spline(n);
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
    const CubicSpline spline(n);
    const Eigen::VectorXd y = sampled(n, wave);
    double worst = 0;
    for (double t = 0; t <= 1; t += 0.003) worst = std::max(worst, std::abs(spline.weights(t).dot(y) - wave(t)));
    return worst;
  };
  CHECK(error(41) < error(21) / 12);
  CHECK(error(41) < 1e-5);
}

TEST_CASE("a spline through uneven knots is exact for cubics, with its derivatives and beyond its ends", "[spline]") {
  const auto times = GENERATE(values<std::vector<double>>({{-1, 0.2, 0.3, 2}, {0, 0.01, 0.5, 0.6, 1}, uneven(12)}));
  const CubicSpline spline(times);
  const auto n = static_cast<Index>(times.size());
  Eigen::VectorXd y(n);
  for (Index k = 0; k < n; ++k) y[k] = cubic(times[std::size_t(k)]);
  for (const double t : {-1.2, 0.0, 0.1, 0.25, 0.4999, 0.77, 1.0, 2.1}) {
    CHECK(spline.weights(t).dot(y) == Approx(cubic(t)).epsilon(1e-12).margin(1e-12));
    CHECK(spline.derivative_weights(t).dot(y) == Approx(-3 + 10 * t - 12 * t * t).epsilon(1e-11).margin(1e-11));
    CHECK(spline.second_derivative_weights(t).dot(y) == Approx(10 - 24 * t).margin(1e-8));
  }
}

TEST_CASE("three uneven knots give the parabola", "[spline]") {
  const CubicSpline spline(std::vector<double>{0, 0.1, 1});
  const Eigen::Vector3d y(parabola(0), parabola(0.1), parabola(1));
  for (const double t : {-0.3, 0.0, 0.05, 0.6, 1.0}) {
    CHECK(spline.weights(t).dot(y) == Approx(parabola(t)).margin(1e-13));
    CHECK(spline.second_derivative_weights(t).dot(y) == Approx(-6));
  }
}

TEST_CASE("a spline through uneven knots is the solution of the dense system of its pieces", "[spline]") {
  const Index n = GENERATE(4, 5, 11, 30);
  const std::vector<double> knots = uneven(n);
  const CubicSpline spline(knots);
  Eigen::VectorXd y(n);
  for (Index k = 0; k < n; ++k) y[k] = wave(knots[std::size_t(k)]);
  const Eigen::MatrixXd pieces = dense_pieces(knots, y);
  for (Index k = 0; k + 1 < n; ++k)
    for (const double share : {0.0, 0.3, 0.8}) {
      const double d = share * (knots[std::size_t(k + 1)] - knots[std::size_t(k)]), t = knots[std::size_t(k)] + d;
      const Eigen::Vector4d c = pieces.col(k);
      CHECK(spline.weights(t).dot(y) == Approx(c[0] + d * (c[1] + d * (c[2] + d * c[3]))).margin(1e-12));
      CHECK(spline.derivative_weights(t).dot(y) == Approx(c[1] + d * (2 * c[2] + 3 * d * c[3])).margin(1e-10));
    }
}

TEST_CASE("equidistant knots given by their times are the same spline", "[spline]") {
  const CubicSpline counted(9), given(equidistant_times(9));
  for (const double t : {-0.1, 0.0, 0.125, 0.43, 1.0, 1.2}) CHECK(counted.weights(t) == given.weights(t));
  CHECK(equidistant_times(3) == std::vector<double>{0, 0.5, 1});
  CHECK(equidistant_times(1) == std::vector<double>{0});
}

TEST_CASE("a spline refuses no knots, knots that do not increase, and times that are not finite", "[spline]") {
  CHECK_THROWS_AS(CubicSpline(std::vector<double>{0, 0.5, 0.5, 1}), InvalidArgument);
  CHECK_THROWS_AS(CubicSpline(std::vector<double>{0, std::nan("")}), InvalidArgument);
  CHECK_THROWS_AS(CubicSpline(std::vector<double>{}), InvalidArgument);
  CHECK_THROWS_AS(CubicSpline(0), InvalidArgument);
  CHECK_THROWS_AS(CubicSpline(5).weights(std::nan("")), InvalidArgument);
  CHECK_THROWS_AS(CubicSpline(5).derivative_weights(std::numeric_limits<double>::infinity()), InvalidArgument);
}

}  // namespace spline_test
