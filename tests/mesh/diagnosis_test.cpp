#include "catch.hpp"
#include "support/meshes.hpp"

#include <dsns/mesh/diagnosis.hpp>
#include <dsns/mesh/sphere_mesh.hpp>

namespace diagnosis_test {

using namespace dsns;

TEST_CASE("a sphere is closed and has genus 0", "[mesh]") {
  const auto found = diagnose(icosphere(2).faces, 162);
  CHECK(found.vertices == 162);
  CHECK(found.edges == 480);
  CHECK(found.faces == 320);
  CHECK(found.components == 1);
  CHECK(found.boundary_loops == 0);
  CHECK(found.nonmanifold_edges == 0);
  CHECK(found.nonmanifold_vertices == 0);
  CHECK(found.euler_characteristic == 2);
  CHECK(found.closed);
  CHECK(found.consistently_oriented);
  CHECK(found.genus == 0);
}

TEST_CASE("a torus has genus 1, a cylinder two holes, a Moebius strip one", "[mesh]") {
  const auto torus = diagnose(test::torus(7, 5).faces, 35);
  CHECK(torus.closed);
  CHECK(torus.euler_characteristic == 0);
  CHECK(torus.genus == 1);

  const auto cylinder = diagnose(test::cylinder(9), 18);
  CHECK(cylinder.boundary_loops == 2);
  CHECK(cylinder.boundary_edges == 18);
  CHECK(cylinder.euler_characteristic == 0);
  CHECK(cylinder.consistently_oriented);
  CHECK_FALSE(cylinder.closed);
  CHECK_FALSE(cylinder.genus.has_value());

  const auto moebius = diagnose(test::moebius_strip(9), 18);
  CHECK(moebius.boundary_loops == 1);
  CHECK(moebius.boundary_edges == 18);
  CHECK(moebius.euler_characteristic == 0);
  CHECK_FALSE(moebius.consistently_oriented);
}

TEST_CASE("two spheres are two components and have no genus", "[mesh]") {
  const auto one = icosphere(0);
  const auto found = diagnose(test::joined(one, one).faces, 24);
  CHECK(found.components == 2);
  CHECK(found.euler_characteristic == 4);
  CHECK(found.closed);
  CHECK_FALSE(found.genus.has_value());
}

TEST_CASE("unused vertices do not count", "[mesh]") { CHECK(diagnose(icosphere(0).faces, 100).vertices == 12); }

TEST_CASE("triangles that touch in a vertex only", "[mesh]") {
  Faces bow(3, 2);
  bow << 0, 0, 1, 3, 2, 4;
  const auto found = diagnose(bow, 5);
  CHECK(found.components == 2);
  CHECK(found.boundary_loops == 2);
  CHECK(found.nonmanifold_vertices == 1);
  CHECK(found.nonmanifold_edges == 0);
}

TEST_CASE("three faces at an edge", "[mesh]") {
  Faces book(3, 3);
  book << 0, 1, 0, 1, 0, 1, 2, 3, 4;
  const auto found = diagnose(book, 5);
  CHECK(found.nonmanifold_edges == 1);
  CHECK(found.edges == 7);
  CHECK(found.components == 1);
  CHECK_FALSE(found.closed);
}

TEST_CASE("an edge that two faces run through in the same direction", "[mesh]") {
  auto faces = icosphere(1).faces;
  std::swap(faces(0, 7), faces(1, 7));
  const auto found = diagnose(faces, 42);
  CHECK(found.closed);
  CHECK_FALSE(found.consistently_oriented);
  CHECK_FALSE(found.genus.has_value());
}

TEST_CASE("faces may not name vertices that are not there", "[mesh]") {
  CHECK_THROWS_AS(diagnose(icosphere(0).faces, 11), InvalidArgument);
  Faces negative(3, 1);
  negative << 0, 1, -1;
  CHECK_THROWS_AS(diagnose(negative, 3), InvalidArgument);
  CHECK(diagnose(Faces(3, 0), 0).closed == false);
}

}  // namespace diagnosis_test
