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

TEST_CASE("interpolation between columns is linear and exact at them", "[elastic]") {
  Eigen::MatrixXd x(1, 3);
  x << 1, 2, 5;
  CHECK(interpolate(x, 0)[0] == 1);
  CHECK(interpolate(x, 0.75)[0] == Approx(3.5));
  CHECK(interpolate(x, 1)[0] == 5);
}

}  // namespace srvf_test
