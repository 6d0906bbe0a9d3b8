#include "catch.hpp"
#include "support/meshes.hpp"
#include "support/temporary_folder.hpp"

#include <dsns/mesh/repair.hpp>
#include <dsns/mesh/sphere_mesh.hpp>

#include <limits>

namespace repair_test {

using namespace dsns;

namespace {

/// Every triangle with three vertices of its own, as files with flat shading hold them.
TriangleMesh soup(const TriangleMesh& mesh) {
  TriangleMesh result{mesh.vertices(Eigen::all, mesh.faces.reshaped()), Faces(3, mesh.faces.cols())};
  for (Index c = 0; c < 3 * mesh.faces.cols(); ++c) result.faces(c % 3, c / 3) = int(c);
  return result;
}

std::string refusal(const MeshSequence& sequence) {
  const auto said = test::complaint<UnusableMesh>([&] { repair(sequence); });
  CHECK(said.find(sequence.name) != std::string::npos);
  CHECK(test::is_one_sentence(said));
  return said;
}

bool contains(const std::string& whole, const std::string& part) { return whole.find(part) != std::string::npos; }

TriangleMesh scaled(TriangleMesh mesh, double factor) {
  mesh.vertices *= factor;
  return mesh;
}

TriangleMesh without_faces(const TriangleMesh& mesh, const std::vector<Index>& dropped) {
  std::vector<Index> kept;
  for (Index f = 0; f < mesh.faces.cols(); ++f)
    if (std::find(dropped.begin(), dropped.end(), f) == dropped.end()) kept.push_back(f);
  return {mesh.vertices, mesh.faces(Eigen::all, kept)};
}

}  // namespace

TEST_CASE("a clean mesh stays as it is", "[mesh]") {
  const auto clean = test::growing(icosphere(2));
  const auto result = repair(clean);
  CHECK(result.actions.empty());
  CHECK(result.sequence.faces == clean.faces);
  CHECK(result.sequence.frames == clean.frames);
  CHECK(result.sequence.cap_faces == 0);
  CHECK(result.after.genus == 0);
}

TEST_CASE("seams are welded whatever the size of the mesh", "[mesh]") {
  const double size = GENERATE(1e-6, 1.0, 1e6);
  auto seamed = test::growing(soup(icosphere(2)));
  for (Mat3X& frame : seamed.frames) frame = size * (frame + 1e-8 * Mat3X::Random(3, frame.cols()));
  const auto result = repair(seamed);
  CHECK(result.before.components == 320);
  CHECK(result.welded.components == 1);
  CHECK(result.after.vertices == 162);
  CHECK(result.after.faces == 320);
  REQUIRE(result.actions.size() == 1);
  CHECK(result.actions[0] == "welded 960 vertices to 162");
  for (std::size_t k = 0; k < 3; ++k)
    CHECK(result.sequence.frames[k] == seamed.frames[k](Eigen::all, result.source_vertex));
  CHECK(volume(result.sequence.frame(0)) > 0);
}

TEST_CASE("lips that touch in some frames only stay apart", "[mesh]") {
  auto mouth = test::growing(icosphere(2), 4);
  const std::size_t touching = GENERATE(0u, 3u);
  mouth.frames[touching].col(5) = mouth.frames[touching].col(9);
  CHECK(repair(mouth).actions.empty());
  for (Mat3X& frame : mouth.frames) frame.col(5) = frame.col(9);  // now they are one point, which is parted again
  const auto sealed = repair(mouth);
  CHECK(sealed.welded.vertices == 161);
  CHECK(sealed.welded.nonmanifold_vertices == 1);
  CHECK(sealed.after.vertices == 162);
}

TEST_CASE("vertices just outside the tolerance are not welded", "[mesh]") {
  auto seamed = test::growing(soup(icosphere(1)));
  const double reach = 1e-6 * detail::diagonal(seamed.frames.back());  // of the largest frame
  for (Mat3X& frame : seamed.frames) frame.row(0).leftCols(3).array() += 1.5 * reach;
  CHECK(repair(seamed).welded.components == 2);
  CHECK(repair(seamed, {2e-6, 4, 0.2}).welded.components == 1);
}

TEST_CASE("degenerate and duplicate faces are dropped", "[mesh]") {
  auto mesh = icosphere(1);
  mesh.faces.conservativeResize(3, 83);
  mesh.faces.col(80) = mesh.faces.col(3);
  mesh.faces.col(81) << mesh.faces(1, 4), mesh.faces(0, 4), mesh.faces(2, 4);
  mesh.faces.col(82) << 7, 7, 8;
  const auto result = repair(test::growing(mesh));
  CHECK(result.sequence.faces == icosphere(1).faces);
  REQUIRE(result.actions.size() == 1);
  CHECK(result.actions[0] == "dropped 3 degenerate or duplicate faces");
}

TEST_CASE("small pieces are dropped, comparable ones refused", "[mesh]") {
  const auto sphere = icosphere(2);
  const auto eye = repair(test::growing(test::joined(scaled(sphere, 0.4), sphere)));  // area ratio 0.16
  CHECK(eye.after.vertices == 162);
  CHECK(eye.source_vertex.front() == 162);
  CHECK(eye.welded.components == 2);
  REQUIRE(eye.actions.size() == 1);
  CHECK(eye.actions[0] == "dropped 1 loose piece with 13.8 % of the area");  // 0.16 / 1.16

  const auto twins = test::growing(test::joined(scaled(sphere, 0.5), sphere));  // area ratio 0.25
  CHECK(contains(refusal(twins), "2 loose pieces, the two largest with 80 % and 20 % of the area"));
  CHECK(repair(twins, {1e-6, 4, 0.3}).after.vertices == 162);
  RepairOptions choice;
  choice.piece = 1;
  CHECK(repair(twins, choice).source_vertex.front() == 162);
  choice.piece = 2;
  CHECK(repair(twins, choice).source_vertex.front() == 0);
  CHECK(repair(twins, choice).actions.front() == "dropped 1 loose piece with 80 % of the area");
  choice.piece = 3;
  CHECK(contains(test::complaint<UnusableMesh>([&] { repair(twins, choice); }), "no piece 3, only 2 of them"));
  choice.piece = -1;
  CHECK_THROWS_AS(repair(twins, choice), InvalidArgument);
}

TEST_CASE("pieces are compared by their area over all frames", "[mesh]") {
  auto swap = test::growing(test::joined(icosphere(1), icosphere(1)), 2, 0);
  swap.frames[0].leftCols(42) *= 0.1;
  swap.frames[1].leftCols(42) *= 10;
  CHECK(repair(swap).source_vertex.front() == 0);
}

TEST_CASE("faces are turned to agree and outwards", "[mesh]") {
  const auto sphere = icosphere(2);
  auto mixed = test::growing(sphere);
  for (Index f = 0; f < 320; f += 3) std::swap(mixed.faces(0, f), mixed.faces(2, f));
  const auto result = repair(mixed);
  CHECK(result.after.consistently_oriented);
  CHECK(volume(result.sequence.frame(2)) == Approx(8 * volume(sphere)));

  auto inside_out = test::growing(sphere);
  inside_out.faces.row(0).swap(inside_out.faces.row(1));
  const auto turned = repair(inside_out);
  REQUIRE(turned.actions.size() == 1);
  CHECK(turned.actions[0] == "turned the surface outside in");
  CHECK(volume(turned.sequence.frame(0)) == Approx(volume(sphere)));
}

TEST_CASE("a hole is closed by a fan around the centroid of its rim", "[mesh]") {
  const auto sphere = latitude_longitude_sphere(9, 12);  // the north pole's faces come first of each pair
  std::vector<Index> polar;
  for (Index f = 0; f < sphere.faces.cols(); ++f)
    if ((sphere.faces.col(f).array() == 0).any()) polar.push_back(f);
  REQUIRE(polar.size() == 12);
  const auto open = test::growing(without_faces(sphere, polar));
  const auto result = repair(open);
  CHECK(result.after.genus == 0);
  CHECK(result.sequence.cap_faces == 12);
  CHECK(result.sequence.faces.leftCols(open.faces.cols()) == (open.faces.array() - 1).matrix());  // vertex 0 is gone
  CHECK(result.source_vertex.back() == -1);
  CHECK(result.actions == std::vector<std::string>{"closed 1 hole with 12 rim edges"});
  for (int k = 0; k < 3; ++k) {
    const double size = 1 + 0.5 * k;
    const auto frame = result.sequence.frame(k);
    const Vec3d centre = frame.vertices.col(frame.vertices.cols() - 1);
    CHECK((centre - Vec3d(0, 0, size * std::cos(pi / 10))).norm() < 1e-12 * size);
    const double rim = size * std::sin(pi / 10), cap = 12 * 0.5 * rim * rim * std::sin(2 * pi / 12);
    const Faces caps = frame.faces.rightCols(12);
    CHECK(area({frame.vertices, caps}) == Approx(cap));
    CHECK(face_normals(frame.vertices, caps).row(2).minCoeff() > 0);
  }
}

TEST_CASE("a missing triangle is put back", "[mesh]") {
  const auto result = repair(test::growing(without_faces(icosphere(2), {17, 200})));
  CHECK(result.after.vertices == 162);
  CHECK(result.after.faces == 320);
  CHECK(result.sequence.cap_faces == 2);
  CHECK(volume(result.sequence.frame(0)) == Approx(volume(icosphere(2))));
}

TEST_CASE("repairing twice changes nothing and keeps the caps marked", "[mesh]") {
  const auto once = repair(test::growing(soup(without_faces(icosphere(2), {0, 1, 2, 3}))));
  REQUIRE(once.sequence.cap_faces > 3);
  const auto twice = repair(once.sequence);
  CHECK(twice.actions.empty());
  CHECK(twice.sequence.faces == once.sequence.faces);
  CHECK(twice.sequence.cap_faces == once.sequence.cap_faces);
}

TEST_CASE("a surface pinched at a vertex is parted there", "[mesh]") {
  auto pinched = test::growing(icosphere(2));
  const int a = 0, b = pinched.faces.maxCoeff();
  pinched.faces = pinched.faces.unaryExpr([&](int v) { return v == b ? a : v; }).eval();
  REQUIRE(diagnose(pinched.faces, 162).nonmanifold_vertices == 1);
  const auto result = repair(pinched);
  CHECK(result.after.vertices == 162);
  CHECK(result.after.genus == 0);
  CHECK(std::count(result.source_vertex.begin(), result.source_vertex.end(), a) == 2);
}

TEST_CASE("surfaces that no sphere can be mapped to are refused", "[mesh]") {
  CHECK(contains(refusal(test::growing(test::torus(12, 8))), "genus 1"));

  auto tube = test::torus(12, 8);  // two tori, a face of each cut out, share the rim: genus 2
  const auto other = test::joined(without_faces(tube, {0}), without_faces(tube, {0}));
  auto pretzel = test::growing(other);
  const auto rim = tube.faces.col(0);
  for (int k = 0; k < 3; ++k)
    pretzel.faces = pretzel.faces.unaryExpr([&](int v) { return v == 96 + rim[k] ? int(rim[k]) : v; }).eval();
  pretzel.frames.assign(2, pretzel.frames[0]);
  for (Mat3X& frame : pretzel.frames) frame.rightCols(96) = (0.3 * frame.rightCols(96)).colwise() + Vec3d(9, 0, 0);
  CHECK(contains(refusal(pretzel), "genus 2"));

  MeshSequence moebius;
  moebius.name = "moebius";
  moebius.faces = test::moebius_strip(9);
  moebius.frames.assign(2, Mat3X::Random(3, 18));
  CHECK(contains(refusal(moebius), "one-sided"));

  auto winged = icosphere(1);
  winged.faces.conservativeResize(3, 81);
  winged.faces.col(80) << winged.faces(0, 0), winged.faces(1, 0), 41;
  CHECK(contains(refusal(test::growing(winged)), "three faces or more meet at 1 edge"));
}

TEST_CASE("what is no mesh at all", "[mesh]") {
  auto mesh = test::growing(icosphere(1));
  auto broken = mesh;
  broken.frames[1](2, 3) = std::numeric_limits<double>::quiet_NaN();
  CHECK(contains(refusal(broken), "finite"));
  broken = mesh;
  for (Mat3X& frame : broken.frames) frame.setZero();
  CHECK(contains(refusal(broken), "one point"));
  broken = mesh;
  broken.frames[1].conservativeResize(3, 40);
  CHECK_THROWS_AS(repair(broken), InvalidArgument);
  broken = mesh;
  broken.faces(0, 0) = 42;
  CHECK_THROWS_AS(repair(broken), InvalidArgument);
  CHECK_THROWS_AS(repair(MeshSequence{}), InvalidArgument);
}

TEST_CASE("handles are counted and refused, a slab without a hole is not", "[mesh]") {
  const auto sequence = [](int holes) {
    MeshSequence still;
    const TriangleMesh slab = test::slab_with_holes(holes);
    still.frames = {slab.vertices};
    still.faces = slab.faces;
    still.name = "slab";
    return still;
  };
  CHECK(repair(sequence(0)).after.genus == 0);
  for (int genus = 1; genus <= 4; ++genus) {
    CHECK(diagnose_welded(sequence(genus)).genus == genus);
    const auto said = test::complaint<UnusableMesh>([&] { repair(sequence(genus)); });
    CHECK(said.find("genus " + std::to_string(genus)) != std::string::npos);
    CHECK(test::is_one_sentence(said));
  }
}

}  // namespace repair_test
