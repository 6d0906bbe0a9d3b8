#include "catch.hpp"

#include <dsns/elastic/dynamic_programming.hpp>

namespace dynamic_programming_test {

using namespace dsns;

namespace {

Eigen::VectorXd velocity(double t) {
  Eigen::VectorXd v(5);
  for (int k = 0; k < 5; ++k)
    v[k] = std::cos((k + 1) * pi * t + 0.7 * k * k) / std::sqrt(k + 1.0) + 0.3 * std::sin(2 * pi * t * (k % 3 + 1));
  return v;
}

Curve curve() {
  Eigen::MatrixXd v(5, 129);
  for (Index k = 0; k < 129; ++k) v.col(k) = velocity(double(k) / 128);
  return {Eigen::VectorXd::Zero(5), v};
}

/// The cost of a path by its definition: q2 between its samples is interpolated, both ends of a move count half.
double cost(const Eigen::MatrixXd& q1, const Eigen::MatrixXd& q2, const Eigen::VectorXd& path) {
  const Index n = q1.cols();
  double sum = 0;
  for (Index k = 0; k + 1 < n; ++k) {
    const double slope = (path[k + 1] - path[k]) * double(n - 1);
    for (const Index s : {k, k + 1}) {
      const double x = path[s] * double(n - 1);
      const Index left = std::min(static_cast<Index>(x + 1e-9), n - 2);
      const double f = x - double(left);
      sum += 0.5 * (q1.col(s) - std::sqrt(slope) * ((1 - f) * q2.col(left) + f * q2.col(left + 1))).squaredNorm();
    }
  }
  return sum / double(n - 1);
}

}  // namespace

TEST_CASE("dynamic programming follows a piecewise linear warp on its own grid", "[elastic]") {
  constexpr int n = 61;
  Eigen::MatrixXd q2(5, n), q1(5, n);
  const auto zeta = [](double t) { return t < 0.5 ? t / 2 : 0.25 + (t - 0.5) * 1.5; };
  for (int k = 0; k < n; ++k) {
    const double t = double(k) / (n - 1), slope = t < 0.5 ? 0.5 : 1.5;
    q2.col(k) = srvf(velocity(t));
    q1.col(k) = std::sqrt(slope) * srvf(velocity(zeta(t)));
  }
  const detail::GridPath path = detail::GridSearch(q1, q2, 5, 0).path(n - 1);
  double worst = 0;
  for (int k = 0; k < n; ++k) worst = std::max(worst, std::abs(path.values[k] - zeta(double(k) / (n - 1))));
  CHECK(worst < 0.035);  // two nodes: the corner and the interpolated q2 leave no more freedom
  CHECK(path.cost == Approx(cost(q1, q2, path.values)).epsilon(1e-9));
}

TEST_CASE("more samples bring a smooth warp nearer, by velocities and by points", "[elastic]") {
  const TimeWarp warp = random_time_warp(3, 0.4, 1.8);
  const Curve first = curve(), second = warped(first, warp);
  double last = 1, last_points = 1;
  for (const int n : {25, 100}) {
    const double miss = distance(dynamic_programming_warp(first, second, {.samples = n}), inverse(warp));
    CHECK(miss < last / 2);
    last = miss;
    Eigen::MatrixXd a(5, n), b(5, n);
    for (int k = 0; k < n; ++k) {  // the integral of the velocity, by its closed form
      const auto point = [](double t) {
        Eigen::VectorXd x(5);
        for (int j = 0; j < 5; ++j)
          x[j] = std::sin((j + 1) * pi * t + 0.7 * j * j) / ((j + 1) * pi * std::sqrt(j + 1.0)) -
                 0.3 * std::cos(2 * pi * t * (j % 3 + 1)) / (2 * pi * (j % 3 + 1));
        return x;
      };
      a.col(k) = point(double(k) / (n - 1));
      b.col(k) = point(warp(double(k) / (n - 1)));
    }
    const double miss_points = distance(dynamic_programming_warp(a, b), inverse(warp));
    CHECK(miss_points < last_points / 2);
    last_points = miss_points;
  }
  CHECK(last < 0.01);
}

TEST_CASE("a dear enough warp is the identity", "[elastic]") {
  const Curve first = curve(), second = warped(first, random_time_warp(3, 0.4, 1.8));
  CHECK(distance(dynamic_programming_warp(first, second, {.samples = 50, .penalty = 1e4}), TimeWarp()) < 1e-12);
}

TEST_CASE("a piecewise linear warp is linear between its nodes and increases", "[elastic]") {
  const PiecewiseLinearWarp warp(Eigen::Vector3d(0, 0.2, 1));
  CHECK(warp(0.25) == Approx(0.1));
  CHECK(warp(0.75) == Approx(0.6));
  CHECK(warp(1) == 1);
  CHECK(warp.slope(0.1) == Approx(0.4));
  CHECK(warp.slope(0.9) == Approx(1.6));
  CHECK_THROWS_AS(PiecewiseLinearWarp(Eigen::Vector3d(0, 0, 1)), InvalidArgument);
}

TEST_CASE("what cannot be compared is refused", "[elastic]") {
  const Curve flat(Eigen::VectorXd::Zero(2), Eigen::MatrixXd::Zero(2, 9));
  CHECK_THROWS_AS(dynamic_programming_warp(flat, curve()), InvalidArgument);
  CHECK_THROWS_AS(dynamic_programming_warp(curve(), curve(), {.samples = 1}), InvalidArgument);
  CHECK_THROWS_AS(dynamic_programming_warp(Eigen::MatrixXd::Zero(2, 5), Eigen::MatrixXd::Zero(2, 6)), InvalidArgument);
}

}  // namespace dynamic_programming_test
