#include "catch.hpp"

#include <dsns/stats/groups.hpp>

#include <set>

namespace groups_test {

using namespace dsns;

namespace {

Eigen::MatrixXd random_points(Index dimension, Index n, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd m(dimension, n);
  for (double& x : m.reshaped()) x = normal(random);
  return m;
}

Eigen::MatrixXd line(const std::vector<double>& x) {
  return distance_matrix(Eigen::Map<const Eigen::RowVectorXd>(x.data(), Index(x.size())));
}

}  // namespace

TEST_CASE("groups: the pseudo F of points is the F of the analysis of variance", "[stats]") {
  // {0, 1, 2} and {5, 6, 7}: between groups 37.5 with one degree of freedom, within 4 with four.
  const PermutationTest test = permutation_test(line({0, 1, 2, 5, 6, 7}), {4, 4, 4, 9, 9, 9}, 4999, 1);
  CHECK(test.statistic == Approx(37.5));
  CHECK(test.p_value == Approx(0.1).margin(0.015));  // two of the twenty ways to choose three
  CHECK_THROWS_AS(permutation_test(line({0, 1}), {1, 1}), InvalidArgument);
  CHECK_THROWS_AS(permutation_test(line({0, 1, 2}), {1, 2, 3}), InvalidArgument);
  CHECK_THROWS_AS(permutation_test(line({0, 1, 2}), {1, 2}), InvalidArgument);
}

TEST_CASE("groups: where labels mean nothing the permutation test rejects at its nominal rate", "[stats]") {
  const Eigen::MatrixXd distances = distance_matrix(random_points(3, 12, 5));
  std::vector<int> labels{0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1};
  std::mt19937 random(6);
  constexpr int repetitions = 500;
  int below5 = 0, below50 = 0;
  for (int r = 0; r < repetitions; ++r) {
    std::shuffle(labels.begin(), labels.end(), random);
    const double p = permutation_test(distances, labels, 99, std::uint64_t(r)).p_value;
    below5 += p <= 0.05;
    below50 += p <= 0.5;
  }
  // three standard deviations of the binomial distribution
  CHECK(std::abs(below5 - 25) <= 3 * std::sqrt(repetitions * 0.05 * 0.95));
  CHECK(std::abs(below50 - 250) <= 3 * std::sqrt(repetitions * 0.25));
}

TEST_CASE("groups: leave-one-out classification, its accuracy and chance", "[stats]") {
  const Eigen::MatrixXd distances = line({0, 1, 2.5, 10, 11, 3.2});
  const std::vector<int> labels{1, 1, 1, 2, 2, 2};
  const Classification nearest = classify_leave_one_out(distances, labels);
  CHECK(nearest.predicted == std::vector{1, 1, 2, 2, 2, 1});
  CHECK(nearest.accuracy == Approx(4.0 / 6));
  CHECK(nearest.chance == Approx(0.4));
  CHECK(classify_leave_one_out(distances, labels, 3).predicted == std::vector{1, 1, 1, 2, 2, 1});
  CHECK_THROWS_AS(classify_leave_one_out(distances, labels, 6), InvalidArgument);
}

TEST_CASE("groups: an outlier is far from the median member", "[stats]") {
  const Eigen::VectorXd scores = outlier_scores(line({0, 1, 2, 3, 40}));
  Index most;
  scores.maxCoeff(&most);
  CHECK(most == 4);
  CHECK(scores[4] == Approx(38.5 / 2.5));  // medians: 2.5, 1.5, 1.5, 2.5, 38.5; in the middle 2.5
}

TEST_CASE("groups: average linkage joins nearest clusters first", "[stats]") {
  const Clustering tree = cluster(line({0, 10, 1, 11, 30}));
  REQUIRE(tree.merges.size() == 4);
  CHECK(tree.merges[0].distance == Approx(1));
  CHECK(tree.merges[1].distance == Approx(1));
  CHECK(tree.merges[2].distance == Approx(10));    // (10 + 11 + 9 + 10) / 4
  CHECK(tree.merges[3].distance == Approx(24.5));  // 30, 29, 20, 19
  CHECK(tree.order == std::vector<Index>{0, 2, 1, 3, 4});
  CHECK(tree.merges[2].a == 5);
  CHECK(tree.merges[2].b == 6);
}

TEST_CASE("groups: regression finds a known slope and its share of the variance", "[stats]") {
  const std::vector<double> age{1, 2, 3, 4, 5, 6, 7, 8};
  Eigen::MatrixXd scores = random_points(2, 8, 3);
  Eigen::RowVectorXd x(8);
  for (Index i = 0; i < 8; ++i) x[i] = age[std::size_t(i)] - 4.5;
  // what is left is orthogonal to the covariate and to the constant
  for (Index k = 0; k < 2; ++k) {
    scores.row(k).array() -= scores.row(k).mean();
    scores.row(k) -= scores.row(k).dot(x) / x.squaredNorm() * x;
  }
  const double rest = scores.squaredNorm();
  scores += Eigen::Vector2d(2, -1) * x;
  scores.colwise() += Eigen::Vector2d(10, 20);
  const Regression r = regress(scores, age, 499);
  CHECK((r.slope - Eigen::Vector2d(2, -1)).norm() < 1e-12);
  CHECK((r.centre - Eigen::Vector2d(10, 20)).norm() < 1e-12);
  CHECK(r.covariate_mean == Approx(4.5));
  CHECK(r.explained == Approx(5 * x.squaredNorm() / (5 * x.squaredNorm() + rest)));
  CHECK(r.test.p_value <= 0.01);
  CHECK_THROWS_AS(regress(scores, {1, 1, 1, 1, 1, 1, 1, 1}), InvalidArgument);
}

}  // namespace groups_test
