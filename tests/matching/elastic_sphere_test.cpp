#include <dsns/matching/elastic_sphere.hpp>
#include <dsns/sphere/harmonics.hpp>

#include "catch.hpp"

namespace elastic_sphere_test {

using namespace dsns;

namespace {

double energy(const detail::ElasticSphere& ico, const Mat3X& y) { return (y * ico.energy()).cwiseProduct(y).sum(); }

}  // namespace

TEST_CASE("elastic sphere: rotations are free, harmonics count as their degree says", "[matching]") {
  const detail::ElasticSphere ico(4);
  CHECK(energy(ico, rotation_exp(Vec3d(1, 2, 3)) * ico.vertices()) < 1e-3);
  const Eigen::MatrixXd h = harmonics(ico.vertices(), 6);
  for (const int l : {0, 2, 3, 6}) {
    Mat3X y = Mat3X::Zero(3, ico.size());
    y.row(1) = h.col(Index(l) * l + l + l / 2).transpose();
    const double expected = std::pow((l - 1) * (l + 2), 2) / (4 * pi);  // the mean of Y^2 is 1/(4 pi)
    CHECK(energy(ico, y) == Approx(expected).epsilon(0.04));
  }
}

TEST_CASE("elastic sphere: masses and Jacobians", "[matching]") {
  const detail::ElasticSphere ico(2);
  CHECK(ico.masses().sum() == Approx(1));
  CHECK(ico.face_masses().sum() == Approx(1));
  Mat3X y = ico.vertices();
  CHECK(ico.jacobian(y, 17) == Approx(1));
  // the image of a face drawn together to half its size about one corner
  const Eigen::Vector3i f = ico.faces().col(17);
  for (int k = 1; k < 3; ++k) y.col(f[k]) = (y.col(f[k]) + y.col(f[0])).normalized();
  const double halves =
      (y.col(f[1]) - y.col(f[0])).norm() * (y.col(f[2]) - y.col(f[0])).norm() /
      ((ico.vertices().col(f[1]) - y.col(f[0])).norm() * (ico.vertices().col(f[2]) - y.col(f[0])).norm());
  CHECK(ico.jacobian(y, 17) == Approx(halves).epsilon(0.02));
  y.col(f[1]).swap(y.col(f[2]));
  CHECK(ico.jacobian(y, 17) < 0);
  for (Index v = 0; v < ico.size(); ++v) {
    CHECK(ico.star(v).size() == (v < 12 ? 5 : 6));
    for (const auto& corner : ico.star(v)) CHECK(ico.faces()(corner.place, corner.face) == v);
  }
}

TEST_CASE("elastic sphere: the barrier and its derivatives", "[matching]") {
  const detail::JacobianBarrier b{0.2, 0.7};
  for (const double J : {0.02, 0.05, 0.1, 0.19}) {
    const double h = 1e-5;
    CHECK(b.slope(J) == Approx((b(J + h) - b(J - h)) / (2 * h)).epsilon(1e-5));
    CHECK(b.curvature(J) == Approx((b.slope(J + h) - b.slope(J - h)) / (2 * h)).epsilon(1e-5));
    CHECK(b(J) > 0);
    CHECK(b.slope(J) < 0);
    CHECK(b.curvature(J) > 0);
  }
  CHECK(b(0.2) == 0);
  CHECK(b(5) == 0);
  CHECK(b.curvature(0.2 - 1e-9) == Approx(0).margin(1e-6));
  CHECK(b(0) == std::numeric_limits<double>::infinity());
  CHECK(b(-1) == std::numeric_limits<double>::infinity());
}

}  // namespace elastic_sphere_test
