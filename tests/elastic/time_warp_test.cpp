#include "catch.hpp"

#include <dsns/elastic/time_warp.hpp>

#include <utility>

namespace time_warp_test {

using namespace dsns;

namespace {

Eigen::VectorXd vector(std::initializer_list<double> values) {
  Eigen::VectorXd v(static_cast<Index>(values.size()));
  std::copy(values.begin(), values.end(), v.begin());
  return v;
}

}  // namespace

TEST_CASE("warps keep their ends, increase, and have the slope of their differences", "[elastic]") {
  const TimeWarp warp = random_warp(3, 0.8);
  CHECK(warp(0) == 0);
  CHECK(warp(1) == 1);
  CHECK(warp.min_slope() > 0);
  constexpr double h = 1e-6;
  for (const double t : {0.1, 0.333, 0.5, 0.871})
    CHECK(warp.slope(t) == Approx((warp(t + h) - warp(t - h)) / (2 * h)).epsilon(1e-5));
}

TEST_CASE("a constant log-slope is the identity; a linear one has the closed form", "[elastic]") {
  CHECK(distance(TimeWarp::from_log_slope(Eigen::VectorXd::Constant(401, 3.0)), TimeWarp()) < 1e-14);
  const TimeWarp warp = TimeWarp::from_log_slope(Eigen::VectorXd::LinSpaced(401, 0, 1));
  for (const double t : {0.2, 0.5, 0.9}) CHECK(warp(t) == Approx(std::expm1(t) / std::expm1(1.0)).epsilon(1e-6));
}

TEST_CASE("composition with the inverse is the identity", "[elastic]") {
  const TimeWarp warp = random_warp(9, 1.0);
  CHECK(distance(compose(warp, inverse(warp)), TimeWarp()) < 1e-6);
  CHECK(distance(compose(inverse(warp), warp), TimeWarp()) < 1e-6);
  CHECK(warp(warp.inverse(0.37)) == Approx(0.37).epsilon(1e-12));
}

TEST_CASE("what is not a warp is refused", "[elastic]") {
  CHECK_THROWS_AS(TimeWarp(vector({0, 0.5, 0.9}), vector({1, 1, 1})), InvalidArgument);
  CHECK_THROWS_AS(TimeWarp(vector({0, -0.1, 1}), vector({1, 1, 1})), InvalidArgument);
  CHECK_THROWS_AS(TimeWarp(vector({0, 0.5, 1}), vector({1, 0, 1})), InvalidArgument);
  CHECK_THROWS_AS(TimeWarp(vector({0, 0.5, 1}), vector({1, 1})), InvalidArgument);
}

TEST_CASE("steep data are interpolated monotonically", "[elastic]") {
  const TimeWarp warp(vector({0, 0.01, 0.99, 1}), vector({5, 5, 5, 5}));
  double last = 0;
  for (int k = 1; k <= 300; ++k) {
    const double value = warp(k / 300.0);
    CHECK(value >= last);
    last = value;
  }
}

TEST_CASE("the mean of a warp and its reversal in the log-slope is near the identity, of equal warps the warp",
          "[elastic]") {
  const TimeWarp warp = random_warp(2, 0.6);
  CHECK(distance(karcher_mean(std::vector<TimeWarp>{warp, warp, warp}), warp) < 1e-6);
  const Eigen::VectorXd u = Eigen::VectorXd::LinSpaced(401, -0.3, 0.3);
  const auto mean = karcher_mean(std::vector<TimeWarp>{TimeWarp::from_log_slope(u), TimeWarp::from_log_slope(-u)});
  // psi1 + psi2 is proportional to cosh((t - 1/2) * 0.3), so the mean's slope is cosh^2, normalised
  const auto integral = [](double x) { return x / 2 + std::sinh(2 * x * 0.3) / (4 * 0.3); };
  for (const double t : {0.25, 0.7})
    CHECK(mean(t) == Approx((integral(t - 0.5) + integral(0.5)) / (2 * integral(0.5))).epsilon(1e-5));
}

TEST_CASE("random warps reach the slopes asked for and keep their ends", "[elastic]") {
  const std::uint64_t seed = GENERATE(1u, 2u, 3u, 4u, 5u, 6u);
  const auto [least, most] = GENERATE(std::pair(0.2, 2.3), std::pair(0.03, 4.0), std::pair(0.9, 1.5));
  const TimeWarp warp = random_time_warp(seed, least, most);
  CHECK(warp(1) == 1);
  CHECK(warp.slopes().minCoeff() == Approx(least).epsilon(1e-9));
  CHECK(warp.slopes().maxCoeff() == Approx(most).epsilon(1e-9));
  CHECK(distance(warp, random_time_warp(seed, least, most)) == 0);
  CHECK(distance(warp, random_time_warp(seed + 1, least, most)) > 1e-3);
}

TEST_CASE("slopes that leave no room for 1 are refused", "[elastic]") {
  CHECK_THROWS_AS(random_time_warp(1, 0, 2), InvalidArgument);
  CHECK_THROWS_AS(random_time_warp(1, 1, 2), InvalidArgument);
  CHECK_THROWS_AS(random_time_warp(1, 0.5, 0.9), InvalidArgument);
}

}  // namespace time_warp_test
