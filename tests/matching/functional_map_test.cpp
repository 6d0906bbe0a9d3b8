#include "catch.hpp"
#include "support/bodies.hpp"

#include <dsns/matching/functional_map.hpp>
#include <dsns/matching/map_orientation.hpp>
#include <dsns/sphere/diffeomorphism.hpp>

#include <Eigen/QR>

namespace functional_map_test {

using namespace dsns;

namespace {

Eigen::MatrixXd random_matrix(Index rows, Index cols, unsigned seed) {
  test::Uniform uniform(seed);
  Eigen::MatrixXd m(rows, cols);
  for (double& value : m.reshaped()) value = uniform(-1, 1);
  return m;
}

Eigen::MatrixXd random_orthogonal(Index k, unsigned seed) {
  return Eigen::HouseholderQR<Eigen::MatrixXd>(random_matrix(k, k, seed)).householderQ();
}

/// Points whose functions are harmonics: what a sphere's spectrum is.
SpectralPoints harmonic_points(const Mat3X& s, const Eigen::MatrixXd& channels) {
  return {s, std::sqrt(4 * pi) * harmonics(s, 4).rightCols(24), harmonics(s, 3) * channels};
}

}  // namespace

TEST_CASE("nearest columns are those of a search", "[matching]") {
  const Eigen::MatrixXf queries = random_matrix(7, 150, 1).cast<float>(),
                        points = random_matrix(7, 333, 2).cast<float>();
  const std::vector<Index> found = nearest_columns(queries, points);
  for (Index i = 0; i < queries.cols(); ++i) {
    Index nearest = 0;
    (points.colwise() - queries.col(i)).colwise().squaredNorm().minCoeff(&nearest);
    CHECK(found[std::size_t(i)] == nearest);
  }
  CHECK_THROWS_AS(nearest_columns(queries, random_matrix(6, 3, 1).cast<float>()), InvalidArgument);
}

TEST_CASE("the orthogonal map is found again, and is the best", "[matching]") {
  const Eigen::MatrixXd first = random_matrix(60, 8, 3), C = random_orthogonal(8, 4);
  const Eigen::VectorXd weights = (random_matrix(60, 1, 5).array() + 1.1).matrix();
  CHECK((orthogonal_map(first, first * C, weights) - C).norm() < 1e-10);

  const Eigen::MatrixXd second = first * C + 0.5 * random_matrix(60, 8, 6),
                        best = orthogonal_map(first, second, weights);
  CHECK((best.transpose() * best - Eigen::MatrixXd::Identity(8, 8)).norm() < 1e-10);
  const auto cost = [&](const Eigen::MatrixXd& map) {
    return weights.dot((first * map - second).rowwise().squaredNorm());
  };
  for (unsigned seed = 7; seed < 12; ++seed) {
    const Eigen::MatrixXd skew = random_matrix(8, 8, seed);
    const Eigen::MatrixXd near =
        Eigen::HouseholderQR<Eigen::MatrixXd>(Eigen::MatrixXd::Identity(8, 8) + 0.02 * (skew - skew.transpose()))
            .householderQ();
    const Eigen::MatrixXd signs = near.diagonal().cwiseSign().asDiagonal();
    CHECK(cost(best) <= cost(best * near * signs));
  }
}

TEST_CASE("zooming out from rough matches finds a rotation of the sphere", "[matching]") {
  const Mat3 R = rotation_exp(Vec3d(0.4, -1, 2));
  const Mat3X s = test::random_unit_vectors(400, 5), t = (R * s).colwise().normalized();
  const Eigen::MatrixXd channels = random_matrix(16, 5, 9);
  const SpectralPoints second = harmonic_points(t, channels);
  SpectralPoints first = harmonic_points(s, channels);
  first.descriptors = second.descriptors;
  const Mat3X rough = (rotation_exp(Vec3d(0.3, 0.2, -0.2)) * t).colwise().normalized();
  const std::array<int, 8> sizes{3, 3, 8, 8, 24, 24, 24, 24};
  const FeatureWeights weights{.spectral = 0.3, .descriptors = 0.5};  // the spectrum alone fits every rotation as well
  const FunctionalMap found = zoom_out(first, Eigen::VectorXd::Ones(400), second,
                                       nearest_columns(rough.cast<float>(), t.cast<float>()), sizes, weights);
  int wrong = 0;
  for (Index i = 0; i < 400; ++i) wrong += found.matches[std::size_t(i)] != i;
  CHECK(wrong == 0);
  CHECK(found.residual < 1e-10);
  CHECK((first.functions * found.map - second.functions).norm() < 1e-4);
  CHECK_THROWS_AS(zoom_out(first, Eigen::VectorXd::Ones(400), second, found.matches, std::array{25}, {}),
                  InvalidArgument);
}

TEST_CASE("orientation tells a map from a flipped one", "[matching]") {
  const Mat3X s = test::random_unit_vectors(500, 6);
  const MapOrientation orientation(s);
  const Mat3 R = rotation_exp(Vec3d(1, 2, -1));
  CHECK(orientation(R * s) == 1);
  CHECK(orientation(-(R * s)) == -1);
  CHECK(orientation(random_diffeomorphism(3, 4, 0.2)(s)) > 0.98);
  Mat3X half = s;  // folded along the equator: northern points stay, southern ones are mirrored
  half.row(2) = half.row(2).cwiseAbs();
  CHECK(std::abs(orientation(half)) < 0.2);
  CHECK_THROWS_AS(MapOrientation(s.leftCols(10)), InvalidArgument);
}

}  // namespace functional_map_test
