#include "catch.hpp"

#include <dsns/mesh/folds.hpp>
#include <dsns/sphere/rotations.hpp>

namespace folds_test {

using namespace dsns;

namespace {

/// Two unit right triangles that share an edge and open by an angle: 180 degrees is flat, 0 shut.
TriangleMesh hinge(double degrees) {
  const double a = degrees * pi / 180;
  TriangleMesh mesh{Mat3X(3, 4), Faces(3, 2)};
  mesh.vertices.col(0) = Vec3d(0, 0, 0);
  mesh.vertices.col(1) = Vec3d(0, 1, 0);
  mesh.vertices.col(2) = Vec3d(1, 0, 0);
  mesh.vertices.col(3) = Vec3d(std::cos(a), 0, std::sin(a));
  mesh.faces.col(0) << 1, 0, 2;
  mesh.faces.col(1) << 0, 1, 3;
  return mesh;
}

}  // namespace

TEST_CASE("a hinge folds where its sides meet at under 60 degrees", "[mesh]") {
  const FoldedShare share(hinge(180).faces);
  for (const double angle : {180.0, 90.0, 61.0}) CHECK(share.folded(hinge(angle).vertices) == 0);
  for (const double angle : {59.0, 1.0}) CHECK(share.folded(hinge(angle).vertices) == 1);
  CHECK(FoldedShare(hinge(180).faces, {0, 0.01}).folded(hinge(89).vertices) == 1);
  CHECK_THROWS_AS(share.folded(Mat3X::Zero(3, 4)), InvalidArgument);
}

TEST_CASE("a fan whose middle is pulled over its rim folds there, wherever it lies", "[mesh]") {
  TriangleMesh fan{Mat3X::Zero(3, 7), Faces(3, 6)};
  for (int k = 0; k < 6; ++k) {
    fan.vertices.col(k + 1) = Vec3d(std::cos(k * pi / 3), std::sin(k * pi / 3), 0);
    fan.faces.col(k) << 0, k + 1, (k + 1) % 6 + 1;
  }
  const FoldedShare share(fan.faces);
  CHECK(share.folded(fan.vertices) == 0);
  fan.vertices(0, 0) = 2;
  // Twice the areas are 1, 1, 3, 3, 1, 1 times the height of a side: the first and the last are turned over and fold with the
  // second and the fifth.
  CHECK(share.folded(fan.vertices) == Approx(0.4));
  const Mat3X moved = (3 * rotation_exp({0.3, 0.2, 0.9}) * fan.vertices).colwise() + Vec3d(1, 2, 3);
  CHECK(share.folded(moved) == Approx(0.4));
}

TEST_CASE("a triangle that shrinks has collapsed, one that turns or all that shrink have not", "[mesh]") {
  TriangleMesh flat = hinge(180);
  const FoldedShare share(flat.faces);
  Mat3X thin = flat.vertices;
  thin.col(3).x() *= 0.001;
  CHECK(share.collapsed(thin, flat.vertices) == Approx(0.5));
  thin.col(3).x() *= 20;
  CHECK(share.collapsed(thin, flat.vertices) == 0);
  CHECK(share.collapsed(0.001 * flat.vertices, flat.vertices) == 0);
  CHECK(share.collapsed(hinge(30).vertices, flat.vertices) == 0);
}

}  // namespace folds_test
