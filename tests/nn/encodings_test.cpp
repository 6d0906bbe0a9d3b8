#include "catch.hpp"

#include <dsns/autodiff/dual.hpp>
#include <dsns/autodiff/eigen.hpp>
#include <dsns/nn/encodings.hpp>

namespace encodings_test {

using namespace dsns;

TEST_CASE("encoding: the paper's 80 features", "[nn]") {
  const SurfaceEncoding e = paper_encoding();
  CHECK(e.features() == 80);
  const Vec3d s = Vec3d(1, -2, 2) / 3;
  const Eigen::VectorXd space = e.space(s), time = e.time(0.25);
  REQUIRE(space.size() == 60);
  REQUIRE(time.size() == 20);
  for (int k = 0; k < 10; ++k) {
    const double frequency = 0.1 * (1 << k);
    for (int c = 0; c < 3; ++c) {
      CHECK(space[6 * k + 2 * c] == Approx(std::sin(frequency * s[c])));
      CHECK(space[6 * k + 2 * c + 1] == Approx(std::cos(frequency * s[c])));
    }
    CHECK(time[2 * k] == Approx(std::sin(frequency * 0.25)));
    CHECK(time[2 * k + 1] == Approx(std::cos(frequency * 0.25)));
  }
}

TEST_CASE("encoding: harmonics of degree 1 hold the point itself and time its frequencies", "[nn]") {
  SurfaceEncoding e;
  e.harmonic_degree = 3;
  e.harmonic_decay = 1;
  e.time_frequencies = 2;
  CHECK(e.features() == 15 + 4);
  const Vec3d s = Vec3d(2, -1, 2) / 3;
  const Eigen::VectorXd space = e.space(s);
  CHECK(std::abs(space.head(3).norm() - std::sqrt(3.0)) < 1e-14);
  CHECK(space[1] == Approx(std::sqrt(3.0) * s.z()));
  for (int l = 1; l <= 3; ++l)  // the addition theorem: the squares of one degree sum to 2 l + 1, times the decay
    CHECK(space.segment(l * l - 1, 2 * l + 1).squaredNorm() == Approx((2 * l + 1) / double(l * l)));
  const Eigen::VectorXd time = e.time(0.25);
  CHECK(time[0] == Approx(std::sqrt(0.5)));
  CHECK(time[2] == Approx(1));
  CHECK(time[3] == Approx(0).margin(1e-15));
  CHECK(e.time(Dual<double, 1>::variable(0.0, 0))[2].g[0] == Approx(2 * pi));
}

}  // namespace encodings_test
