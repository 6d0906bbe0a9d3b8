#include "catch.hpp"

#include <dsns/stats/matched_registration.hpp>
#include <dsns/surface/bodies.hpp>

namespace matched_registration_test {

using namespace dsns;

namespace {

/// A moving body with four legs and a head, limbs turned by `pose` radians.
LimbedBody creature(double pose) {
  LimbedBody body;
  body.axes = {1, 0.55, 0.7};
  const auto limb = [&](const Vec3d& root, double sharpness, const Vec3d& reach, const Vec3d& axis) {
    body.limbs.push_back({root.normalized(), sharpness, rotation_exp(pose * axis) * reach, Vec3d(0, 0, 0.05)});
  };
  limb(Vec3d(0.8, -0.7, -0.5), 9, Vec3d(0.3, -1.1, -0.2), Vec3d(0.5, 0, 0.3));
  limb(Vec3d(0.8, 0.7, -0.5), 9, Vec3d(0.3, 1.1, -0.2), Vec3d(0.3, 0, 0.4));
  limb(Vec3d(-0.8, -0.6, -0.5), 9, Vec3d(-0.2, -0.6, -0.7), Vec3d(0.2, 0.3, 0));
  limb(Vec3d(-0.8, 0.6, -0.5), 9, Vec3d(-0.2, 0.6, -0.7), Vec3d(0.4, -0.3, 0));
  limb(Vec3d(0.6, 0, 0.9), 10, Vec3d(0.4, 0, 0.8), Vec3d(0.2, 0.4, 0));
  return body;
}

MatchedRegistrationOptions quick() {
  MatchedRegistrationOptions options;
  options.correspond.eigenpairs = 30;
  options.correspond.descriptors.eigenpairs = 30;
  options.correspond.match.samples = 600;
  options.correspond.match.coarse_sizes = {16, 20};
  options.correspond.match.fine_sizes = {24, 30};
  options.correspond.match.starts.rotations = 300;
  options.correspond.fit.level = 3;
  options.smoothing.degrees = {1, 2, 4, 8};
  options.registration.spatial_times = 2;
  options.registration.spatial.latitudes = 12;
  options.refinement = {{6, 8, 0.0, 0.5}};
  options.levels = {{6, 8, 0.0, 0.5}};
  return options;
}

}  // namespace

TEST_CASE("the elastic metric sharpens a correspondence of one pose and is not believed for others", "[stats]") {
  const LimbedBody body = creature(0);
  const SphereDiffeomorphism turn(rotation_exp(Vec3d(1.3, -0.8, 0.4)));
  const RegisteredSurface turned(body, Mat3::Identity(), turn);
  MatchedRegistrationOptions options = quick();
  const Mat3X s = fibonacci_sphere(300).points, truth = turn.inverse(s);
  const Eigen::VectorXd w = Eigen::VectorXd::Ones(s.cols());
  const auto missed = [&](const SpatialResult& r) { return angular_distance(r.gamma(s), truth, w).rms * 180 / pi; };
  options.registration.spatial.search = RotationSearch::upright;

  const MatchedRegistration fine =
      register_matched(body, matching_body(body, 3, 2), turned, matching_body(turned, 3, 2), options);
  options.believed = 0;
  const MatchedRegistration kept =
      register_matched(body, matching_body(body, 3, 2), turned, matching_body(turned, 3, 2), options);
  INFO("missed by " << missed(kept.spatial) << " degrees by the correspondence, by " << missed(fine.spatial)
                    << " refined");
  CHECK(fine.refined);
  CHECK_FALSE(kept.refined);
  CHECK(missed(fine.spatial) < 0.8 * missed(kept.spatial));
  CHECK(missed(fine.spatial) < 1);
  CHECK(fine.spatial.summary.energy_after < fine.spatial.summary.energy_before);
  CHECK(kept.spatial.summary.energy_after == kept.spatial.summary.energy_before);
  CHECK(kept.spatial.summary.min_jacobian > 0);
}

}  // namespace matched_registration_test
