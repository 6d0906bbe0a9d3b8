#include <dsns/mesh/join_pieces.hpp>
#include <dsns/mesh/own_mesh.hpp>
#include <dsns/mesh/spherical_parameterization.hpp>

#include "catch.hpp"
#include "support/bodies.hpp"
#include "support/temporary_folder.hpp"

namespace join_pieces_test {

using namespace dsns;

namespace {

/// Balls of these radii in a row, two frames that move apart.
MeshSequence balls(const std::vector<double>& radii) {
  MeshSequence sequence;
  for (int k = 0; k < 2; ++k) {
    TriangleMesh all;
    double place = 0;
    for (const double r : radii) {
      TriangleMesh ball = test::stretched(icosphere(2), Vec3d::Constant(r));
      ball.vertices.row(0).array() += (place += r * (1.1 + k));
      place += r * (1.1 + k);
      all = all.faces.cols() == 0 ? ball : test::joined(all, ball);
    }
    sequence.frames.push_back(all.vertices);
    sequence.faces = all.faces;
  }
  sequence.name = "balls";
  return sequence;
}

}  // namespace

TEST_CASE("comparable pieces are joined to one sphere, small ones dropped", "[mesh]") {
  const MeshSequence raw = balls({1, 0.9, 0.8, 0.1});
  CHECK_THROWS_AS(repair(raw), UnusableMesh);
  const RepairResult joined = repair_joined(raw);
  const Index n = icosphere(2).vertices.cols();
  CHECK(joined.after.genus == 0);
  CHECK(joined.sequence.vertex_count() == 3 * n);
  CHECK(joined.sequence.cap_faces == 12);
  REQUIRE(joined.actions.size() == 2);
  CHECK(joined.actions[0] == "dropped 1 small loose piece");
  CHECK(joined.actions[1] == "joined 3 pieces by tubes");
  for (Index v = 0; v < joined.sequence.vertex_count(); ++v) {
    const Index source = joined.source_vertex[std::size_t(v)];
    CHECK(joined.repaired_vertex[std::size_t(source)] == v);
    for (std::size_t k = 0; k < 2; ++k) CHECK(joined.sequence.frames[k].col(v) == raw.frames[k].col(source));
  }
  CHECK(joined.repaired_vertex.back() == -1);
  const double together = 4 * pi / 3 * (1 + 0.729 + 0.512);
  CHECK(volume(joined.sequence.frame(0)) == Approx(together).epsilon(0.05));  // polyhedra, and the tubes add little
  CHECK(spherical_parameterization(joined.sequence).certificate.bijective());
  CHECK((OwnMesh(raw, joined).moved(joined.sequence.frames[1]).leftCols(3 * n) - raw.frames[1].leftCols(3 * n)).norm() <
        1e-12);
}

TEST_CASE("one piece is repaired as ever, and broken pieces are refused", "[mesh]") {
  const MeshSequence one = balls({1, 0.1});
  CHECK(repair_joined(one).sequence.faces == repair(one).sequence.faces);
  CHECK(repair_joined(one).actions == repair(one).actions);
  MeshSequence rings = balls({1});
  const TriangleMesh ring = test::torus(12, 8);
  const TriangleMesh both = test::joined({rings.frames[0], rings.faces}, ring);
  const MeshSequence wrong = test::still(both);
  const auto said = test::complaint<UnusableMesh>([&] { repair_joined(wrong); });
  CHECK(said.find("genus 1") != std::string::npos);
  RepairOptions options;
  options.piece = 2;
  CHECK_THROWS_AS(repair_joined(one, options), InvalidArgument);
}

}  // namespace join_pieces_test
