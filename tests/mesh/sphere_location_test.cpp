#include <dsns/mesh/sphere_location.hpp>

#include <algorithm>

#include "catch.hpp"
#include "support/bodies.hpp"

namespace sphere_location_test {

using namespace dsns;

namespace {

/// Triangulations with very uneven triangles too: vertices drawn together towards one pole by a Moebius map.
std::vector<TriangleMesh> spheres() {
  std::vector<TriangleMesh> all{test::tetrahedron(), test::octahedron(), icosphere(3), latitude_longitude_sphere(9, 40),
                                test::relabelled(icosphere(4), 5)};
  TriangleMesh& uneven = all.emplace_back(icosphere(4));
  for (Index v = 0; v < uneven.vertices.cols(); ++v) {
    const Vec3d s = uneven.vertices.col(v);
    const double z = (s.z() + 0.98) / (1 + 0.98 * s.z()), factor = std::sqrt(1 - 0.98 * 0.98) / (1 + 0.98 * s.z());
    uneven.vertices.col(v) = Vec3d(factor * s.x(), factor * s.y(), z).normalized();
  }
  for (TriangleMesh& mesh : all) mesh.vertices.colwise().normalize();
  return all;
}

/// Barycentrics of s in a face by a linear solve.
Vec3d solved(const TriangleMesh& sphere, Index face, const Vec3d& s) {
  Mat3 p;
  for (int k = 0; k < 3; ++k) p.col(k) = sphere.vertices.col(sphere.faces(k, face));
  const Vec3d b = p.inverse() * s;
  return b / b.sum();
}

bool pierces(const TriangleMesh& sphere, Index face, const Vec3d& s, double tolerance) {
  Mat3 p;
  for (int k = 0; k < 3; ++k) p.col(k) = sphere.vertices.col(sphere.faces(k, face));
  return (p.inverse() * s).minCoeff() >= -tolerance;
}

void check_hit(const TriangleMesh& sphere, const SphereHit& hit, const Vec3d& s) {
  REQUIRE(hit.face >= 0);
  REQUIRE(hit.face < sphere.faces.cols());
  CHECK(hit.barycentric.minCoeff() >= 0);
  CHECK(std::abs(hit.barycentric.sum() - 1) < 1e-15);
  Vec3d sum = Vec3d::Zero();
  for (int k = 0; k < 3; ++k) sum += hit.barycentric[k] * sphere.vertices.col(sphere.faces(k, hit.face));
  CHECK((sum.normalized() - s).norm() < 1e-15);
}

}  // namespace

TEST_CASE("location finds the face that a search through all faces finds", "[sphere_location]") {
  for (const TriangleMesh& sphere : spheres()) {
    const SphereLocation location(sphere.vertices, sphere.faces);
    const Mat3X s = test::random_unit_vectors(60, 3);
    for (Index i = 0; i < s.cols(); ++i) {
      const SphereHit hit = location(Vec3d(s.col(i)));
      check_hit(sphere, hit, s.col(i));
      int strictly_inside = 0;
      for (Index f = 0; f < sphere.faces.cols(); ++f) {
        if (!pierces(sphere, f, s.col(i), -1e-9)) continue;
        ++strictly_inside;
        CHECK(f == hit.face);
        CHECK((solved(sphere, f, s.col(i)) - hit.barycentric).norm() < 1e-12);
      }
      CHECK(strictly_inside == 1);
    }
  }
}

TEST_CASE("location is exact at vertices, and on edges gives a face of the edge", "[sphere_location]") {
  for (const TriangleMesh& sphere : spheres()) {
    const SphereLocation location(sphere.vertices, sphere.faces);
    for (Index f = 0; f < sphere.faces.cols(); f += 1 + sphere.faces.cols() / 300) {
      for (int k = 0; k < 3; ++k) {
        const int a = sphere.faces(k, f), b = sphere.faces((k + 1) % 3, f);
        const SphereHit at = location(Vec3d(sphere.vertices.col(a)));
        int corner = 0;
        CHECK(std::abs(at.barycentric.maxCoeff(&corner) - 1) < 1e-14);
        CHECK(sphere.faces(corner, at.face) == a);

        const Vec3d s = (0.3 * sphere.vertices.col(a) + 0.7 * sphere.vertices.col(b)).normalized();
        const SphereHit on = location(s);
        check_hit(sphere, on, s);
        int opposite = 0;
        CHECK(on.barycentric.minCoeff(&opposite) < 1e-13);
        CHECK((sphere.faces.col(on.face).array() == a).any());
        CHECK((sphere.faces.col(on.face).array() == b).any());
        CHECK(sphere.faces(opposite, on.face) != a);
        CHECK(sphere.faces(opposite, on.face) != b);
      }
    }
  }
}

TEST_CASE("every unit vector has a face: poles, axes, near poles, lengths rounded", "[sphere_location]") {
  for (const TriangleMesh& sphere : spheres()) {
    const SphereLocation location(sphere.vertices, sphere.faces);
    for (const double tilt : {0.0, 1e-300, 1e-16, 1e-9, 1e-4})
      for (int axis = 0; axis < 3; ++axis)
        for (const double sign : {-1.0, 1.0}) {
          Vec3d s = sign * Vec3d::Unit(axis);
          s[(axis + 1) % 3] = tilt;
          const SphereHit hit = location(s.normalized());
          CHECK(pierces(sphere, hit.face, s, 1e-14));
          CHECK(location(s.normalized() * (1 - 5e-10)).barycentric.isApprox(hit.barycentric, 1e-9));
        }
  }
}

TEST_CASE("location of many points gives the hits of each", "[sphere_location]") {
  const TriangleMesh sphere = icosphere(2);
  const SphereLocation location(sphere.vertices, sphere.faces);
  const Mat3X s = test::random_unit_vectors(50, 9);
  const std::vector<SphereHit> hits = location.hits(s);
  REQUIRE(hits.size() == 50);
  for (Index i = 0; i < s.cols(); ++i) {
    CHECK(hits[std::size_t(i)].face == location(Vec3d(s.col(i))).face);
    CHECK(hits[std::size_t(i)].barycentric == location(Vec3d(s.col(i))).barycentric);
  }
}

TEST_CASE("location refuses maps that fold and queries that are not unit vectors", "[sphere_location]") {
  TriangleMesh sphere = icosphere(2);
  const SphereLocation location(sphere.vertices, sphere.faces);
  CHECK_THROWS_AS(location(Vec3d(0, 0, 1.1)), InvalidArgument);
  CHECK_THROWS_AS(location(Vec3d(0, 0, 0)), InvalidArgument);
  CHECK_THROWS_AS(location(Vec3d(0, std::nan(""), 1)), InvalidArgument);
  sphere.vertices.col(0) = -sphere.vertices.col(0);
  CHECK_THROWS_AS(SphereLocation(sphere.vertices, sphere.faces), UnusableMesh);
  CHECK_THROWS_AS(SphereLocation(2 * icosphere(2).vertices, sphere.faces), InvalidArgument);
  const TriangleMesh torus = test::torus(6, 5);
  CHECK_THROWS_AS(SphereLocation(torus.vertices.colwise().normalized(), torus.faces), UnusableMesh);
}

}  // namespace sphere_location_test
