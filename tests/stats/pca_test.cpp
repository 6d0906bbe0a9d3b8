#include "catch.hpp"

#include <dsns/stats/pca.hpp>

namespace pca_test {

using namespace dsns;

namespace {

std::vector<Mat3X> snapshots(Index points, int count) {
  std::srand(3);
  const Mat3X mean = Mat3X::Random(3, points), a = Mat3X::Random(3, points), b = Mat3X::Random(3, points);
  std::vector<Mat3X> out;
  for (int k = 0; k < count; ++k) out.push_back(mean + std::sin(1.0 + k) * a + 0.1 * std::cos(2.0 * k) * b);
  return out;
}

}  // namespace

TEST_CASE("two independent motions give two modes that reconstruct everything", "[stats]") {
  const auto x = snapshots(50, 20);
  const Eigen::VectorXd w = Eigen::VectorXd::LinSpaced(50, 0.5, 2);
  const FunctionalPca pca(x, w, {1e-14, 80});
  CHECK(pca.modes() == 2);
  CHECK(pca.residual() < 1e-14);
  for (const auto& s : x) CHECK((pca.reconstruct(pca.project(s)) - s).norm() < 1e-10);
  CHECK(pca.variances()[0] > pca.variances()[1]);
}

TEST_CASE("coefficients are isometric in the weighted inner product, velocities too", "[stats]") {
  const auto x = snapshots(50, 20);
  const Eigen::VectorXd w = Eigen::VectorXd::LinSpaced(50, 0.5, 2);
  const FunctionalPca pca(x, w, {1e-14, 80});
  const Mat3X d = x[3] - x[8];
  const double square = d.colwise().squaredNorm() * w;
  CHECK((pca.project(x[3]) - pca.project(x[8])).squaredNorm() == Approx(square).epsilon(1e-10));
  CHECK(pca.project_velocity(d).squaredNorm() == Approx(square).epsilon(1e-10));
}

TEST_CASE("the residual is that of the reconstructions", "[stats]") {
  const auto x = snapshots(50, 20);
  const Eigen::VectorXd w = Eigen::VectorXd::Ones(50);
  const FunctionalPca pca(x, w, {0, 1});
  REQUIRE(pca.modes() == 1);
  double sum = 0;
  for (const auto& s : x) sum += (pca.reconstruct(pca.project(s)) - s).squaredNorm();
  CHECK(pca.residual() == Approx(sum / (3 * 50 * 20)).epsilon(1e-8));
}

TEST_CASE("components of a basis that grew member by member are those of all snapshots", "[stats]") {
  const auto x = snapshots(50, 20), y = snapshots(50, 9);
  const Eigen::VectorXd w = Eigen::VectorXd::LinSpaced(50, 0.5, 2);
  std::vector<Mat3X> others, all = x;
  for (const auto& s : y) others.push_back(1.3 * s + Mat3X::Constant(3, 50, 0.1 * s(0, 0)));
  all.insert(all.end(), others.begin(), others.end());
  SnapshotBasis basis({1e-16});
  basis.add(x, {x[1] - x[0]});
  basis.add(others);
  const FunctionalPca one(all, w, {1e-14, 80}), two(basis, w, {1e-14, 80});
  REQUIRE(two.modes() == one.modes());
  CHECK((two.variances() - one.variances()).norm() < 1e-8 * one.variances().norm());
  CHECK(two.total_variance() == Approx(one.total_variance()));
  for (const auto& s : all) CHECK((two.reconstruct(two.project(s)) - s).norm() < 1e-6);
  CHECK((two.project_coordinates(basis.coordinates(1)).col(2) - two.project(others[2])).norm() < 1e-8);
  CHECK((two.project_velocity_coordinates(basis.vector_coordinates(0)).col(0) - two.project_velocity(x[1] - x[0]))
            .norm() < 1e-8);
}

TEST_CASE("a basis that may hold few vectors keeps the important ones and counts what it drops", "[stats]") {
  SnapshotBasis basis({1e-16, 4});
  std::srand(5);
  std::vector<Mat3X> all;
  const Mat3X strong = Mat3X::Random(3, 30);
  for (int member = 0; member < 3; ++member) {
    std::vector<Mat3X> x;
    for (int k = 0; k < 3; ++k) x.push_back((1.0 + k + member) * strong + 0.01 * Mat3X::Random(3, 30));
    basis.add(x);
    all.insert(all.end(), x.begin(), x.end());
  }
  CHECK(basis.vectors().cols() <= 4);
  double missed = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Eigen::VectorXd back = basis.origin() + basis.vectors() * basis.coordinates(i / 3).col(Index(i % 3));
    missed += (back - all[i].reshaped()).squaredNorm() / double(all[i].size()) / double(all.size());
  }
  CHECK(basis.residual() == Approx(missed).epsilon(1e-6));
  CHECK(missed < 1e-4);
  CHECK(missed > 1e-6);
}

TEST_CASE("snapshots that do not move have one idle mode", "[stats]") {
  const std::vector<Mat3X> x(4, Mat3X::Ones(3, 10));
  const FunctionalPca pca(x, Eigen::VectorXd::Ones(10));
  CHECK(pca.residual() == 0);
  CHECK((pca.reconstruct(pca.project(x[0])) - x[0]).norm() < 1e-14);
}

TEST_CASE("weights that do not fit are refused", "[stats]") {
  CHECK_THROWS_AS(FunctionalPca(snapshots(5, 3), Eigen::VectorXd::Ones(4)), InvalidArgument);
  CHECK_THROWS_AS(FunctionalPca(snapshots(5, 3), -Eigen::VectorXd::Ones(5)), InvalidArgument);
  CHECK_THROWS_AS(FunctionalPca(snapshots(5, 1), Eigen::VectorXd::Ones(5)), InvalidArgument);
}

}  // namespace pca_test
