#include "catch.hpp"

#include <dsns/elastic/srnf_inversion.hpp>

namespace srnf_inversion_test {

using namespace dsns;

namespace {

/// s -> A s + b, with harmonics of degree 1.
HarmonicSurface affine_sphere(const Mat3& A, const Vec3d& b, int degree) {
  Eigen::MatrixX3d c = Eigen::MatrixX3d::Zero(harmonic_count(degree), 3);
  const double unit = std::sqrt(4 * pi / 3);  // Y_1 = (y, z, x) / unit
  c.row(0) = std::sqrt(4 * pi) * b.transpose();
  c.row(1) = unit * A.col(1).transpose();
  c.row(2) = unit * A.col(2).transpose();
  c.row(3) = unit * A.col(0).transpose();
  return HarmonicSurface(c);
}

HarmonicSurface bumpy(int degree, double size) {
  Eigen::MatrixX3d c = affine_sphere(Mat3::Identity(), Vec3d::Zero(), degree).coefficients();
  const Eigen::ArrayXd l = harmonic_degrees(degree);
  for (Index k = 1; k < c.rows(); ++k)
    for (int a = 0; a < 3; ++a) c(k, a) += size * std::sin(2.3 * double(k) + 1.7 * a) / (1 + l[k]);
  return HarmonicSurface(c);
}

}  // namespace

TEST_CASE("the surface of a field is found again, where the start lies", "[elastic]") {
  const SphereQuadrature q = sphere_quadrature(24);
  const SrnfInversion inversion(q, 5);
  for (const double size : {0.05, 0.2}) {
    const HarmonicSurface truth = bumpy(5, size), start = affine_sphere(Mat3::Identity(), Vec3d(1, 2, 3), 5);
    const InversionResult r = inversion(srnf(truth, q.points), start);
    CHECK(r.converged);
    CHECK(r.start_residual > 0.05);
    CHECK(r.residual < 1e-10);
    const Eigen::MatrixX3d c = r.surface.coefficients();
    CHECK((c - truth.coefficients()).bottomRows(c.rows() - 1).norm() < 1e-7);
    CHECK((c.row(0) - start.coefficients().row(0)).norm() == 0);
  }
}

TEST_CASE("an ellipsoid's field gives the ellipsoid, started from the sphere", "[elastic]") {
  const SphereQuadrature q = sphere_quadrature(30);
  const Mat3 axes = Vec3d(1, 1.6, 0.7).asDiagonal();
  const HarmonicSurface sphere = affine_sphere(Mat3::Identity(), Vec3d::Zero(), 1);
  const InversionResult r = SrnfInversion(q, 4)(srnf(affine_sphere(axes, Vec3d::Zero(), 1), q.points), sphere);
  CHECK(r.residual < 1e-10);
  const Vec3d s = Vec3d(1, 2, 2) / 3;
  CHECK((r.surface(s) - axes * s).norm() < 1e-8);
}

TEST_CASE("between two spheres lie spheres of mean radius and mean centre", "[elastic]") {
  const SphereQuadrature q = sphere_quadrature(20);
  const SrnfInversion inversion(q, 3);
  const Vec3d b(0.5, 0, -1);
  const SrnfPath path(affine_sphere(Mat3::Identity(), Vec3d::Zero(), 3), affine_sphere(2 * Mat3::Identity(), b, 3),
                      inversion, q);
  CHECK(path.distance() == Approx(std::sqrt(4 * pi)).epsilon(1e-12));  // h = r s
  const InversionResult r = path.at(0.25);
  CHECK(r.residual < 1e-10);
  const Vec3d s = Vec3d(2, -1, 2) / 3;
  CHECK((r.surface(s) - (1.25 * s + b / 4)).norm() < 1e-9);
}

TEST_CASE("a field that is no surface's leaves a residual, and wrong arguments are refused", "[elastic]") {
  const SphereQuadrature q = sphere_quadrature(20);
  const SrnfInversion inversion(q, 3);
  const HarmonicSurface sphere = affine_sphere(Mat3::Identity(), Vec3d::Zero(), 3);
  // The normals n |n| of a closed surface integrate to zero; these do not.
  Mat3X field = q.points;
  field.row(2).array() += 0.5;
  const InversionResult r = inversion(field, sphere);
  CHECK(r.residual > 0.1);
  CHECK(r.residual < r.start_residual);
  CHECK_THROWS_AS(inversion(Mat3X::Zero(3, q.size()), sphere), InvalidArgument);
  CHECK_THROWS_AS(inversion(Mat3X::Ones(3, 7), sphere), InvalidArgument);
  CHECK_THROWS_AS(SrnfInversion(q, 0), InvalidArgument);
  CHECK_THROWS_AS(SrnfInversion(sphere_quadrature(4), 9), InvalidArgument);
}

}  // namespace srnf_inversion_test
