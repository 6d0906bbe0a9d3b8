#include <dsns/matching/target_fit.hpp>

#include <array>

#include "catch.hpp"
#include "support/bodies.hpp"
#include "support/sphere_warps.hpp"

namespace target_fit_test {

using namespace dsns;

namespace {

constexpr double degree = pi / 180;
/// One step a stage and few sweeps: enough for tests.
TargetFitOptions hasty(int level) {
  TargetFitOptions options{.level = level, .sweeps = 5};
  for (TargetFitStage& stage : options.stages) stage.steps = 1;
  return options;
}
const TargetFitOptions quick = hasty(3), fine = hasty(4);

SphereDiffeomorphism truth() { return test::turned_warp(7, 8, 10, Vec3d(0.2, -0.1, 0.3)); }
Mat3X exact_targets(int level) { return truth()(icosphere(level).vertices); }

/// Each target off by Gaussian noise of 5 degrees (rms over both directions), every tenth anywhere.
Mat3X noisy_targets(int level) {
  Mat3X t = exact_targets(level);
  test::Uniform uniform(4);
  const auto normal = [&] { return std::sqrt(-2 * std::log(uniform(1e-12, 1))) * std::cos(uniform(0, 2 * pi)); };
  for (Index i = 0; i < t.cols(); ++i) {
    const auto [e1, e2] = tangent_frame(t.col(i));
    t.col(i) = (t.col(i) + 5 * degree / std::sqrt(2.0) * (normal() * e1 + normal() * e2)).normalized();
    if (uniform(0, 1) < 0.1) t.col(i) = uniform.unit_vector();
  }
  return t;
}

double error(const PiecewiseLinearDiffeomorphism& map) {
  return angular_distance(map, truth(), fibonacci_sphere(2000)).rms / degree;
}

Mat3X permuted(const Mat3X& points, unsigned seed) {
  Mat3X out = points;
  test::Uniform uniform(seed);
  for (Index i = out.cols() - 1; i > 0; --i) out.col(i).swap(out.col(uniform.below(int(i) + 1)));
  return out;
}

}  // namespace

TEST_CASE("target fit: a warp is found from its exact targets", "[matching]") {
  const TargetFit fit = fit_to_targets(SphereDiffeomorphism(), exact_targets(fine.level), fine);
  CHECK(error(fit.map) < 0.05);
  CHECK(fit.summary.min_jacobian > 0);
  CHECK(fit.summary.min_jacobian == certify(fit.map).min_jacobian);
  CHECK(fit.summary.to_targets.rms < 0.1 * degree);
  CHECK(fit.summary.energies.size() == quick.stages.size());
  CHECK(fit.summary.steps == 10);
}

TEST_CASE("target fit: of noise of 5 degrees and a tenth of gross outliers the elastic energy takes most",
          "[matching]") {
  const Mat3X targets = noisy_targets(fine.level);
  TargetFitOptions stiff = fine;
  for (TargetFitStage& stage : stiff.stages) stage.elastic = std::max(stage.elastic, 1e-5);
  const TargetFit soft_fit = fit_to_targets(SphereDiffeomorphism(), targets, fine);
  const TargetFit stiff_fit = fit_to_targets(SphereDiffeomorphism(), targets, stiff);
  CHECK(error(soft_fit.map) < 3);
  CHECK(error(stiff_fit.map) < 1.6);
  CHECK(error(stiff_fit.map) < 0.7 * error(soft_fit.map));
  CHECK(certify(stiff_fit.map).holds());
}

TEST_CASE("target fit: no targets make it fold", "[matching]") {
  const Mat3X s = icosphere(quick.level).vertices;
  const Mat3X mirrored = Vec3d(1, 1, -1).asDiagonal() * s;
  for (const Mat3X& targets : {permuted(s, 1), mirrored, Mat3X(-s), Mat3X(Vec3d::UnitX().replicate(1, s.cols()))}) {
    const TargetFit fit = fit_to_targets(SphereDiffeomorphism(), targets, quick);
    CHECK(certify(fit.map.images(), fit.map.faces()).bijective());
    CHECK(min_jacobian(fit.map, fibonacci_sphere(5000).points) > 0);
  }
}

TEST_CASE("target fit: landmarks are met, as far as their weights say", "[matching]") {
  const Mat3X s = icosphere(fine.level).vertices;
  SphereLandmarks landmarks{test::random_unit_vectors(6, 8), Mat3X(3, 6), Eigen::VectorXd::Constant(6, 0.1)};
  landmarks.targets = test::turned_warp(2, 4, 8, Vec3d::Zero())(landmarks.points);
  REQUIRE(angular_distance(landmarks.points, landmarks.targets, landmarks.weights).rms > 5 * degree);
  const TargetFit heavy = fit_to_targets(SphereDiffeomorphism(), s, fine, landmarks);
  landmarks.weights *= 1e-4;
  const TargetFit light = fit_to_targets(SphereDiffeomorphism(), s, fine, landmarks);
  CHECK(heavy.summary.to_landmarks.largest < 0.3 * degree);
  CHECK(light.summary.to_landmarks.largest > 5 * degree);
  CHECK(certify(heavy.map).holds());
  CHECK(angular_distance(heavy.map(landmarks.points), landmarks.targets, landmarks.weights).largest ==
        heavy.summary.to_landmarks.largest);
}

TEST_CASE("target fit: many given correspondences alone determine the map", "[matching]") {
  const Index n = 800;
  const Mat3X s = test::random_unit_vectors(n, 9);
  TargetFitOptions options = quick;
  options.weights = Eigen::VectorXd::Zero(icosphere(quick.level).vertices.cols());
  const TargetFit fit = fit_to_targets(SphereDiffeomorphism(), icosphere(quick.level).vertices, options,
                                       {s, truth()(s), Eigen::VectorXd::Constant(n, 1.0 / double(n))});
  CHECK(error(fit.map) < 0.15);
}

TEST_CASE("target fit: targets see the map as it is, on the vertices of the finest level", "[matching]") {
  const Mat3X goal = exact_targets(quick.level);
  std::vector<double> distances;
  const TargetFit fit = fit_to_targets(
      SphereDiffeomorphism(),
      [&](const Mat3X& images) -> Mat3X {
        REQUIRE(images.cols() == goal.cols());
        CHECK((images.colwise().norm().array() - 1).abs().maxCoeff() < 1e-12);
        distances.push_back((images - goal).norm() / std::sqrt(double(goal.cols())));
        return goal;
      },
      quick);
  REQUIRE(distances.size() == quick.stages.size());
  CHECK(distances.front() ==
        Approx((icosphere(3).vertices - goal).norm() / std::sqrt(double(goal.cols()))).epsilon(0.02));
  CHECK(distances.back() < 0.02 * distances.front());
}

TEST_CASE("target fit: starts from either model, a fine one that a coarse level would fold too", "[matching]") {
  const TriangleMesh ico = icosphere(quick.level);
  Mat3X twisted(3, ico.vertices.cols());
  for (Index i = 0; i < twisted.cols(); ++i)
    twisted.col(i) = (rotation_exp(Vec3d(0, 0, 3.5 * ico.vertices(2, i))) * ico.vertices.col(i)).normalized();
  const PiecewiseLinearDiffeomorphism start(ico, twisted);
  REQUIRE_FALSE(certify(start(icosphere(1).vertices), icosphere(1).faces).bijective());
  TargetFitOptions options = quick;
  options.stages.front().level = 1;
  const TargetFit fit = fit_to_targets(
      start,
      [&](const Mat3X& images) -> Mat3X {
        CHECK(certify(images, ico.faces).bijective());
        return twisted;
      },
      options);
  CHECK(angular_distance(fit.map, start, fibonacci_sphere(1000)).rms < 2 * degree);
}

TEST_CASE("target fit: the same input gives the same bits", "[matching]") {
  const Mat3X t = noisy_targets(quick.level);
  CHECK(fit_to_targets(SphereDiffeomorphism(), t, quick).map.images() ==
        fit_to_targets(SphereDiffeomorphism(), t, quick).map.images());
}

TEST_CASE("target fit: misfitting input is refused", "[matching]") {
  const Mat3X s = icosphere(quick.level).vertices;
  const SphereDiffeomorphism identity;
  CHECK_THROWS_AS(fit_to_targets(identity, icosphere(2).vertices, quick), InvalidArgument);
  CHECK_THROWS_AS(fit_to_targets(identity, Mat3X(2 * s), quick), InvalidArgument);
  CHECK_THROWS_AS(fit_to_targets(identity, Mat3X(std::nan("") * s), quick), InvalidArgument);
  CHECK_THROWS_AS(fit_to_targets(identity, s, quick, {s, s, {}}), InvalidArgument);
  CHECK_THROWS_AS(fit_to_targets(identity, s, quick, {s, 2 * s, Eigen::VectorXd::Ones(s.cols())}), InvalidArgument);
  CHECK_THROWS_AS(fit_to_targets(identity, s, quick, {s, s, -Eigen::VectorXd::Ones(s.cols())}), InvalidArgument);
  TargetFitOptions options = quick;
  options.weights = -Eigen::VectorXd::Ones(s.cols());
  CHECK_THROWS_AS(fit_to_targets(identity, s, options), InvalidArgument);
  options = quick;
  options.stages.clear();
  CHECK_THROWS_AS(fit_to_targets(identity, s, options), InvalidArgument);
}

}  // namespace target_fit_test
