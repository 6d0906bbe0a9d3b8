#include "catch.hpp"

#include <dsns/elastic/geodesic.hpp>
#include <dsns/stats/valid_samples.hpp>

namespace valid_samples_test {

using namespace dsns;

namespace {

Faces hinge() {
  Faces faces(3, 2);
  faces.col(0) << 1, 0, 2;
  faces.col(1) << 0, 1, 3;
  return faces;
}

/// Positions of a hinge at rest: its fourth vertex at (height, 0, 1), so that the sides meet at under 60 degrees where the
/// height is above 1 / sqrt(3).
Eigen::VectorXd hinge_at(double height) {
  Eigen::VectorXd x(12);
  x << 0, 0, 0, 0, 1, 0, 1, 0, 0, height, 0, 1;
  return x;
}
double height_of(const RegisteredMotion& motion) { return motion.start[9]; }

std::vector<Mat3X> frames(const Eigen::MatrixXd& points, int times) {
  std::vector<Mat3X> out;
  for (int k = 0; k < times; ++k) out.push_back(interpolate(points, k / (times - 1.0)).reshaped(3, 4));
  return out;
}

/// Members at heights -1, 0 and 1: one mode of variance 1.
PrincipalModes family() {
  KarcherMean mean;
  mean.start = hinge_at(0);
  mean.q = Eigen::MatrixXd::Zero(12, time_grid().times.size());
  mean.warps.resize(3);
  std::vector<Curve> curves;
  for (const double height : {-1.0, 0.0, 1.0}) curves.push_back(curve_of_srvf(hinge_at(height), mean.q));
  return {mean, curves, MotionPart::start};
}

}  // namespace

TEST_CASE("samples are the draws that do not fold, in their order; the rest is counted", "[stats]") {
  const PrincipalModes modes = family();
  REQUIRE(modes.model().variances()[0] == Approx(1));
  const MotionInspection inspect(frames, modes.at(Eigen::VectorXd(0)).points(), hinge());
  std::vector<MotionDefects> members;
  for (Index i = 0; i < 3; ++i) members.push_back(inspect(modes.at(modes.model().scores().col(i))));
  CHECK(members[1].folded == 0);
  CHECK(members[2].folded == 1);
  ValidityBounds bounds = bounds_of_members(members);
  CHECK(bounds.folded == Approx(0.002));  // the median member does not fold
  bounds.growth = 10;                     // of folds alone

  const SampleOptions options{1, 30, 5, 1, 4};
  const ValidSamples found = draw_valid_samples(modes, inspect, bounds, options);
  const Eigen::MatrixXd drawn = random_scores(modes.model(), 1, 150, 4);
  std::vector<double> expected;
  int draws = 0;
  while (expected.size() < 30) {
    const double height = height_of(modes.at(drawn.col(draws++)));
    if (height <= 1 / std::sqrt(3.0)) expected.push_back(height);
  }
  REQUIRE(found.complete);
  REQUIRE(found.samples.size() == 30);
  for (std::size_t i = 0; i < 30; ++i) CHECK(height_of(found.samples[i].motion) == expected[i]);
  CHECK(found.draws == draws);
  CHECK(found.folded == draws - 30);
  CHECK(found.folded > 0);
  CHECK(found.slow + found.collapsed == 0);

  // the same seed, the same samples; fewer are the first of them
  const ValidSamples again = draw_valid_samples(modes, inspect, bounds, {1, 5, 5, 1, 4});
  REQUIRE(again.samples.size() == 5);
  for (std::size_t i = 0; i < 5; ++i) CHECK(again.samples[i].scores == found.samples[i].scores);
  CHECK(draw_valid_samples(modes, inspect, bounds, {1, 5, 5, 1, 5}).samples[0].scores != found.samples[0].scores);
  // within 1 / sqrt(3) of the mean none folds: three deviations of 0.19
  CHECK(draw_valid_samples(modes, inspect, bounds, {1, 30, 1, 0.19, 4}).folded == 0);
}

TEST_CASE("where no draw is valid the attempts end", "[stats]") {
  const PrincipalModes modes = family();
  const auto torn = [](const RegisteredMotion&) { return MotionDefects{0.5, 0.3, 0.2, 0.4}; };
  const ValidSamples none = draw_valid_samples(modes, torn, {0.01, 0.2, 1, 1}, {1, 4, 3});
  CHECK_FALSE(none.complete);
  CHECK(none.samples.empty());
  CHECK(none.draws == 12);
  CHECK(none.folded == 12);
  CHECK(draw_valid_samples(modes, torn, {0.6, 1, 1, 1}, {1, 4, 3}).slow == 12);
  CHECK(draw_valid_samples(modes, torn, {0.01, 1, 0.1, 1}, {1, 4, 3}).collapsed == 12);
  CHECK(draw_valid_samples(modes, torn, {0.5, 0.3, 0.2, 0.4}, {1, 4, 3}).complete);
  CHECK(draw_valid_samples(modes, torn, {0.01, 1, 1, 0.3}, {1, 4, 3}).swollen == 12);
  const auto lost = [](const RegisteredMotion&) { return MotionDefects{std::nan("")}; };
  CHECK(draw_valid_samples(modes, lost, {}, {1, 4, 3}).slow == 12);
  CHECK_THROWS_AS(draw_valid_samples(modes, torn, {}, {1, 0, 3}), InvalidArgument);
  CHECK_THROWS_AS(draw_valid_samples(modes, torn, {}, {1, 1, 1, 0}), InvalidArgument);
  CHECK_THROWS_AS(bounds_of_members({}), InvalidArgument);
}

TEST_CASE("a motion is inspected at all times, and its pace", "[stats]") {
  const PrincipalModes modes = family();
  const MotionInspection inspect(frames, modes.at(Eigen::VectorXd(0)).points(), hinge());
  const TimeGrid grid = time_grid();
  Eigen::MatrixXd moving(12, grid.times.size());
  for (Index k = 0; k < moving.cols(); ++k) moving.col(k) = hinge_at(grid.times[k] - 0.3);  // folds from 0.877 on
  RegisteredMotion motion = modes.at(Eigen::VectorXd(0));
  motion.start = hinge_at(-0.3);
  motion.q.row(9).setOnes();
  motion.warp = random_time_warp(1, 0.2, 2);
  CHECK((motion.points() - moving).cwiseAbs().maxCoeff() < 1e-12);
  CHECK(inspect(motion).folded == 1);
  CHECK(inspect(motion).min_slope == Approx(0.2).epsilon(1e-3));
  motion.start = hinge_at(-0.5);  // to 0.5: never
  CHECK(inspect(motion).folded == 0);
  // twice as large: four times the area
  motion.start = 2 * hinge_at(0);
  motion.q.setZero();
  CHECK(inspect(motion).growth == Approx(std::log(4)));
  CHECK(bounds_of_members({{}, inspect(motion), {}}).growth == Approx(std::log(4) + 0.1));
  // shrunk to a point but for one triangle
  motion.start = hinge_at(0);
  motion.start.tail(3) *= 0.002;
  motion.q.setZero();
  CHECK(inspect(motion).collapsed == Approx(0.5));
}

}  // namespace valid_samples_test
