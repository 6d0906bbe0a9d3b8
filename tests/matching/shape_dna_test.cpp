#include "catch.hpp"
#include "support/bodies.hpp"

#include <dsns/matching/shape_dna.hpp>
#include <dsns/sphere/rotations.hpp>

namespace shape_dna_test {

using namespace dsns;

namespace {

enum class Bend { sideways, flatwise };

/// A flat long body that bends back and forth along one of its short axes: x is the length along a circle.
MatchingBody bending(double breadth, Bend bend) {
  const TriangleMesh sphere = icosphere(3);
  MeshSequence sequence;
  sequence.faces = sphere.faces;
  for (const double curvature : {-0.6, -0.2, 0.5}) {
    Mat3X x = Vec3d(1, breadth, 0.15).asDiagonal() * sphere.vertices;
    for (auto p : x.colwise()) {
      const int side = bend == Bend::sideways ? 1 : 2;
      const double radius = 1 / curvature, angle = p.x() * curvature, out = radius + p[side];
      p.x() = out * std::sin(angle);
      p[side] = out * std::cos(angle) - radius;
    }
    sequence.frames.push_back(x);
  }
  return {sequence, sphere.vertices};
}

}  // namespace

TEST_CASE("shape DNA of a sphere is that of l(l + 1)", "[matching]") {
  const Eigen::VectorXd dna = shape_dna(MatchingBody(test::still(icosphere(4)), icosphere(4).vertices), 15);
  Index k = 0;
  for (int l = 1; l <= 3; ++l)
    for (int m = -l; m <= l; ++m)
      CHECK(dna[k++] * std::sqrt(15.0) == Approx(std::log(4 * pi * l * (l + 1))).margin(6e-3));
}

TEST_CASE("shape DNA does not change where a mesh moves, grows or is dented without stretching", "[matching]") {
  const TriangleMesh sphere = icosphere(2);
  TriangleMesh body = sphere;
  body.vertices = Vec3d(1, 0.8, 0.7).asDiagonal() * body.vertices;
  const Eigen::VectorXd dna = shape_dna(MatchingBody(test::still(body), sphere.vertices), 20);
  TriangleMesh moved = body;
  moved.vertices = (7 * rotation_exp({0.4, 1, 0.2}) * body.vertices).colwise() + Vec3d(3, 0, 1);
  CHECK((shape_dna(MatchingBody(test::still(moved), sphere.vertices), 20) - dna).norm() < 1e-9);

  // A vertex of the icosahedron and its five neighbours: mirrored in the neighbours' plane, all lengths stay.
  TriangleMesh dented = sphere;
  Vec3d plane = Vec3d::Zero();
  for (Index f = 0; f < sphere.faces.cols(); ++f)
    for (int k = 0; k < 3; ++k)
      if (sphere.faces(k, f) == 0) plane += sphere.vertices.col(sphere.faces((k + 1) % 3, f)) / 5;
  dented.vertices.col(0) = 2 * plane - sphere.vertices.col(0);
  CHECK((dented.vertices.col(0) - sphere.vertices.col(0)).norm() > 0.05);
  const Eigen::VectorXd ball = shape_dna(MatchingBody(test::still(sphere), sphere.vertices), 20);
  CHECK((shape_dna(MatchingBody(test::still(dented), sphere.vertices), 20) - ball).norm() < 1e-9);
  CHECK((ball - dna).norm() > 0.01);
}

TEST_CASE("by its shape DNA a body is known whatever way it bends", "[matching]") {
  std::vector<Eigen::VectorXd> dna;
  for (const double breadth : {0.25, 0.35})
    for (const Bend bend : {Bend::sideways, Bend::flatwise}) dna.push_back(shape_dna(bending(breadth, bend), 30));
  const double same = std::max((dna[0] - dna[1]).norm(), (dna[2] - dna[3]).norm());
  double other = (dna[0] - dna[2]).norm();
  for (const auto& [i, j] : {std::pair(0u, 3u), {1u, 2u}, {1u, 3u}}) other = std::min(other, (dna[i] - dna[j]).norm());
  INFO("same body " << same << ", others " << other);
  CHECK(same < 0.3 * other);
  CHECK_THROWS_AS(shape_dna(IntrinsicSpectrum{Eigen::VectorXd::Ones(4), {}}, 5), InvalidArgument);
  CHECK_THROWS_AS(shape_dna(IntrinsicSpectrum{Eigen::VectorXd::Zero(4), {}}, 3), InvalidArgument);
}

}  // namespace shape_dna_test
