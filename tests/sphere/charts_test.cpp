#include "catch.hpp"
#include "support/sphere_points.hpp"

#include <dsns/sphere/charts.hpp>

namespace charts_test {

using namespace dsns;

TEST_CASE("chart frames are orthonormal and right-handed everywhere", "[sphere]") {
  const ChartBatch c = charts_at(test::sphere_points());
  for (Index i = 0; i < c.size(); ++i) {
    Mat3 frame;
    frame << c.e1.col(i), c.e2.col(i), c.s.col(i);
    CHECK((frame.transpose() * frame - Mat3::Identity()).norm() < 1e-14);
    CHECK(frame.determinant() == Approx(1));
  }
}

TEST_CASE("charts refuse points off the sphere and say which", "[sphere]") {
  Mat3X s = test::sphere_points();
  s.col(5) *= 1.5;
  try {
    charts_at(s);
    FAIL("no exception");
  } catch (const InvalidArgument& e) {
    CHECK(std::string(e.what()).find("column 5 has length 1.5") != std::string::npos);
  }
}

TEST_CASE("spherical coordinates and angles", "[sphere]") {
  CHECK((spherical_point(0, 2) - Vec3d(0, 0, 1)).norm() < 1e-15);
  CHECK((spherical_point(pi / 2, pi / 2) - Vec3d(0, 1, 0)).norm() < 1e-15);
  CHECK(angle_between(Vec3d::UnitX(), Vec3d::UnitY()) == Approx(pi / 2));
  CHECK(angle_between(Vec3d::UnitX(), -Vec3d::UnitX()) == Approx(pi));
  CHECK(angle_between(Vec3d(1, 1e-9, 0), Vec3d::UnitX()) == Approx(1e-9));  // acos of the product would give 0
}

}  // namespace charts_test
