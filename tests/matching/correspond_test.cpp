#include "catch.hpp"

#include <dsns/matching/correspond.hpp>
#include <dsns/surface/bodies.hpp>

namespace correspond_test {

using namespace dsns;

namespace {

/// A body with four legs and a head, left nearly the mirror image of right, whose limbs are turned by `pose` radians, as seen
/// through a map of its sphere.
struct Creature {
  LimbedBody body;
  SphereDiffeomorphism gamma;

  explicit Creature(double pose, SphereDiffeomorphism map = SphereDiffeomorphism()) : gamma(std::move(map)) {
    body.axes = {1, 0.55, 0.7};
    const auto limb = [&](const Vec3d& root, double sharpness, const Vec3d& reach, const Vec3d& axis) {
      body.limbs.push_back({root.normalized(), sharpness, rotation_exp(pose * axis) * reach});
    };
    limb(Vec3d(0.8, -0.7, -0.5), 9, Vec3d(0.3, -1.1, -0.2), Vec3d(0.5, 0, 0.3));
    limb(Vec3d(0.8, 0.7, -0.5), 9, Vec3d(0.3, 1.1, -0.2), Vec3d(0.3, 0, 0.4));
    limb(Vec3d(-0.8, -0.6, -0.5), 9, Vec3d(-0.2, -0.6, -0.7), Vec3d(0.2, 0.3, 0));
    limb(Vec3d(-0.8, 0.6, -0.5), 9, Vec3d(-0.2, 0.6, -0.7), Vec3d(0.4, -0.3, 0));
    limb(Vec3d(0.6, 0, 0.9), 10, Vec3d(0.4, 0, 0.8), Vec3d(0.2, 0.4, 0));
  }
  template <class T>
  Vec3<T> operator()(const Vec3<T>& s) const {
    return body(gamma(s), T(0.0));
  }
};

double median_angle_deg(const Mat3X& a, const Mat3X& b) {
  std::vector<double> angles;
  for (Index i = 0; i < a.cols(); ++i) angles.push_back(angle_between(a.col(i), b.col(i)) * 180 / pi);
  std::nth_element(angles.begin(), angles.begin() + Index(angles.size() / 2), angles.end());
  return angles[angles.size() / 2];
}

CorrespondOptions quick() {
  CorrespondOptions options;
  options.eigenpairs = 30;
  options.descriptors.eigenpairs = 30;
  options.match.samples = 600;
  options.match.coarse_sizes = {16, 20};
  options.match.fine_sizes = {24, 30};
  options.match.starts.rotations = 300;
  options.fit.level = 3;
  return options;
}

}  // namespace

TEST_CASE("a body in another pose on another sphere corresponds to itself", "[matching]") {
  SphereDiffeomorphism gamma(rotation_exp(Vec3d(1.3, -0.8, 0.4)));
  const SphereDiffeomorphism warp = random_diffeomorphism(5, 3, 4 * pi / 180);
  for (const auto& v : warp.increments()) gamma.append(v);
  // The point of the second sphere that gamma sends to s is the same point of the body as s of the first.
  const Correspondence c = correspond(matching_body(Creature(0), 3), matching_body(Creature(0.4, gamma), 3), quick());
  const Mat3X s = fibonacci_sphere(300).points, truth = gamma.inverse(s);
  INFO("median " << median_angle_deg(c.gamma(s), truth) << " degrees, orientation " << c.summary.orientation);
  CHECK(median_angle_deg(c.gamma(s), truth) < 5);
  CHECK(c.summary.orientation > 0.7);
  CHECK(c.summary.fit.min_jacobian > 0);
  CHECK(certify(c.gamma).holds());
}

TEST_CASE("landmarks draw the correspondence to them", "[matching]") {
  const Mat3X points = fibonacci_sphere(12).points;
  const SphereDiffeomorphism moved = random_diffeomorphism(9, 3, 6 * pi / 180);
  const SphereLandmarks landmarks{points, moved(points), Eigen::VectorXd::Constant(12, 0.5)};
  const Correspondence free = correspond(matching_body(Creature(0), 3), matching_body(Creature(0), 3), quick()),
                       drawn = correspond(matching_body(Creature(0), 3), matching_body(Creature(0), 3), quick(), {},
                                          landmarks);
  INFO("missed by " << median_angle_deg(free.gamma(points), landmarks.targets) << " degrees without them, by "
                    << median_angle_deg(drawn.gamma(points), landmarks.targets) << " with them");
  CHECK(median_angle_deg(drawn.gamma(points), landmarks.targets) <
        0.5 * median_angle_deg(free.gamma(points), landmarks.targets));
  CHECK(certify(drawn.gamma).holds());
}

}  // namespace correspond_test
