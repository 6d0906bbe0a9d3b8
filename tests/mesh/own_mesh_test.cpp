#include <dsns/mesh/own_mesh.hpp>
#include <dsns/sphere/rotations.hpp>

#include "catch.hpp"
#include "support/bodies.hpp"

namespace own_mesh_test {

using namespace dsns;

namespace {

/// A ball whose vertices are split along its equator as file formats do, a small loose ball beside it, and a vertex that no
/// face uses.
MeshSequence seamed() {
  TriangleMesh mesh = test::joined(icosphere(2), test::stretched(icosphere(0), Vec3d::Constant(0.1)));
  const Index n = mesh.vertices.cols(), ball = icosphere(2).vertices.cols();
  mesh.vertices.rightCols(n - ball).colwise() += Vec3d(0, 0, 1.3);
  std::vector<int> twin(std::size_t(n), -1);
  Mat3X vertices = mesh.vertices;
  for (Index f = 0; f < icosphere(2).faces.cols(); ++f) {
    if (mesh.vertices(Eigen::all, mesh.faces.col(f)).row(2).mean() > 0) continue;
    for (int k = 0; k < 3; ++k) {
      int& v = mesh.faces(k, f);
      if (mesh.vertices(2, v) < -1e-9) continue;
      if (twin[std::size_t(v)] < 0) {
        twin[std::size_t(v)] = int(vertices.cols());
        vertices.conservativeResize(3, vertices.cols() + 1);
        vertices.rightCols<1>() = mesh.vertices.col(v);
      }
      v = twin[std::size_t(v)];
    }
  }
  vertices.conservativeResize(3, vertices.cols() + 1);
  vertices.rightCols<1>() << 0.5, 0.5, 0.5;
  return test::still({vertices, mesh.faces});
}

}  // namespace

TEST_CASE("what was given comes back where nothing moved, and turns and grows with the body", "[mesh]") {
  const MeshSequence given = seamed();
  const RepairResult repaired = repair(given);
  REQUIRE(repaired.sequence.vertex_count() == icosphere(2).vertices.cols());
  const OwnMesh own(given, repaired);
  REQUIRE(own.vertex_count() == given.vertex_count());
  CHECK((own.moved(repaired.sequence.frames[0]) - given.frames[0]).norm() < 1e-13);
  Index dropped = 0;
  for (Index v = 0; v < given.vertex_count(); ++v)
    if (const Index became = own.repaired_vertex(v); became < 0)
      ++dropped;
    else
      CHECK((repaired.sequence.frames[0].col(became) - given.frames[0].col(v)).norm() < 1e-13);
  CHECK(dropped == icosphere(0).vertices.cols() + 1);  // of the loose ball, and the one that no face uses
  CHECK_THROWS_AS(own.repaired_vertex(given.vertex_count()), InvalidArgument);

  const Mat3 R = rotation_exp(Vec3d(0.3, -1.2, 0.8));
  const auto moved = [&](const Mat3X& x) { return Mat3X((2.5 * R * x).colwise() + Vec3d(1, 2, 3)); };
  CHECK((own.moved(moved(repaired.sequence.frames[0])) - moved(given.frames[0])).norm() < 1e-12);
}

TEST_CASE("both sides of a seam stay together, a loose piece stays on the surface", "[mesh]") {
  const MeshSequence given = seamed();
  const RepairResult repaired = repair(given);
  Mat3X bent = repaired.sequence.frames[0];
  bent.row(0) += 0.3 * bent.row(2).cwiseAbs2();
  bent.row(2) *= 1.5;
  const Mat3X out = OwnMesh(given, repaired).moved(bent);
  for (Index i = 0; i < out.cols(); ++i)
    for (Index j = 0; j < i; ++j)
      if (given.frames[0].col(i) == given.frames[0].col(j)) CHECK(out.col(i) == out.col(j));
  const Index ball = icosphere(2).vertices.cols();
  for (Index v = ball; v < ball + 12; ++v) CHECK(out(2, v) > 1.5);  // over the pole, which moved up
}

TEST_CASE("a repair of another mesh is refused", "[mesh]") {
  CHECK_THROWS_AS(OwnMesh(test::still(icosphere(1)), repair(test::still(icosphere(2)))), InvalidArgument);
  const MeshSequence ball = test::still(icosphere(1));
  CHECK_THROWS_AS(OwnMesh(ball, repair(ball)).moved(Mat3X::Zero(3, 5)), InvalidArgument);
}

TEST_CASE("the nearest point of a triangle is that of a search", "[mesh]") {
  test::Uniform uniform(4);
  for (int round = 0; round < 200; ++round) {
    Vec3d a, b, c, p;
    for (Vec3d* x : {&a, &b, &c, &p})
      for (int k = 0; k < 3; ++k) (*x)[k] = uniform(-1, 1);
    const Vec3d w = detail::nearest_in_triangle(p, a, b, c);
    CHECK(w.minCoeff() >= 0);
    CHECK(w.sum() == Approx(1));
    const double found = (w[0] * a + w[1] * b + w[2] * c - p).norm();
    double searched = 1e9;
    constexpr int n = 60;
    for (int i = 0; i <= n; ++i)
      for (int j = 0; i + j <= n; ++j)
        searched = std::min(searched, ((i * a + j * b + (n - i - j) * c) / n - p).norm());
    CHECK(found <= searched + 1e-12);
    CHECK(found > searched - 0.06);
  }
}

}  // namespace own_mesh_test
