#include "catch.hpp"

#include <dsns/elastic/temporal_registration.hpp>

namespace temporal_registration_test {

using namespace dsns;

namespace {

Eigen::VectorXd velocity(double t) {
  Eigen::VectorXd v(5);
  for (int k = 0; k < 5; ++k)
    v[k] = std::cos((k + 1) * pi * t + 0.7 * k * k) / std::sqrt(k + 1.0) + 0.3 * std::sin(2 * pi * t * (k % 3 + 1));
  return v;
}

/// The curve of that velocity along a warp, exact at its nodes.
Curve curve(const TimeWarp& warp) {
  constexpr Index n = 129;
  Eigen::MatrixXd v(5, n);
  for (Index k = 0; k < n; ++k) {
    const double t = double(k) / (n - 1);
    v.col(k) = velocity(warp(t)) * warp.slope(t);
  }
  return {Eigen::VectorXd::Zero(5), v};
}

TemporalOptions quick_options() {
  TemporalOptions o;
  o.grid = 100;
  o.cosines = {8, 16};
  return o;
}

}  // namespace

TEST_CASE("a known warp of time is recovered", "[elastic]") {
  const std::uint64_t seed = GENERATE(1u, 2u, 3u, 4u);
  const TimeWarp warp = random_warp(seed, 0.5);
  const TemporalResult r = register_temporally(curve({}), curve(warp), quick_options());
  INFO("the warp is " << distance(warp, {}) << ", missed by " << distance(r.warp, inverse(warp)));
  CHECK(distance(r.warp, inverse(warp)) < 1e-3);
  CHECK(r.summary.energy_after < 1e-3 * r.summary.energy_before);
  CHECK(r.summary.min_slope > 0.1);
}

TEST_CASE("a strong warp is recovered with the default options", "[elastic]") {
  const TimeWarp warp = random_warp(3, 1.0);
  CHECK(distance(register_temporally(curve({}), curve(warp)).warp, inverse(warp)) < 2e-3);
}

TEST_CASE("a curve is registered to itself, and to a resting one, by the identity", "[elastic]") {
  const Curve rest(Eigen::VectorXd::Zero(5), Eigen::MatrixXd::Zero(5, 9));
  CHECK(distance(register_temporally(curve({}), curve({}), quick_options()).warp, {}) == 0);
  CHECK(distance(register_temporally(rest, rest, quick_options()).warp, {}) == 0);
  const TemporalResult r = register_temporally(curve({}), rest, quick_options());
  CHECK(r.summary.energy_after <= r.summary.energy_before);
  CHECK(distance(r.warp, {}) < 1e-12);
}

TEST_CASE("dynamic programming follows a piecewise linear warp on its own grid", "[elastic]") {
  constexpr int n = 61;
  Eigen::MatrixXd q2(5, n), q1(5, n);
  const auto zeta = [](double t) { return t < 0.5 ? t / 2 : 0.25 + (t - 0.5) * 1.5; };
  for (int k = 0; k < n; ++k) {
    const double t = double(k) / (n - 1), slope = t < 0.5 ? 0.5 : 1.5;
    q2.col(k) = srvf(velocity(t));
    q1.col(k) = std::sqrt(slope) * srvf(velocity(zeta(t)));
  }
  const Eigen::VectorXd warp = detail::dynamic_programming_warp(q1, q2, 5);
  double worst = 0;
  for (int k = 0; k < n; ++k) worst = std::max(worst, std::abs(warp[k] - zeta(double(k) / (n - 1))));
  CHECK(worst < 0.035);  // two nodes: the corner and the interpolated q2 leave no more freedom
}

TEST_CASE("curves of different dimensions are refused", "[elastic]") {
  const Curve flat(Eigen::VectorXd::Zero(2), Eigen::MatrixXd::Zero(2, 9));
  CHECK_THROWS_AS(register_temporally(flat, curve({})), InvalidArgument);
}

}  // namespace temporal_registration_test
