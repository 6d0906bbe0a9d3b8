#include "catch.hpp"
#include "support/meshes.hpp"

#include <dsns/mesh/deformation_transfer.hpp>
#include <dsns/mesh/sphere_mesh.hpp>
#include <dsns/sphere/rotations.hpp>

namespace deformation_transfer_test {

using namespace dsns;

namespace {

/// A peanut, and what a bend makes of it.
Mat3X peanut(const Mat3X& s) {
  Mat3X x = s;
  for (Index i = 0; i < x.cols(); ++i) x.col(i) *= 0.6 + 0.5 * s(2, i) * s(2, i);
  return x;
}
Mat3X bent(Mat3X x) {
  for (Index i = 0; i < x.cols(); ++i) {
    const double angle = 0.7 * x(2, i);
    x.col(i) = Eigen::AngleAxisd(angle, Vec3d::UnitX()) * Vec3d(x.col(i));
  }
  return x;
}

double apart(const Mat3X& a, const Mat3X& b) { return (a - b).colwise().norm().maxCoeff(); }

}  // namespace

TEST_CASE("deformation transfer: to the same shape it is the source's own deformation", "[mesh]") {
  const TriangleMesh ball = icosphere(2);
  const Mat3X rest = peanut(ball.vertices);
  const DeformationTransfer transfer(rest, rest, ball.faces);
  CHECK(apart(transfer(rest), rest) < 1e-10);
  const Mat3X later = bent(rest);
  CHECK(apart(later, rest) > 0.3);
  CHECK(apart(transfer(later), later) < 1e-10);
}

TEST_CASE("deformation transfer: a similarity of the source is that similarity of any target", "[mesh]") {
  const TriangleMesh ball = icosphere(2);
  const Mat3X source = peanut(ball.vertices), target = 3 * bent(ball.vertices);
  const DeformationTransfer transfer(source, target, ball.faces);
  const Mat3 turn = Eigen::AngleAxisd(1.1, Vec3d(1, 2, 3).normalized()).toRotationMatrix();
  Mat3X later = transfer(1.5 * turn * source);
  const Mat3X wanted = 1.5 * turn * target;
  later.colwise() += Vec3d(wanted.col(0) - later.col(0));  // the centroid follows that of the source
  CHECK(apart(later, wanted) < 1e-9);
  // a shift of the source by 1 is one of the target by the ratio of their sizes
  Mat3X shifted = source;
  shifted.row(0).array() += 1;
  const double ratio = std::sqrt(area({target, ball.faces}) / area({source, ball.faces}));
  Mat3X moved = target;
  moved.row(0).array() += ratio;
  CHECK(apart(transfer(shifted), moved) < 1e-9);
}

TEST_CASE("deformation transfer: a bend carries over to a thicker body", "[mesh]") {
  const TriangleMesh ball = icosphere(3);
  const Mat3X source = peanut(ball.vertices);
  Mat3X target = source;
  target.topRows<2>() *= 1.3;
  const DeformationTransfer transfer(source, target, ball.faces);
  const Mat3X got = transfer(bent(source)), wanted = bent(target);
  const double size = wanted.colwise().norm().maxCoeff();
  CHECK(apart(got, wanted) < 0.1 * size);   // not the same map, but near it
  CHECK(apart(got, target) > 0.25 * size);  // and far from doing nothing
}

TEST_CASE("deformation transfer: a triangle without area in the source does as its neighbours", "[mesh]") {
  const TriangleMesh ball = icosphere(2);
  Mat3X source = peanut(ball.vertices);
  const Mat3X target = peanut(ball.vertices);
  source.col(ball.faces(0, 5)) = source.col(ball.faces(1, 5));  // collapses an edge: two triangles without area
  const DeformationTransfer transfer(source, target, ball.faces);
  const Mat3X got = transfer(bent(source));
  CHECK(got.allFinite());
  CHECK(apart(got, bent(target)) < 0.2);
  CHECK_THROWS_AS(DeformationTransfer(source.leftCols(5), target, ball.faces), InvalidArgument);
  CHECK_THROWS_AS(transfer(source.leftCols(5)), InvalidArgument);
}

}  // namespace deformation_transfer_test
