#include "catch.hpp"

#include <dsns/sphere/rotations.hpp>

namespace rotations_test {

using namespace dsns;

TEST_CASE("exponential and logarithm of rotations invert each other", "[sphere]") {
  for (const Vec3d& w : {Vec3d(0, 0, 0), Vec3d(1e-9, 0, 0), Vec3d(0.3, -1.2, 0.5), Vec3d(0, 3.1, 0)}) {
    const Mat3 R = rotation_exp(w);
    CHECK((R.transpose() * R - Mat3::Identity()).norm() < 1e-14);
    CHECK((rotation_log(R) - w).norm() < 1e-8);
    CHECK(rotation_angle(R) == Approx(w.norm()).margin(1e-8));
  }
}

TEST_CASE("the nearest rotation undoes a known one and never reflects", "[sphere]") {
  std::mt19937_64 random(5);
  const Mat3 R = random_rotation(random);
  const Mat3X b = Mat3X::Random(3, 30), a = R * b;
  CHECK((nearest_rotation(a * b.transpose()) - R).norm() < 1e-13);
  Mat3 mirror = Mat3::Identity();
  mirror(2, 2) = -1;
  CHECK(nearest_rotation(mirror).determinant() == Approx(1));
}

TEST_CASE("every rotation has a grid rotation near it", "[sphere]") {
  const auto grid = rotation_grid(600);
  CHECK(grid.size() == 600);
  CHECK(grid.front() == Mat3::Identity());
  std::mt19937_64 random(1);
  double worst = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Mat3 R = random_rotation(random);
    double nearest = pi;
    for (const Mat3& G : grid) nearest = std::min(nearest, rotation_angle(R.transpose() * G));
    worst = std::max(worst, nearest);
  }
  CHECK(worst * 180 / pi < 32);  // 600 balls of 19 degrees fill SO(3); no grid covers it with smaller ones
}

}  // namespace rotations_test
