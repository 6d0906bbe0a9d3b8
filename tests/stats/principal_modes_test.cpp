#include "catch.hpp"

#include <dsns/stats/principal_modes.hpp>

namespace principal_modes_test {

using namespace dsns;

namespace {

constexpr double size_of_shapes = 0.1, size_of_paces = 0.2;

Eigen::MatrixXd base_q() {
  const TimeGrid grid = time_grid();
  Eigen::MatrixXd q(3, grid.times.size());
  for (Index k = 0; k < q.cols(); ++k) q.col(k) << 1, std::cos(3 * grid.times[k]), std::sin(2 * grid.times[k]);
  return q;
}

/// Of unit norm.
Eigen::MatrixXd change_of_shape() {
  const TimeGrid grid = time_grid();
  Eigen::MatrixXd d = Eigen::MatrixXd::Zero(3, grid.times.size());
  for (Index k = 0; k < d.cols(); ++k) d(2, k) = std::sin(pi * grid.times[k]);
  return d / std::sqrt(squared_norm(d, grid));
}
Eigen::VectorXd change_of_pace() { return std::sqrt(2.0) * (2 * pi * time_grid().times.array()).cos(); }

/// The mean and curves whose registered motions are mean +- a change of shape, then of pace, then of start.
struct Family {
  KarcherMean mean;
  std::vector<Curve> curves;

  Family() {
    const TimeGrid grid = time_grid();
    mean.start = Eigen::Vector3d(1, 2, 3);
    mean.q = base_q();
    const auto add = [&](double shape, double pace, double start) {
      const Eigen::MatrixXd q = base_q() + shape * size_of_shapes * change_of_shape();
      const TimeWarp warp = warp_of_tangent(pace * size_of_paces * change_of_pace(), grid);
      // the curve that, taken along the warp, has this q
      const Curve own = curve_of_srvf(mean.start + start * 0.05 * Vec3d::UnitX(), q);
      curves.push_back(curve_of_srvf(own.start(), warped_srvf(own, inverse(warp), grid)));
      mean.warps.push_back(warp);
    };
    for (const double sign : {-1.0, 1.0}) {
      add(sign, 0, 0);
      add(0, sign, 0);
      add(0, 0, sign);
    }
  }
};

}  // namespace

TEST_CASE("warps and tangents at the identity lead to one another", "[stats]") {
  const TimeGrid grid = time_grid();
  CHECK(warp_tangent({}, grid).norm() < 1e-7);
  CHECK(distance(warp_of_tangent(Eigen::VectorXd::Zero(grid.times.size()), grid), {}) == 0);
  const TimeWarp warp = random_warp(3, 0.6);
  CHECK(distance(warp_of_tangent(warp_tangent(warp, grid), grid), warp) < 1e-5);
  // psi of t^2 is sqrt(2 t); its angle to 1 is arccos of the integral, 2 sqrt(2) / 3.
  const TimeWarp square = detail::tabulated_warp([](double t) { return t * t; }, [](double t) { return 2 * t; });
  CHECK(std::sqrt(warp_tangent(square, grid).cwiseAbs2().dot(grid.weights)) ==
        Approx(std::acos(2 * std::sqrt(2.0) / 3)).epsilon(1e-3));
  // however long a tangent is, time goes forward
  for (const double length : {0.5, 1.5, 3.0}) CHECK(warp_of_tangent(length * change_of_pace(), grid).min_slope() > 0);
}

TEST_CASE("principal modes: each part alone has the direction and variance of the family", "[stats]") {
  const Family family;
  const TimeGrid grid = time_grid();
  const auto alone = [&](MotionPart part) { return PrincipalModes(family.mean, family.curves, part); };
  // six members, two of them at +-size: variance 2 size^2 / 5
  const PrincipalModes shape = alone(MotionPart::shape), pace = alone(MotionPart::pace),
                       start = alone(MotionPart::start);
  CHECK(shape.model().variances()[0] == Approx(0.4 * std::pow(size_of_shapes, 2)).epsilon(1e-3));
  CHECK(pace.model().variances()[0] == Approx(0.4 * std::pow(size_of_paces, 2)).epsilon(1e-3));
  CHECK(start.model().variances()[0] == Approx(0.4 * std::pow(0.05, 2)).epsilon(1e-3));
  CHECK(shape.model().variances()[0] > 0.999 * shape.model().total_variance());

  const RegisteredMotion moved = shape.at(shape.deviations(0, std::sqrt(2.5)));
  const double along = (moved.q - family.mean.q).cwiseProduct(change_of_shape()).colwise().sum() * grid.weights;
  CHECK(std::abs(along) == Approx(size_of_shapes).epsilon(1e-3));
  CHECK(squared_norm(moved.q - family.mean.q - along * change_of_shape(), grid) < 1e-6);
  CHECK(moved.start == family.mean.start);
  CHECK(distance(moved.warp, {}) < 1e-9);

  const RegisteredMotion paced = pace.at(pace.deviations(0, std::sqrt(2.5)));
  CHECK(std::min(distance(paced.warp, family.mean.warps[1]), distance(paced.warp, family.mean.warps[4])) < 1e-3);
  CHECK(paced.q == family.mean.q);
  CHECK_THROWS_AS(start.deviations(start.model().modes(), 1), InvalidArgument);
}

TEST_CASE("principal modes: together they reproduce every member; pace counts as much as shape and start", "[stats]") {
  const Family family;
  const PrincipalModes modes(family.mean, family.curves);
  const double shapes = 0.4 * (std::pow(size_of_shapes, 2) + std::pow(0.05, 2));
  CHECK(modes.features().pace_weight() == Approx(shapes / (0.4 * std::pow(size_of_paces, 2))).epsilon(1e-3));
  CHECK(modes.model().total_variance() == Approx(2 * shapes).epsilon(1e-3));
  const std::vector<RegisteredMotion> members = registered_motions(family.mean, family.curves);
  const TimeGrid grid = time_grid();
  for (std::size_t i = 0; i < members.size(); ++i) {
    const RegisteredMotion back = modes.at(modes.model().scores().col(Index(i)));
    CHECK((back.start - members[i].start).norm() < 1e-6);
    CHECK(squared_norm(back.q - members[i].q, grid) < 1e-10);
    CHECK(distance(back.warp, members[i].warp) < 1e-4);
  }
  // a motion on its own clock is the curve it came from
  const Eigen::MatrixXd own = members[1].points_at_own_pace();
  const Eigen::MatrixXd given = integrate_srvf(family.curves[1].start(), warped_srvf(family.curves[1], {}, grid), grid);
  CHECK((own - given).colwise().norm().maxCoeff() < 2e-3);
  CHECK((own - members[1].points()).colwise().norm().maxCoeff() > 0.02);
  CHECK_THROWS_AS(registered_motions(family.mean, {family.curves[0]}), InvalidArgument);
}

}  // namespace principal_modes_test
