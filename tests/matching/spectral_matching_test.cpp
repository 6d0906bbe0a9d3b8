#include "catch.hpp"

#include <dsns/matching/spectral_matching.hpp>
#include <dsns/surface/bodies.hpp>

namespace spectral_matching_test {

using namespace dsns;

namespace {

/// A body with a mirror plane (y to -y) but for small differences, whose limbs are turned by `pose`.
LimbedBody creature(double pose) {
  LimbedBody body;
  body.axes = {1, 0.55, 0.7};
  const auto limb = [&](const Vec3d& root, double sharpness, const Vec3d& reach, const Vec3d& axis) {
    body.limbs.push_back({root.normalized(), sharpness, rotation_exp(pose * axis) * reach});
  };
  limb(Vec3d(0.8, -0.7, -0.5), 9, Vec3d(0.3, -1.1, -0.2), Vec3d(0.5, 0, 0.3));
  limb(Vec3d(0.8, 0.7, -0.5), 9, Vec3d(0.3, 1.1, -0.2), Vec3d(0.3, 0, 0.4));
  limb(Vec3d(-0.8, -0.6, -0.5), 9, Vec3d(-0.2, -0.6, -0.7), Vec3d(0.2, 0.3, 0));
  limb(Vec3d(-0.8, 0.6, -0.5), 9, Vec3d(-0.2, 0.6, -0.7), Vec3d(0.4, -0.3, 0));
  limb(Vec3d(0.6, 0, 0.9), 10, Vec3d(0.4, 0, 0.8), Vec3d(0.2, 0.4, 0));
  return body;
}

struct At {
  LimbedBody body;
  SphereDiffeomorphism gamma;
  template <class T>
  Vec3<T> operator()(const Vec3<T>& s) const {
    return body(gamma(s), T(0.0));
  }
};

SpectralMatchOptions quick() {
  SpectralMatchOptions options;
  options.samples = 600;
  options.fine_sizes = {16, 20, 25, 30};
  options.starts.rotations = 300;
  return options;
}

double median_angle_deg(const Mat3X& a, const Mat3X& b) {
  std::vector<double> angles;
  for (Index i = 0; i < a.cols(); ++i) angles.push_back(angle_between(a.col(i), b.col(i)) * 180 / pi);
  std::nth_element(angles.begin(), angles.begin() + Index(angles.size() / 2), angles.end());
  return angles[angles.size() / 2];
}

}  // namespace

TEST_CASE("a body in another pose on another sphere is matched, and not to its mirror image", "[matching]") {
  SphereDiffeomorphism gamma(rotation_exp(Vec3d(1.3, -0.8, 0.4)));
  const SphereDiffeomorphism warp = random_diffeomorphism(5, 3, 4 * pi / 180);
  for (const auto& v : warp.increments()) gamma.append(v);
  // second(s) = creature(gamma(s)): s of the first corresponds to the point that gamma sends to s.
  const auto [first, second] =
      spectral_pair(matching_body(At{creature(0), {}}, 3), matching_body(At{creature(0.5), gamma}, 3), 30);
  const SpectralMatch match = match_spectrally(first, second, quick());
  const TriangleMesh grid = icosphere(2);
  const Mat3X truth = gamma.inverse(grid.vertices);
  const SpectralTargets targets = targets_for(match, first, second, grid);
  const Mat3X wanted = targets.of_map(match.map);
  INFO("start " << median_angle_deg(match.start(grid.vertices), truth) << " degrees, targets "
                << median_angle_deg(wanted, truth) << ", orientation " << match.orientation);
  CHECK(median_angle_deg(match.start(grid.vertices), truth) < 12);
  CHECK(median_angle_deg(wanted, truth) < 5);
  CHECK(match.orientation > 0.6);
  CHECK(match.candidates.size() == 6);

  // Targets that follow the true map are near it, and the map taken from it is orthogonal.
  CHECK(median_angle_deg(targets(truth), truth) < 4);
  const Eigen::MatrixXd C = targets.functional_map(truth);
  CHECK((C.transpose() * C - Eigen::MatrixXd::Identity(30, 30)).norm() < 1e-9);
}

TEST_CASE("of a body and its mirror image left corresponds to left, though the mirror is an exact isometry",
          "[matching]") {
  const At body{creature(0.4), {}};
  const auto mirrored = [&](const auto& s) {
    auto p = body(std::decay_t<decltype(s)>(s[0], -s[1], s[2]));
    p[1] = -p[1];
    return p;
  };
  const auto [first, second] = spectral_pair(matching_body(body, 3), matching_body(mirrored, 3), 30);
  REQUIRE((first.spectrum.eigenvalues - second.spectrum.eigenvalues).cwiseAbs().maxCoeff() <
          0.02 * first.spectrum.eigenvalues[29]);
  const SpectralMatch match = match_spectrally(first, second, quick());
  const TriangleMesh grid = icosphere(2);
  Mat3X mirror = grid.vertices;
  mirror.row(1) *= -1;
  const Mat3X wanted = targets_for(match, first, second, grid).of_map(match.map);
  INFO("from the same side " << median_angle_deg(wanted, grid.vertices) << " degrees, from the mirror "
                             << median_angle_deg(wanted, mirror) << ", orientation " << match.orientation);
  CHECK(median_angle_deg(wanted, grid.vertices) < 8);
  CHECK(median_angle_deg(wanted, mirror) > 20);
  CHECK(match.orientation > 0.6);
}

TEST_CASE("a caller's start takes part in the choice", "[matching]") {
  const auto [first, second] =
      spectral_pair(matching_body(At{creature(0), {}}, 3), matching_body(At{creature(0.3), {}}, 3), 30);
  SpectralMatchOptions options = quick();
  options.starts.refined = 1;
  options.starts.kept = 1;
  options.starts.rotations = 1;
  options.starts.registration.field_degrees = {};
  const SphereDiffeomorphism other(rotation_exp(Vec3d(0, 0, 0.05)));
  const SpectralMatch match = match_spectrally(first, second, options, {other});
  REQUIRE(match.candidates.size() == 2);
  CHECK(match.candidates[match.chosen].score == std::min(match.candidates[0].score, match.candidates[1].score));
  CHECK(match.start.rotation() == (match.chosen == 1 ? other.rotation() : Mat3::Identity().eval()));
}

}  // namespace spectral_matching_test
