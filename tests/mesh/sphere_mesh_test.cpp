#include <dsns/mesh/sphere_mesh.hpp>

#include <cmath>
#include <map>
#include <utility>

#include "catch.hpp"

namespace sphere_mesh_test {

using namespace dsns;

namespace {

/// Whether every directed edge has exactly one opposite: closed, manifold at edges and consistently oriented.
bool closed_and_oriented(const Faces& faces) {
  std::map<std::pair<int, int>, int> edges;
  for (Index f = 0; f < faces.cols(); ++f)
    for (int k = 0; k < 3; ++k) ++edges[{faces(k, f), faces((k + 1) % 3, f)}];
  for (const auto& [edge, count] : edges)
    if (count != 1 || edges.count({edge.second, edge.first}) == 0) return false;
  return true;
}

void check_sphere(const TriangleMesh& sphere) {
  for (Index v = 0; v < sphere.vertices.cols(); ++v) REQUIRE(std::abs(sphere.vertices.col(v).norm() - 1) < 1e-15);
  CHECK(closed_and_oriented(sphere.faces));
  CHECK(sphere.vertices.cols() * 2 - 4 == sphere.faces.cols());  // Euler: one component without handles
  const Mat3X normals = face_normals(sphere.vertices, sphere.faces);
  for (Index f = 0; f < sphere.faces.cols(); ++f)
    REQUIRE(normals.col(f).dot(sphere.vertices.col(sphere.faces(0, f))) > 0);
}

}  // namespace

TEST_CASE("an icosphere has 10 * 4^level + 2 unit vertices and outward faces", "[sphere_mesh]") {
  const int level = GENERATE(0, 1, 2, 4);
  const TriangleMesh sphere = icosphere(level);
  CHECK(sphere.vertices.cols() == 10 * (Index(1) << (2 * level)) + 2);
  check_sphere(sphere);
}

TEST_CASE("the icosahedron's area and volume are the closed forms", "[sphere_mesh]") {
  // Edge a: a sin(2 pi / 5) = 1; area 5 sqrt(3) a^2; volume 5/12 (3 + sqrt 5) a^3.
  const double edge = 1 / std::sin(2 * pi / 5);
  CHECK(area(icosphere(0)) == Approx(5 * std::sqrt(3.0) * edge * edge).epsilon(1e-14));
  CHECK(volume(icosphere(0)) == Approx(5.0 / 12 * (3 + std::sqrt(5.0)) * edge * edge * edge).epsilon(1e-14));
}

TEST_CASE("an icosphere's area error falls fourfold a level", "[sphere_mesh]") {
  const auto error = [](int level) { return 4 * pi - area(icosphere(level)); };
  CHECK(error(4) > 0);
  CHECK(error(3) / error(4) == Approx(4).epsilon(0.01));
}

TEST_CASE("a latitude-longitude sphere has both poles and outward faces", "[sphere_mesh]") {
  const int rings = GENERATE(1, 2, 9);
  const int sectors = GENERATE(3, 16);
  const TriangleMesh sphere = latitude_longitude_sphere(rings, sectors);
  CHECK(sphere.vertices.cols() == 2 + rings * sectors);
  CHECK(sphere.vertices.col(0) == Vec3d::UnitZ());
  CHECK(sphere.vertices.col(sphere.vertices.cols() - 1) == -Vec3d::UnitZ());
  check_sphere(sphere);
}

TEST_CASE("the octahedron is the coarsest latitude-longitude sphere of four sectors", "[sphere_mesh]") {
  const TriangleMesh sphere = latitude_longitude_sphere(1, 4);
  CHECK(area(sphere) == Approx(4 * std::sqrt(3.0)).epsilon(1e-14));
  CHECK(volume(sphere) == Approx(4.0 / 3).epsilon(1e-14));
}

TEST_CASE("impossible spheres are refused", "[sphere_mesh]") {
  CHECK_THROWS_AS(icosphere(-1), InvalidArgument);
  CHECK_THROWS_AS(icosphere(9), InvalidArgument);
  CHECK_THROWS_AS(latitude_longitude_sphere(0, 4), InvalidArgument);
  CHECK_THROWS_AS(latitude_longitude_sphere(4, 2), InvalidArgument);
}

TEST_CASE("meshes of a surface and of a moving surface sample the functor", "[sphere_mesh]") {
  const TriangleMesh sphere = icosphere(2);
  const Vec3d axes(1, 2, 3);
  const auto ellipsoid = [&](const Vec3d& s) { return Vec3d(axes.cwiseProduct(s)); };
  const TriangleMesh mesh = mesh_of(ellipsoid, sphere);
  CHECK(mesh.faces == sphere.faces);
  CHECK(volume(mesh) == Approx(6 * volume(sphere)).epsilon(1e-13));

  const auto growing = [&](const Vec3d& s, double t) { return Vec3d((1 + t) * s); };
  const MeshSequence sequence = sequence_of(growing, sphere, 5);
  REQUIRE(sequence.frame_count() == 5);
  for (int k = 0; k < 5; ++k)
    CHECK(volume(sequence.frame(k)) == Approx(std::pow(1 + k / 4.0, 3) * volume(sphere)).epsilon(1e-13));
  CHECK_THROWS_AS(sequence_of(growing, sphere, 1), InvalidArgument);
}

}  // namespace sphere_mesh_test
