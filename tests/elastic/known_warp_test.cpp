#include "catch.hpp"

#include <dsns/elastic/known_warp.hpp>
#include <dsns/elastic/registered_surface.hpp>
#include <dsns/surface/analytic.hpp>

namespace known_warp_test {

using namespace dsns;

namespace {

constexpr double degree = pi / 180;

LimbedBody some_body() {
  LimbedBody body;
  body.axes = {1, 0.8, 0.6};
  body.limbs = {{Vec3d(1, 0.3, 0.2).normalized(), 6, Vec3d(0.7, 0.2, 0.1)},
                {Vec3d(-1, 0.5, 0.4).normalized(), 5, Vec3d(-0.5, 0.3, 0.3)},
                {Vec3d(0, -1, 0.4).normalized(), 6, Vec3d(0, -0.6, 0.3)}};
  return body;
}

/// Small grids and few levels: what a test can afford under the sanitizers.
SpatialOptions quick() {
  SpatialOptions o;
  o.levels = {{1, 6, 0.03, 0.5}, {2, 6, 0.02, 0.5}, {3, 8, 0.0, 0.5}, {4, 10, 0.0, 0.5}};
  o.latitudes = 14;
  o.rotations = 150;
  o.refined = 3;
  o.refinement = {{6, 8, 0.0, 0.5}};
  return o;
}

}  // namespace

TEST_CASE("a recovery is judged against the truth, turns and warp apart", "[elastic]") {
  const KnownWarp truth = known_warp(3, 3, 4 * degree);
  const WarpRecovery right = recovery(truth, truth.rotation, truth.gamma);
  CHECK(right.missed < 1e-7);
  CHECK(right.missed_rotation < 1e-7);
  CHECK(right.min_jacobian > 0);
  const SphereDiffeomorphism turn(truth.gamma.rotation());
  const Mat3 off = rotation_exp(Vec3d(0.1, 0, 0)) * truth.rotation;
  const WarpRecovery unwarped = recovery(truth, off, turn);
  CHECK(unwarped.missed == Approx(4 * degree).epsilon(0.01));
  CHECK(unwarped.missed_most > unwarped.missed);
  CHECK(unwarped.missed_rotation == Approx(0.1));
  CHECK(unwarped.min_jacobian == Approx(1));
  const KnownWarp still = known_warp(3, 3, 4 * degree, KnownTurns::none);
  CHECK(still.rotation == Mat3::Identity());
  CHECK(still.gamma.rotation() == Mat3::Identity());
  CHECK(still.gamma.increments().size() == truth.gamma.increments().size());
}

TEST_CASE("a refinement of what the projection hid leaves a tenth of the error", "[elastic]") {
  // Bumps of degree 30 and more lie above all degrees of the registration: what is registered after the projection is wrong.
  LimbedBody body = some_body();
  body.limbs.push_back({Vec3d(0.2, 0.3, -1).normalized(), 60, Vec3d(0, 0, -0.2)});
  body.limbs.push_back({Vec3d(0.6, -0.5, -0.6).normalized(), 60, Vec3d(0.1, -0.1, -0.1)});
  const KnownWarp truth = known_warp(7, 3, 8 * degree);
  const RegisteredSurface moved(body, truth.rotation, truth.gamma);
  SpatialOptions options = quick();
  options.refinement = {};
  const SpatialResult rough = register_spatially(at_time(moved, 0.0), at_time(body, 0.0), options);
  options.refinement = {{6, 8, 0.0, 0.5}, {10, 10, 0.0, 0.5}};
  const auto first = at_time(moved, 0.0);
  const auto second = at_time(body, 0.0);
  const SpatialResult fine =
      refine_registration(StillStack<std::remove_cv_t<decltype(first)>>{first},
                          StillStack<std::remove_cv_t<decltype(second)>>{second}, rough, options);
  const WarpRecovery before = recovery(truth, rough.rotation, rough.gamma),
                     after = recovery(truth, fine.rotation, fine.gamma);
  INFO("missed by " << before.missed / degree << " degrees before, " << after.missed / degree << " after");
  CHECK(before.missed > 0.2 * degree);
  CHECK(after.missed < 0.1 * before.missed);
  CHECK(after.missed < 0.03 * degree);
  CHECK(after.min_jacobian > 0);
  CHECK(fine.summary.energy_after < 0.01 * rough.summary.energy_after);
}

TEST_CASE("registration begins at a start that is given", "[elastic]") {
  // The turn of the sphere is far beyond what steps can find; the start has it, and a part of the warp.
  const LimbedBody body = some_body();
  const KnownWarp truth = known_warp(5, 3, 5 * degree);
  const RegisteredSurface moved(body, truth.rotation, truth.gamma);
  SpatialOptions options = quick();
  options.search = RotationSearch::none;
  options.refinement = {};
  options.start.rotation = truth.rotation;
  options.start.gamma = SphereDiffeomorphism(truth.gamma.rotation());
  options.start.gamma.append(truth.gamma.increments().front());
  const SpatialResult r = register_spatially(at_time(moved, 0.0), at_time(body, 0.0), options);
  const double before = recovery(truth, options.start.rotation, options.start.gamma).missed,
               after = recovery(truth, r.rotation, r.gamma).missed;
  INFO("missed by " << before / degree << " degrees at the start, by " << after / degree << " at the end");
  CHECK(after < 0.1 * before);
  CHECK(r.summary.energy_after < 0.01 * r.summary.energy_before);

  options.start = {truth.rotation, truth.gamma};
  options.steps_per_level = 0;
  const SpatialResult same = register_spatially(at_time(moved, 0.0), at_time(body, 0.0), options);
  CHECK(recovery(truth, same.rotation, same.gamma).missed < 1e-7);
  CHECK(same.summary.energy_before == same.summary.energy_after);
  CHECK(same.summary.steps == 0);
}

TEST_CASE("one body seen twice is found on finer fields than two bodies", "[elastic]") {
  const LimbedBody body = some_body();
  const KnownWarp truth = known_warp(5, 3, 5 * degree, KnownTurns::none);
  const RegisteredSurface moved(body, truth.rotation, truth.gamma);
  SpatialOptions options = quick();
  options.search = RotationSearch::none;
  options.refinement = {{6, 8, 0.0, 0.5}, {6, 8, 0.0, 0.5}};
  options.finest = {9, 10, 0.0, 0.5};
  const SpatialResult found = register_spatially(at_time(moved, 0.0), at_time(body, 0.0), options);
  CHECK(found.gamma.increments().back().degree == 9);
  options.one_body = 0;
  const SpatialResult coarse = register_spatially(at_time(moved, 0.0), at_time(body, 0.0), options);
  CHECK(coarse.gamma.increments().back().degree == 6);
  const double fine = recovery(truth, found.rotation, found.gamma).missed,
               rough = recovery(truth, coarse.rotation, coarse.gamma).missed;
  INFO("missed by " << rough / degree << " and " << fine / degree << " degrees");
  CHECK(fine < 0.5 * rough);

  // Another body: the same fields as without.
  options.one_body = 1e-3;
  LimbedBody other = body;
  other.axes = {1, 0.6, 0.9};
  const SpatialResult apart = register_spatially(at_time(other, 0.0), at_time(body, 0.0), options);
  CHECK(apart.gamma.increments().back().degree == 6);
}

TEST_CASE("landmarks bring their points to their places", "[elastic]") {
  // A round body knows nothing of turns about its axis, so that landmarks alone tell; 12 degrees of a twist besides.
  const Ellipsoid body{1, 1, 0.7};
  const Mat3X points = fibonacci_sphere(30).points;
  Mat3X targets = points;
  for (Index i = 0; i < points.cols(); ++i)
    targets.col(i) = rotation_exp(Vec3d(0, 0, 0.5 + 0.2 * points(2, i))) * points.col(i);
  SpatialOptions options = quick();
  options.search = RotationSearch::none;
  const SpatialResult without = register_spatially(body, body, options);
  options.landmarks = {points, targets, Eigen::VectorXd::Constant(30, 0.5)};
  for (const RotationSearch search : {RotationSearch::none, RotationSearch::upright}) {
    options.search = search;
    const SpatialResult r = register_spatially(body, body, options);
    INFO("missed by " << r.summary.landmarks_missed << " radians");
    CHECK(angular_distance(without.gamma(points), targets, options.landmarks.weights).rms > 0.3);
    CHECK(r.summary.landmarks_missed == angular_distance(r.gamma(points), targets, options.landmarks.weights).rms);
    CHECK(r.summary.landmarks_missed < 0.02);
    CHECK(r.summary.min_jacobian > 0);
  }

  options.landmarks.weights[3] = -1;
  CHECK_THROWS_AS(register_spatially(body, body, options), InvalidArgument);
  options.landmarks = {points, targets.leftCols(29), Eigen::VectorXd::Ones(30)};
  CHECK_THROWS_AS(register_spatially(body, body, options), InvalidArgument);
  options.landmarks = {points, 2 * targets, Eigen::VectorXd::Ones(30)};
  CHECK_THROWS_AS(register_spatially(body, body, options), InvalidArgument);
}

}  // namespace known_warp_test
