#include "catch.hpp"
#include "support/bodies.hpp"
#include "support/surfaces.hpp"

#include <dsns/matching/matching_body.hpp>

namespace matching_body_test {

using namespace dsns;

TEST_CASE("lengths are averaged over the frames in units of the mean area", "[matching]") {
  const TriangleMesh sphere = icosphere(1);
  MeshSequence growing = test::still(sphere);
  growing.frames.push_back(2 * sphere.vertices);  // mean area 2.5 times the sphere's, mean length 1.5 times
  const MatchingBody body(growing, sphere.vertices);
  const double a = area(sphere),
               edge = (sphere.vertices.col(sphere.faces(1, 3)) - sphere.vertices.col(sphere.faces(2, 3))).norm();
  CHECK(body.edge_lengths()(0, 3) == Approx(1.5 * edge / std::sqrt(2.5 * a)).epsilon(1e-12));
  CHECK(body.masses().sum() == Approx(1).epsilon(1e-12));
  CHECK((body.masses() - vertex_areas(sphere.vertices, sphere.faces) / a).norm() < 1e-12);
}

TEST_CASE("faces that close holes have length but no mass", "[matching]") {
  const TriangleMesh sphere = icosphere(1);
  MeshSequence capped = test::still(sphere);
  capped.cap_faces = 20;
  const MatchingBody body(capped, sphere.vertices);
  const Eigen::VectorXd expected = vertex_areas(sphere.vertices, sphere.faces.leftCols(60));
  CHECK((body.masses() - expected / expected.sum()).norm() < 1e-12);
  CHECK(body.edge_lengths().col(79).minCoeff() > 0);
  const SphereLocation& location = body.location();
  for (const SphereHit& hit : location.hits(body.sample(200, 5))) CHECK(hit.face < 60);
}

TEST_CASE("vertex functions are interpolated linearly, and weights of a grid are areas", "[matching]") {
  const MatchingBody body = matching_body(Ellipsoid{1, 0.6, 0.4}, 3);
  const Eigen::MatrixXd x = body.sequence().frames[0].transpose();
  const Mat3X s = test::random_unit_vectors(50, 3);
  const Eigen::MatrixXd at = body.interpolate(x, body.location().hits(s));
  const Mat3X exact = positions(Ellipsoid{1, 0.6, 0.4}, s);
  CHECK((at.transpose() - exact).colwise().norm().maxCoeff() < 0.01);
  CHECK((body.interpolate(x, body.location().hits(body.sphere())) - x).norm() < 1e-12);

  const TriangleMesh grid = icosphere(4);
  const Eigen::VectorXd weights = body.area_weights(grid);
  const Mat3X e = positions(Ellipsoid{1, 0.6, 0.4}, grid.vertices);
  const Eigen::VectorXd areas = vertex_areas(e, grid.faces);
  CHECK(weights.sum() == Approx(1).epsilon(1e-12));
  CHECK((weights - areas / areas.sum()).cwiseAbs().maxCoeff() < 0.1 * areas.maxCoeff() / areas.sum());
}

TEST_CASE("a moving surface becomes a body with frames", "[matching]") {
  const MatchingBody body = matching_body(test::limbed_body(), 2, 5);
  CHECK(body.sequence().frame_count() == 5);
  CHECK(body.vertex_count() == 162);
  CHECK_THROWS_AS(MatchingBody(body.sequence(), icosphere(1).vertices), Error);
}

}  // namespace matching_body_test
