#include <dsns/mesh/collapse_hierarchy.hpp>

#include "catch.hpp"
#include "support/bodies.hpp"

namespace collapse_hierarchy_test {

using namespace dsns;

TEST_CASE("a mesh survives its collapse to a tetrahedron and back", "[collapse]") {
  const TriangleMesh body = test::limbed_body(3, 6, 2);
  detail::ConcatenatedFrames frames{body.vertices};
  const Eigen::VectorXd masses = Eigen::VectorXd::Constant(body.faces.cols(), 1.0 / double(body.faces.cols()));
  detail::CollapsibleMesh mesh(body.faces, body.vertices.cols(), masses);
  const auto steps = detail::CollapsePlan(mesh, frames).run();
  CHECK(Index(steps.size()) == body.vertices.cols() - 4);
  double mass = 0;
  int left = 0;
  for (int f = 0; f < mesh.face_slots(); ++f)
    if (mesh.has_face(f)) mass += mesh.mass(f), ++left;
  CHECK(left == 4);
  CHECK(mass == Approx(1));
  for (auto step = steps.rbegin(); step != steps.rend(); ++step) mesh.undo(*step);
  for (int f = 0; f < mesh.face_slots(); ++f) {
    CHECK(mesh.has_face(f));
    for (int k = 0; k < 3; ++k) CHECK(mesh.vertex(f, k) == body.faces(k, f));
    CHECK(mesh.mass(f) == masses[f]);
  }
}

}  // namespace collapse_hierarchy_test
