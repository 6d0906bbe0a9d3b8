#include <dsns/mesh/repair.hpp>
#include <dsns/mesh/sphere_mask.hpp>
#include <dsns/mesh/spherical_parameterization.hpp>

#include "catch.hpp"
#include "support/bodies.hpp"

namespace sphere_mask_test {

using namespace dsns;

TEST_CASE("the mask is 1 on an open surface and its rims, 0 inside its caps", "[mesh]") {
  // A ball without its top and with one triangle missing near the equator.
  TriangleMesh ball = icosphere(3);
  std::vector<Index> kept;
  bool hole = false;
  for (Index f = 0; f < ball.faces.cols(); ++f) {
    const Vec3d centre = ball.vertices(Eigen::all, ball.faces.col(f)).rowwise().mean();
    if (centre.z() > 0.6) continue;
    if (!hole && std::abs(centre.z()) < 0.1) {
      hole = true;
      continue;
    }
    kept.push_back(f);
  }
  ball.faces = Faces(ball.faces(Eigen::all, kept));
  const RepairResult repaired = repair(test::still(ball));
  const MeshSequence& sequence = repaired.sequence;
  REQUIRE(sequence.cap_faces > 10);
  const Mat3X sphere = spherical_parameterization(sequence).sphere;
  const SphereMask mask(sequence, sphere);
  const Eigen::VectorXd at_vertices = mask(sphere);
  for (Index v = 0; v < sphere.cols(); ++v)
    CHECK(at_vertices[v] == (repaired.source_vertex[std::size_t(v)] < 0 ? 0 : 1));
  for (Index f = 0; f < sequence.faces.cols(); ++f) {
    const bool cap = f >= sequence.faces.cols() - sequence.cap_faces;
    const Vec3d inside = sphere(Eigen::all, sequence.faces.col(f)).rowwise().sum().normalized();
    CHECK(mask(inside) == (cap ? 0 : 1));
  }
}

TEST_CASE("the mask of a closed surface is 1", "[mesh]") {
  const TriangleMesh ball = icosphere(2);
  CHECK(SphereMask(test::still(ball), ball.vertices)(test::random_unit_vectors(500, 3)).minCoeff() == 1);
}

}  // namespace sphere_mask_test
