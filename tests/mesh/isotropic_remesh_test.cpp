#include "catch.hpp"
#include "support/meshes.hpp"

#include <dsns/mesh/diagnosis.hpp>
#include <dsns/mesh/isotropic_remesh.hpp>
#include <dsns/mesh/sphere_mesh.hpp>
#include <dsns/surface/analytic.hpp>

namespace isotropic_remesh_test {

using namespace dsns;

namespace {

std::vector<double> edge_lengths(const TriangleMesh& mesh) {
  std::vector<double> out;
  for (const auto& [a, b] : detail::EditableMesh(mesh.faces, mesh.vertices.cols()).edges())
    out.push_back((mesh.vertices.col(a) - mesh.vertices.col(b)).norm());
  std::sort(out.begin(), out.end());
  return out;
}

double spread(const std::vector<double>& lengths) {
  const auto at = [&](double share) { return lengths[std::size_t(share * double(lengths.size() - 1))]; };
  return at(0.975) / at(0.025);
}

TriangleMesh limbs() {
  LimbedBody body;
  body.axes = {0.5, 0.4, 0.4};
  body.limbs = {{Vec3d(1, 0.3, 0.2).normalized(), 12, Vec3d(0.8, 0.2, 0.1)},
                {Vec3d(-1, 0.5, 0.4).normalized(), 12, Vec3d(-0.7, 0.3, 0.3)}};
  return mesh_of(at_time(body, 0.0), icosphere(4));
}

}  // namespace

TEST_CASE("a remeshed body is closed, of genus 0, with edges of one length, on the given surface", "[mesh]") {
  const bool of_limbs = GENERATE(true, false);
  const TriangleMesh mesh = of_limbs ? limbs() : mesh_of(Ellipsoid{1, 0.6, 0.3}, latitude_longitude_sphere(30, 60));
  const Index wanted = GENERATE(Index(0), Index(700));
  const Remeshing r = isotropic_remesh(mesh, {wanted, 6});
  const MeshDiagnosis d = diagnose(r.mesh.faces, r.mesh.vertices.cols());
  CHECK(d.closed);
  CHECK(d.components == 1);
  CHECK(d.euler_characteristic == 2);
  CHECK(d.nonmanifold_edges == 0);
  CHECK(d.nonmanifold_vertices == 0);
  CHECK(d.consistently_oriented);
  CHECK(volume(r.mesh) == Approx(volume(mesh)).epsilon(wanted > 0 ? 0.05 : 0.02));
  CHECK(area(r.mesh) == Approx(area(mesh)).epsilon(wanted > 0 ? 0.05 : 0.02));
  const double count = double(wanted > 0 ? wanted : mesh.vertices.cols());
  CHECK(double(r.mesh.vertices.cols()) == Approx(count).epsilon(0.1));

  const std::vector<double> before = edge_lengths(mesh), after = edge_lengths(r.mesh);
  INFO("2.5 to 97.5 % of the edges within a factor of " << spread(before) << " before, " << spread(after) << " after");
  CHECK(spread(after) < 1.8);
  CHECK(spread(after) < 0.7 * spread(before));

  // The vertices lie on the triangles, and the middles of the new ones are near them: by a search through all, not by walks.
  const SurfaceWalk walk(mesh);
  double mean = 0;
  for (const double length : after) mean += length / double(after.size());
  double square = 0, most = 0;
  int faces = 0;
  for (Index f = 0; f < r.mesh.faces.cols(); f += 7) {
    Vec3d middle = Vec3d::Zero();
    for (int k = 0; k < 3; ++k) middle += r.mesh.vertices.col(r.mesh.faces(k, f)) / 3;
    double least = 1e9, corner = 1e9;
    for (Index g = 0; g < mesh.faces.cols(); ++g) {
      const auto nearest = [&](const Vec3d& x) {
        const SurfacePoint p{g, detail::nearest_in_triangle<Vec3d>(x, mesh.vertices.col(mesh.faces(0, g)),
                                                                   mesh.vertices.col(mesh.faces(1, g)),
                                                                   mesh.vertices.col(mesh.faces(2, g)))};
        return (walk.position(p) - x).norm();
      };
      least = std::min(least, nearest(middle));
      corner = std::min(corner, nearest(r.mesh.vertices.col(r.mesh.faces(0, f))));
    }
    REQUIRE(corner < 1e-12);
    square += least * least;
    ++faces;
    most = std::max(most, least);
  }
  INFO("middles of triangles are up to " << most / mean << " edges off the surface");
  CHECK(std::sqrt(square / faces) < 0.08 * mean);
  CHECK(most < 0.7 * mean);
}

TEST_CASE("a motion carries over to the new triangles", "[mesh]") {
  const TriangleMesh mesh = mesh_of(Ellipsoid{1, 0.6, 0.3}, icosphere(3));
  MeshSequence sequence;
  sequence.faces = mesh.faces;
  Mat3 A;
  A << 2, 0.1, 0, 0, 1, 0.3, 0.2, 0, 1;
  sequence.frames = {mesh.vertices, A * mesh.vertices};
  const Remeshing r = isotropic_remesh(mesh);
  const MeshSequence other = remeshed(sequence, r);
  CHECK(other.frames[0] == r.mesh.vertices);
  CHECK((other.frames[1] - A * other.frames[0]).cwiseAbs().maxCoeff() < 1e-14);
}

TEST_CASE("remeshing what is no closed surface of genus 0 is refused", "[mesh]") {
  CHECK_THROWS_AS(isotropic_remesh(test::torus(20, 10)), UnusableMesh);
  TriangleMesh open = icosphere(1);
  open.faces.conservativeResize(3, open.faces.cols() - 1);
  CHECK_THROWS_AS(isotropic_remesh(open), UnusableMesh);
  CHECK_THROWS_AS(isotropic_remesh(icosphere(1), {5, 1}), InvalidArgument);
}

}  // namespace isotropic_remesh_test
