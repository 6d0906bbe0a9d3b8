#include <dsns/mesh/triangle_mesh.hpp>

#include <cmath>

#include "catch.hpp"

namespace triangle_mesh_test {

using namespace dsns;

namespace {

/// The cube [0, 1]^3: 8 vertices, 12 outward triangles.
TriangleMesh unit_cube() {
  TriangleMesh cube{Mat3X(3, 8), Faces(3, 12)};
  for (int v = 0; v < 8; ++v) cube.vertices.col(v) << (v & 1), (v >> 1 & 1), (v >> 2 & 1);
  cube.faces << 0, 0, 4, 4, 0, 0, 2, 2, 0, 0, 1, 1,  //
      2, 3, 5, 7, 1, 5, 6, 7, 4, 6, 3, 7,            //
      3, 1, 7, 6, 5, 4, 7, 3, 6, 2, 7, 5;
  return cube;
}

}  // namespace

TEST_CASE("area and volume of the unit cube", "[triangle_mesh]") {
  TriangleMesh cube = unit_cube();
  CHECK(area(cube) == Approx(6).epsilon(1e-15));
  CHECK(volume(cube) == Approx(1).epsilon(1e-15));

  SECTION("volume does not depend on the place") {
    cube.vertices.colwise() += Vec3d(10, -20, 30);
    CHECK(volume(cube) == Approx(1).epsilon(1e-12));
  }
  SECTION("volume of faces turned inside out is negative") {
    cube.faces.row(1).swap(cube.faces.row(2));
    CHECK(volume(cube) == Approx(-1).epsilon(1e-15));
    CHECK(area(cube) == Approx(6).epsilon(1e-15));
  }
  SECTION("scaling axes by a, b, c") {
    cube.vertices = Vec3d(2, 3, 5).asDiagonal() * cube.vertices;
    CHECK(volume(cube) == Approx(30).epsilon(1e-15));
    CHECK(area(cube) == Approx(2 * (6 + 10 + 15)).epsilon(1e-15));
  }
}

TEST_CASE("face normals of a closed mesh sum to zero and point outwards", "[triangle_mesh]") {
  const TriangleMesh cube = unit_cube();
  const Mat3X normals = face_normals(cube.vertices, cube.faces);
  CHECK(normals.rowwise().sum().norm() < 1e-15);
  for (Index f = 0; f < 12; ++f) {
    CHECK(normals.col(f).norm() == Approx(1));  // twice the area of half a unit square
    const Vec3d from_centre = cube.vertices.col(cube.faces(0, f)) - Vec3d::Constant(0.5);
    CHECK(normals.col(f).dot(from_centre) == Approx(0.5));
  }
}

TEST_CASE("vertex normals are unit, area weighted, and zero where there is no face", "[triangle_mesh]") {
  // Two triangles at a right angle that share the edge from 0 to 1; the first has three times the area of the second.
  Mat3X vertices(3, 5);
  vertices.col(0) << 0, 0, 0;
  vertices.col(1) << 1, 0, 0;
  vertices.col(2) << 0, 3, 0;
  vertices.col(3) << 0, 0, -1;
  vertices.col(4) << 9, 9, 9;
  Faces faces(3, 2);
  faces << 0, 0, 1, 3, 2, 1;
  const Mat3X normals = vertex_normals(vertices, faces);
  CHECK((normals.col(2) - Vec3d::UnitZ()).norm() < 1e-15);
  CHECK((normals.col(3) + Vec3d::UnitY()).norm() < 1e-15);
  CHECK((normals.col(0) - Vec3d(0, -1, 3) / std::sqrt(10.0)).norm() < 1e-15);
  CHECK(normals.col(4).isZero(0));
}

TEST_CASE("vertex normals survive tiny meshes", "[triangle_mesh]") {
  TriangleMesh cube = unit_cube();
  cube.vertices *= 1e-90;  // areas are about 1e-180, their squares underflow
  const Mat3X normals = vertex_normals(cube.vertices, cube.faces);
  for (Index v = 0; v < 8; ++v) CHECK(normals.col(v).norm() == Approx(1));
}

TEST_CASE("vertex areas share each face equally and sum to the area", "[triangle_mesh]") {
  const TriangleMesh cube = unit_cube();
  const Eigen::VectorXd areas = vertex_areas(cube.vertices, cube.faces);
  CHECK(areas.sum() == Approx(6));
  for (Index v = 0; v < 8; ++v) {
    const auto faces_around = (cube.faces.array() == int(v)).count();
    CHECK(areas[v] == Approx(double(faces_around) / 6));
  }
}

TEST_CASE("a sequence counts its vertices and frames", "[triangle_mesh]") {
  MeshSequence sequence;
  CHECK(sequence.vertex_count() == 0);
  CHECK(sequence.frame_count() == 0);
  const TriangleMesh cube = unit_cube();
  sequence.faces = cube.faces;
  sequence.frames = {cube.vertices, 2 * cube.vertices};
  CHECK(sequence.vertex_count() == 8);
  CHECK(sequence.frame_count() == 2);
  CHECK(volume(sequence.frame(1)) == Approx(8));
  CHECK_THROWS(sequence.frame(2));
}

}  // namespace triangle_mesh_test
