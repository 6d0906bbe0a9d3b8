#include "catch.hpp"
#include "support/bodies.hpp"

#include <dsns/matching/descriptors.hpp>

namespace descriptors_test {

using namespace dsns;

namespace {

IntrinsicSpectrum made_spectrum() {
  test::Uniform uniform(8);
  IntrinsicSpectrum s{Eigen::VectorXd(6), Eigen::MatrixXd(10, 6)};
  s.eigenvalues << 2, 3, 5, 8, 11, 20;
  for (double& value : s.eigenfunctions.reshaped()) value = uniform(-2, 2);
  return s;
}

}  // namespace

TEST_CASE("kernel signatures against their sums", "[matching]") {
  const IntrinsicSpectrum s = made_spectrum();
  const Eigen::MatrixXd d = kernel_signatures(s, {.waves = 5, .heats = 4, .eigenpairs = 5});
  REQUIRE(d.cols() == 9);
  // The third wave: energies from log 2 to 0.98 of the way to log 11, spread 2.5 steps.
  const double step = 0.98 * std::log(11.0 / 2) / 4, energy = std::log(2.0) + 2 * step;
  double sum = 0, total = 0;
  for (const auto& [k, lambda] : {std::pair{0, 2.0}, {1, 3.0}, {2, 5.0}, {3, 8.0}, {4, 11.0}}) {
    const double z = (std::log(lambda) - energy) / (2.5 * step), weight = std::exp(-z * z / 2);
    sum += weight * std::pow(s.eigenfunctions(7, k), 2);
    total += weight;
  }
  CHECK(d(7, 2) == Approx(sum / total).epsilon(1e-12));
  // The last heat, at 1.5 / lambda_1.
  double heat = 0, floor = 0;
  for (const auto& [k, lambda] : {std::pair{0, 2.0}, {1, 3.0}, {2, 5.0}, {3, 8.0}, {4, 11.0}}) {
    heat += std::exp(-0.75 * lambda) * std::pow(s.eigenfunctions(7, k), 2);
    floor += 0.05 * std::exp(-0.75 * lambda);
  }
  CHECK(d(7, 8) == Approx(std::log(heat + floor)).epsilon(1e-12));
}

TEST_CASE("kernel signatures do not see size, signs or pose", "[matching]") {
  const IntrinsicSpectrum s = made_spectrum();
  IntrinsicSpectrum other = s;
  other.eigenvalues *= 7;
  other.eigenfunctions.col(2) *= -1;
  CHECK((kernel_signatures(s) - kernel_signatures(other)).cwiseAbs().maxCoeff() < 1e-9);
}

TEST_CASE("brackets of linear functions are normals against the crossed gradients", "[matching]") {
  const TriangleMesh mesh = test::stretched(icosphere(2), Vec3d(1, 0.5, 1.7));
  const Vec3d p(0.3, -1, 2), q(1.2, 0.4, 0.1);
  const Eigen::VectorXd areas = vertex_areas(mesh.vertices, mesh.faces),
                        b = bracket(mesh.faces, areas, mesh.vertices.transpose() * p, mesh.vertices.transpose() * q);
  Eigen::VectorXd expected = Eigen::VectorXd::Zero(areas.size());
  const Mat3X normals = face_normals(mesh.vertices, mesh.faces);
  for (Index f = 0; f < normals.cols(); ++f)  // tangential parts of p and q are the gradients on a face
    for (int k = 0; k < 3; ++k)
      expected[mesh.faces(k, f)] += normals.col(f).dot(p.cross(q)) / 6 / areas[mesh.faces(k, f)];
  CHECK((b - expected).cwiseAbs().maxCoeff() < 1e-12);
  CHECK(std::abs(b.dot(areas)) < 1e-12);
}

TEST_CASE("oriented signatures change their sign in a mirror, kernel signatures do not", "[matching]") {
  const TriangleMesh mesh = test::stretched(test::noisy(icosphere(2), 0.03, 1), Vec3d(1, 0.5, 1.7));
  MeshSequence mirrored = test::still(mesh);
  mirrored.frames[0].row(0) *= -1;
  mirrored.faces.row(1).swap(mirrored.faces.row(2));
  Mat3X mirrored_sphere = icosphere(2).vertices;
  mirrored_sphere.row(0) *= -1;
  const MatchingBody body(test::still(mesh), icosphere(2).vertices), mirror(mirrored, mirrored_sphere);
  test::Uniform uniform(8);
  IntrinsicSpectrum s{Eigen::VectorXd::LinSpaced(12, 2, 30), Eigen::MatrixXd(mesh.vertices.cols(), 12)};
  for (double& value : s.eigenfunctions.reshaped()) value = uniform(-2, 2);
  const Eigen::MatrixXd plain = kernel_signatures(s), a = oriented_signatures(body, s, plain),
                        b = oriented_signatures(mirror, s, plain);
  CHECK(a.cols() == 19);
  CHECK(a.cwiseAbs().maxCoeff() > 0.05);
  CHECK((a + b).cwiseAbs().maxCoeff() < 1e-9);
  CHECK(descriptors(body, s).leftCols(24) == plain);
}

TEST_CASE("channels normalised together have mean 0 and mean square 1 over the pair", "[matching]") {
  test::Uniform uniform(2);
  Eigen::MatrixXd a(6, 2), b(4, 2);
  for (double& value : a.reshaped()) value = uniform(0, 3);
  for (double& value : b.reshaped()) value = uniform(2, 9);
  Eigen::VectorXd wa(6), wb(4);
  wa << 1, 2, 3, 4, 5, 6;
  wb << 2, 2, 1, 5;
  const DescriptorPair d = normalized_together(a, wa, b, wb);
  for (int c = 0; c < 2; ++c) {
    CHECK(d.first.col(c).dot(wa) / 21 + d.second.col(c).dot(wb) / 10 == Approx(0).margin(1e-12));
    CHECK(d.first.col(c).cwiseAbs2().dot(wa) / 21 + d.second.col(c).cwiseAbs2().dot(wb) / 10 == Approx(2));
    CHECK((d.first(1, c) - d.first(0, c)) / (d.second(1, c) - d.second(0, c)) ==
          Approx((a(1, c) - a(0, c)) / (b(1, c) - b(0, c))));
  }
  a.setConstant(1);
  b.setConstant(1);
  CHECK_THROWS_AS(normalized_together(a, wa, b, wb), InvalidArgument);
}

}  // namespace descriptors_test
