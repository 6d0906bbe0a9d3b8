#include "catch.hpp"
#include "support/bodies.hpp"

#include <dsns/matching/intrinsic_laplacian.hpp>
#include <dsns/sphere/rotations.hpp>

namespace intrinsic_laplacian_test {

using namespace dsns;

namespace {

IntrinsicTriangulation intrinsic(const TriangleMesh& mesh) {
  const MatchingBody body(test::still(mesh), mesh.vertices.colwise().normalized());
  return {body.faces(), body.edge_lengths() * std::sqrt(area(mesh))};
}

}  // namespace

TEST_CASE("Dirichlet energies from lengths are those of gradients in space", "[matching]") {
  const TriangleMesh mesh = test::stretched(icosphere(2), Vec3d(1, 0.4, 2));
  const IntrinsicLaplacian laplacian = intrinsic_laplacian(intrinsic(mesh), mesh.vertices.cols());
  test::Uniform uniform(4);
  Eigen::VectorXd u(mesh.vertices.cols());
  for (double& value : u) value = uniform(-1, 1);
  double energy = 0;
  for (Index f = 0; f < mesh.faces.cols(); ++f) {
    const Vec3d a = mesh.vertices.col(mesh.faces(0, f)), b = mesh.vertices.col(mesh.faces(1, f)),
                c = mesh.vertices.col(mesh.faces(2, f));
    Mat3 system;  // gradient . edges = differences, gradient . normal = 0
    system << (b - a).transpose(), (c - a).transpose(), (b - a).cross(c - a).transpose();
    const Vec3d gradient = system.inverse() * Vec3d(u[mesh.faces(1, f)] - u[mesh.faces(0, f)],
                                                    u[mesh.faces(2, f)] - u[mesh.faces(0, f)], 0);
    energy += gradient.squaredNorm() * (b - a).cross(c - a).norm() / 2;
  }
  CHECK(u.dot(laplacian.stiffness * u) == Approx(energy).epsilon(1e-12));
  CHECK((laplacian.stiffness * Eigen::VectorXd::Ones(u.size())).norm() < 1e-10);
  CHECK((laplacian.masses - vertex_areas(mesh.vertices, mesh.faces)).norm() < 1e-12);
}

TEST_CASE("a body's Laplacian has no negative weight and does not see turns and scale", "[matching]") {
  const TriangleMesh mesh = test::stretched(latitude_longitude_sphere(12, 6), Vec3d(1, 0.2, 3));
  const Mat3X sphere = latitude_longitude_sphere(12, 6).vertices;
  MeshSequence moved = test::still(mesh);
  moved.frames[0] = (5 * rotation_exp(Vec3d(1, 2, 3)) * mesh.vertices).colwise() + Vec3d(7, 8, 9);
  const IntrinsicLaplacian a = intrinsic_laplacian(MatchingBody(test::still(mesh), sphere)),
                           b = intrinsic_laplacian(MatchingBody(moved, sphere));
  for (int k = 0; k < a.stiffness.outerSize(); ++k)
    for (Eigen::SparseMatrix<double>::InnerIterator it(a.stiffness, k); it; ++it)
      CHECK((it.row() == it.col() || it.value() < 1e-9));
  CHECK((Eigen::MatrixXd(a.stiffness) - Eigen::MatrixXd(b.stiffness)).norm() < 1e-9);
  CHECK(a.masses.sum() == Approx(1).epsilon(1e-12));
  CHECK((a.masses - b.masses).norm() < 1e-12);
}

}  // namespace intrinsic_laplacian_test
