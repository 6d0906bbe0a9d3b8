#include "catch.hpp"

#include <dsns/stats/linear_model.hpp>

#include <Eigen/QR>

namespace linear_model_test {

using namespace dsns;

namespace {

Eigen::MatrixXd random_matrix(Index rows, Index cols, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd m(rows, cols);
  for (double& x : m.reshaped()) x = normal(random);
  return m;
}

Eigen::MatrixXd orthonormal(Index rows, Index cols, unsigned seed) {
  return Eigen::HouseholderQR<Eigen::MatrixXd>(random_matrix(rows, cols, seed)).householderQ() *
         Eigen::MatrixXd::Identity(rows, cols);
}

/// Four members at +-a along one direction and +-b along another: variances (2/3) a^2 and (2/3) b^2.
struct Cross {
  Eigen::MatrixXd directions = orthonormal(50, 2, 1);
  Eigen::VectorXd centre = random_matrix(50, 1, 2);
  Eigen::MatrixXd members;
  Cross(double a, double b) {
    Eigen::Matrix<double, 2, 4> scores;
    scores << a, -a, 0, 0, 0, 0, b, -b;
    members = (directions * scores).colwise() + centre;
  }
};

}  // namespace

TEST_CASE("linear model: mean, directions and variances of members along known ones", "[stats]") {
  const Cross cross(3, 1);
  const LinearModel model(cross.members);
  REQUIRE(model.modes() == 2);
  CHECK((model.mean() - cross.centre).norm() < 1e-13);
  CHECK(model.variances()[0] == Approx(6));
  CHECK(model.variances()[1] == Approx(2.0 / 3));
  CHECK(model.total_variance() == Approx(20.0 / 3));
  CHECK(std::abs(model.directions().col(0).dot(cross.directions.col(0))) == Approx(1));
  CHECK(std::abs(model.directions().col(1).dot(cross.directions.col(1))) == Approx(1));
  for (Index i = 0; i < 4; ++i) {
    CHECK((model.project(cross.members.col(i)) - model.scores().col(i)).norm() < 1e-12);
    CHECK((model.at(model.scores().col(i)) - cross.members.col(i)).norm() < 1e-12);
  }
  CHECK((model.at(model.scores().col(2).head(1)) - cross.centre).norm() < 1e-12);  // +b has nothing along the first
  CHECK(LinearModel(cross.members.col(0).replicate(1, 3)).modes() == 0);
  CHECK_THROWS_AS(LinearModel(cross.members.leftCols(1)), InvalidArgument);
  CHECK_THROWS_AS(LinearModel(Eigen::MatrixXd::Constant(2, 2, std::nan(""))), InvalidArgument);
}

TEST_CASE("linear model: random scores have the variances of the modes, within their bound, by seed", "[stats]") {
  const LinearModel model(Cross(3, 1).members);
  const Eigen::MatrixXd scores = random_scores(model, 2, 20000, 7);
  // The variance of a normal number cut off at 3 is 1 - 6 phi(3) / (2 Phi(3) - 1) = 0.97334.
  for (Index k = 0; k < 2; ++k) {
    CHECK(std::abs(scores.row(k).mean()) < 0.03 * std::sqrt(model.variances()[k]));
    CHECK(scores.row(k).squaredNorm() / 20000 == Approx(0.97334 * model.variances()[k]).epsilon(0.03));
    CHECK(scores.row(k).cwiseAbs().maxCoeff() <= 3 * std::sqrt(model.variances()[k]));
  }
  CHECK(scores == random_scores(model, 2, 20000, 7));
  CHECK(scores != random_scores(model, 2, 20000, 8));
  CHECK(random_scores(model, 0, 5, 1).size() == 0);
  CHECK_THROWS_AS(random_scores(model, 3, 5, 1), InvalidArgument);
}

TEST_CASE("model quality: compactness, generalisation and specificity where they are known", "[stats]") {
  const Cross cross(3, 1);
  const ModelQuality quality = model_quality(cross.members, 2000);
  CHECK(quality.compactness[0] == Approx(0.9));
  CHECK(quality.compactness[1] == Approx(1));
  // Left out +3 along the first: the rest has the mean -1 along it, members -3, 0, 0 and +-1 along the second. Its first mode
  // is the first direction (6 against 2): nothing remains. Left out +1 along the second: the first mode is again the first
  // direction, 1 + 1/3 remains.
  REQUIRE(quality.generalisation.size() == 2);
  CHECK(quality.generalisation[0] == Approx((2 * 0 + 2 * 4.0 / 3) / 4));
  CHECK(quality.generalisation[1] == Approx(0).margin(1e-7));
  // One mode: a normal number of variance 6, cut off, to the nearest of -3, +3 and the two others at distance 1 from 0.
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  double expected = 0;
  int count = 0;
  while (count < 200000) {
    const double x = normal(random);
    if (std::abs(x) > 3) continue;
    const double s = std::sqrt(6.0) * x;
    expected += std::min({std::abs(s - 3), std::abs(s + 3), std::hypot(s, 1)});
    ++count;
  }
  CHECK(quality.specificity[0] == Approx(expected / count).epsilon(0.03));
  CHECK_THROWS_AS(model_quality(cross.members.leftCols(2)), InvalidArgument);
}

}  // namespace linear_model_test
