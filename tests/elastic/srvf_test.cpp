#include "catch.hpp"

#include <dsns/elastic/geodesic.hpp>

namespace srvf_test {

using namespace dsns;

namespace {

/// A helix of radius r and pitch p for t in [0, 1]: speed and length sqrt((2 pi r)^2 + p^2).
Curve helix(double r, double p, const TimeWarp& warp = {}) {
  constexpr Index n = 129;
  Eigen::MatrixXd v(3, n);
  for (Index k = 0; k < n; ++k) {
    const double t = double(k) / (n - 1), z = warp(t);
    v.col(k) << -2 * pi * r * std::sin(2 * pi * z), 2 * pi * r * std::cos(2 * pi * z), p;
    v.col(k) *= warp.slope(t);
  }
  return {Eigen::Vector3d(r, 0, 0), v};
}

}  // namespace

TEST_CASE("the squared norm of an SRVF is the length, whatever the clock", "[elastic]") {
  const double length = std::sqrt(std::pow(2 * pi * 0.5, 2) + 1);
  const TimeGrid grid = time_grid();
  CHECK(squared_norm(warped_srvf(helix(0.5, 1), {}, grid), grid) == Approx(length).epsilon(1e-6));
  CHECK(squared_norm(warped_srvf(helix(0.5, 1), random_warp(4, 0.5), grid), grid) == Approx(length).epsilon(1e-4));
}

TEST_CASE("warping a curve's SRVF is the SRVF of the warped curve", "[elastic]") {
  const TimeGrid grid = time_grid();
  const TimeWarp warp = random_warp(4, 0.5);
  const Eigen::MatrixXd a = warped_srvf(helix(0.5, 1), warp, grid), b = warped_srvf(helix(0.5, 1, warp), {}, grid);
  CHECK(std::sqrt(squared_norm(a - b, grid)) < 1e-3);
}

TEST_CASE("integrating the SRVF gives the curve back", "[elastic]") {
  const TimeGrid grid = time_grid();
  const Curve curve = helix(0.5, 1);
  const Eigen::MatrixXd points = integrate_srvf(curve.start(), warped_srvf(curve, {}, grid), grid);
  for (Index k = 0; k < grid.times.size(); k += 50) {
    const double t = grid.times[k];
    CHECK((points.col(k) - Eigen::Vector3d(0.5 * std::cos(2 * pi * t), 0.5 * std::sin(2 * pi * t), t)).norm() < 1e-4);
  }
}

TEST_CASE("a resting curve has no SRVF and no NaN", "[elastic]") {
  const Curve rest(Eigen::Vector3d(1, 2, 3), Eigen::MatrixXd::Zero(3, 20));
  const TimeGrid grid = time_grid();
  const Eigen::MatrixXd q = warped_srvf(rest, random_warp(1, 0.5), grid);
  CHECK(q.norm() == 0);
  CHECK((integrate_srvf(rest.start(), q, grid).colwise() - rest.start()).norm() == 0);
}

TEST_CASE("geodesics end where they should and their distance is symmetric under one clock", "[elastic]") {
  const Curve a = helix(0.5, 1), b = helix(0.8, 0.4);
  const CurveGeodesic way(a, b, {}), back(b, a, {});
  CHECK(way.distance() == Approx(back.distance()));
  CHECK(CurveGeodesic(a, a, {}).distance() < 1e-12);
  const TimeGrid grid = time_grid();
  CHECK((way.points(0) - integrate_srvf(a.start(), warped_srvf(a, {}, grid), grid)).norm() < 1e-12);
  CHECK((way.points(1) - integrate_srvf(b.start(), warped_srvf(b, {}, grid), grid)).norm() < 1e-12);
  // In (start, q) the way is straight: equal steps have equal lengths.
  const Eigen::MatrixXd q0 = warped_srvf(a, {}, grid), q1 = warped_srvf(b, {}, grid);
  CHECK(std::pow(way.distance(), 2) == Approx((a.start() - b.start()).squaredNorm() + squared_norm(q0 - q1, grid)));
}

TEST_CASE("a curve without two velocities is refused", "[elastic]") {
  CHECK_THROWS_AS(Curve(Eigen::Vector3d::Zero(), Eigen::MatrixXd::Zero(3, 1)), InvalidArgument);
  CHECK_THROWS_AS(Curve(Eigen::Vector3d::Zero(), Eigen::MatrixXd::Zero(2, 9)), InvalidArgument);
}

TEST_CASE("velocities at irregular times give the same curve", "[elastic]") {
  const std::vector<double> times{0, 0.1, 0.15, 0.4, 0.8, 1};
  // a = (t^2, t^4): cubic velocities, which the spline meets exactly
  Eigen::MatrixXd v(2, 6);
  for (Index k = 0; k < 6; ++k) {
    const double t = times[std::size_t(k)];
    v.col(k) << 2 * t, 4 * t * t * t;
  }
  const Curve curve(Eigen::Vector2d(0, 1), v, times);
  for (const double t : {0.0, 0.05, 0.33, 0.9, 1.0}) {
    CHECK((curve.velocity(t) - Eigen::Vector2d(2 * t, 4 * t * t * t)).norm() < 1e-12);
    CHECK((curve.acceleration(t) - Eigen::Vector2d(2, 12 * t * t)).norm() < 1e-11);
    CHECK((curve(t) - Eigen::Vector2d(t * t, 1 + t * t * t * t)).norm() < 1e-12);
  }
  CHECK((curve.end() - Eigen::Vector2d(1, 2)).norm() < 1e-12);
  CHECK_THROWS_AS(Curve(Eigen::Vector2d(0, 1), v, {0, 0.1, 0.15, 0.4, 0.8, 0.9}), InvalidArgument);
  CHECK_THROWS_AS(Curve(Eigen::Vector2d(0, 1), v, {0, 0.5, 1}), InvalidArgument);
}

TEST_CASE("the curve through points is their cubic spline", "[elastic]") {
  const std::vector<double> times{0, 0.2, 0.3, 0.6, 1};
  Eigen::MatrixXd x(1, 5);
  for (Index k = 0; k < 5; ++k) x(0, k) = std::pow(times[std::size_t(k)], 3) + 2;
  const Curve curve = curve_through(x, times);
  CHECK(curve.start()[0] == 2);
  CHECK(curve.end()[0] == Approx(3).epsilon(1e-12));
  for (const double t : {0.0, 0.1, 0.5, 0.77}) CHECK(curve.velocity(t)[0] == Approx(3 * t * t).margin(1e-11));
}

TEST_CASE("a warped curve has the velocity of the chain rule", "[elastic]") {
  const TimeWarp warp = random_time_warp(2, 0.5, 1.6);
  const Curve a = warped(helix(0.5, 1), warp);
  for (const double t : {0.1, 0.5, 0.83})
    CHECK((a.velocity(t) - warp.slope(t) * helix(0.5, 1).velocity(warp(t))).norm() < 1e-6);
}

TEST_CASE("the rate of the SRVF is that of differences", "[elastic]") {
  const Curve a = warped(helix(0.5, 1), random_time_warp(2, 0.5, 1.6));
  constexpr double h = 1e-5;
  for (const double t : {0.1, 0.5, 0.83}) {
    const Eigen::VectorXd difference = (srvf_rate(a, t + h).value - srvf_rate(a, t - h).value) / (2 * h);
    CHECK((srvf_rate(a, t).rate - difference).norm() < 1e-6 * difference.norm());
    CHECK((srvf_rate(a, t).value - srvf(a.velocity(t))).norm() < 1e-12);
  }
}

TEST_CASE("windows of time run around", "[elastic]") {
  const TimeWindow window{0.7, 0.5};
  CHECK(window(0) == 0.7);
  CHECK(window(0.6) == 1);
  CHECK(window(0.8) == Approx(0.1));
  CHECK(TimeWindow{}(1) == 1);
  CHECK(TimeWindow{0, 2}(0.75) == Approx(0.5));
}

TEST_CASE("interpolation between columns is linear and exact at them", "[elastic]") {
  Eigen::MatrixXd x(1, 3);
  x << 1, 2, 5;
  CHECK(interpolate(x, 0)[0] == 1);
  CHECK(interpolate(x, 0.75)[0] == Approx(3.5));
  CHECK(interpolate(x, 1)[0] == 5);
}

}  // namespace srvf_test
