#include <dsns/mesh/sphere_certificate.hpp>

#include <cmath>

#include "catch.hpp"
#include "support/bodies.hpp"

namespace sphere_certificate_test {

using namespace dsns;

TEST_CASE("the certificate counts turned triangles and double covers", "[certificate]") {
  TriangleMesh sphere = icosphere(2);
  CHECK(certify(sphere.vertices, sphere.faces).bijective());
  CHECK(certify(sphere.vertices, sphere.faces).area_defect < 1e-12);
  CHECK(certify(sphere.vertices, sphere.faces).min_area_ratio > 0.7);
  sphere.vertices.col(3) = -sphere.vertices.col(3);
  CHECK(certify(sphere.vertices, sphere.faces).flips > 0);
  CHECK_FALSE(certify(sphere.vertices, sphere.faces).bijective());

  // longitude doubled: all triangles stay positive, the poles are wound around twice
  TriangleMesh twice = latitude_longitude_sphere(9, 40);
  for (Index v = 0; v < twice.vertices.cols(); ++v) {
    const Vec3d s = twice.vertices.col(v);
    const double angle = 2 * std::atan2(s.y(), s.x()), r = std::hypot(s.x(), s.y());
    twice.vertices.col(v) << r * std::cos(angle), r * std::sin(angle), s.z();
  }
  const auto certificate = certify(twice.vertices, twice.faces);
  CHECK(certificate.flips == 0);
  CHECK(certificate.area_defect == Approx(4 * pi));
  CHECK_FALSE(certificate.bijective());
}

TEST_CASE("the sign of a determinant is exact where rounding hides it", "[certificate]") {
  const Vec3d a(0.6, 0.8, 0), b(0.5, 0.5, 0.7);
  const Vec3d on = 0.5 * a + 0.25 * b;  // exact in binary only to rounding: shift by the last bit decides
  const Eigen::Matrix<long double, 3, 1> la = a.cast<long double>(), lb = b.cast<long double>();
  int seen[3] = {0, 0, 0};
  for (int shift = -40; shift <= 40; ++shift) {
    Vec3d c = on;
    c.x() += shift * 0x1p-56;
    const long double value = la.dot(lb.cross(c.cast<long double>()));
    if (std::abs(value) < 1e-18L) continue;  // beyond extended precision too
    CHECK(detail::exact_determinant_sign(a, b, c) == (value > 0 ? 1 : -1));
    ++seen[value > 0 ? 2 : 0];
  }
  CHECK(seen[0] > 10);
  CHECK(seen[2] > 10);
  CHECK(detail::exact_determinant_sign(a, b, a) == 0);
  CHECK(detail::exact_determinant_sign(Vec3d(1, 2, 4), Vec3d(2, 4, 8), Vec3d(0.1, 0.7, 0.9)) == 0);
  CHECK_FALSE(detail::positively_oriented(a, b, a));
  CHECK(spherical_area(Vec3d::UnitX(), Vec3d::UnitY(), Vec3d::UnitZ()) == Approx(pi / 2));
  CHECK(spherical_area(Vec3d::UnitX(), Vec3d::UnitZ(), Vec3d::UnitY()) == Approx(-pi / 2));
}

}  // namespace sphere_certificate_test
