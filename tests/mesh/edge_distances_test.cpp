#include "catch.hpp"

#include <dsns/mesh/edge_distances.hpp>
#include <dsns/mesh/sphere_mesh.hpp>

namespace edge_distances_test {

using namespace dsns;

TEST_CASE("distances along edges and across them are near those of the sphere", "[mesh]") {
  const TriangleMesh sphere = icosphere(4);
  const EdgeDistances distances(sphere);
  double sum = 0, most = 0, least = 10;
  int pairs = 0;
  for (const Index source : {Index(0), Index(100), Index(1000)}) {
    const Eigen::VectorXd d = distances.from(source);
    for (Index v = 0; v < d.size(); ++v) {
      const double angle = std::acos(std::clamp(sphere.vertices.col(source).dot(sphere.vertices.col(v)), -1.0, 1.0));
      if (angle < 0.3) continue;
      const double ratio = d[v] / angle;
      sum += ratio;
      ++pairs;
      most = std::max(most, ratio);
      least = std::min(least, ratio);
    }
  }
  INFO("ratio to the great circles: " << least << ", in the mean " << sum / pairs << ", up to " << most);
  CHECK(least > 0.998);  // chords of the small triangles are that much shorter than arcs
  CHECK(sum / pairs < 1.02);
  CHECK(most < 1.05);
}

TEST_CASE("two triangles are laid flat before their corners are joined", "[mesh]") {
  // A tetrahedron's corners are all joined by edges; over the opposite edge it is farther.
  TriangleMesh mesh;
  mesh.vertices.resize(3, 4);
  mesh.vertices << 1, -1, -1, 1, 1, -1, 1, -1, 1, 1, -1, -1;
  mesh.faces.resize(3, 4);
  mesh.faces << 0, 0, 0, 1, 1, 2, 3, 3, 2, 3, 1, 2;
  const Eigen::VectorXd d = EdgeDistances(mesh).from(0);
  for (Index v = 1; v < 4; ++v) CHECK(d[v] == Approx((mesh.vertices.col(v) - mesh.vertices.col(0)).norm()));
  CHECK(d[0] == 0);
}

}  // namespace edge_distances_test
