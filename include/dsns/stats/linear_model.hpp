#pragma once
/// Principal components of a few long vectors, and how good a model of their group they are.
#include <dsns/core/errors.hpp>
#include <dsns/core/types.hpp>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

namespace dsns {

/// x = mean + modes b with b uncorrelated over the members: Gaussian with the variances along the modes.
class LinearModel {
 public:
  /// members  one a column, d x n with n >= 2; distances of columns are those of the members
  explicit LinearModel(const Eigen::MatrixXd& members) {
    const Index n = members.cols();
    require(n >= 2 && members.rows() > 0 && members.allFinite(), "LinearModel: ", n, " members with ", members.rows(),
            " numbers, give at least two of finite numbers");
    mean_ = members.rowwise().mean();
    Eigen::MatrixXd X = members.colwise() - mean_;
    // The Gram matrix of the members is small; its eigenvectors are their scores.
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(X.transpose() * X);
    const Eigen::VectorXd values = solver.eigenvalues().reverse().cwiseMax(0);
    total_ = values.sum() / double(n - 1);
    Index count = 0;
    const double rounding = std::max(1e-12 * values[0], 1e-26 * members.squaredNorm());
    while (count < n - 1 && values[count] > rounding) ++count;
    variances_ = values.head(count) / double(n - 1);
    modes_ = X * solver.eigenvectors().rightCols(count).rowwise().reverse();
    for (Index k = 0; k < count; ++k) modes_.col(k).normalize();
    scores_ = modes_.transpose() * X;
  }

  /// Fewer than members.
  Index modes() const { return modes_.cols(); }
  const Eigen::VectorXd& mean() const { return mean_; }
  /// Orthonormal columns, d x modes.
  const Eigen::MatrixXd& directions() const { return modes_; }
  /// Of the scores, largest first, without bias (n - 1).
  const Eigen::VectorXd& variances() const { return variances_; }
  /// Sum of the variances.
  double total_variance() const { return total_; }
  /// Of the members, modes x n.
  const Eigen::MatrixXd& scores() const { return scores_; }

  Eigen::VectorXd project(const Eigen::VectorXd& x) const { return modes_.transpose() * (x - mean_); }
  /// The vector with these scores of the first modes, at most all.
  Eigen::VectorXd at(const Eigen::VectorXd& scores) const { return mean_ + modes_.leftCols(scores.size()) * scores; }

 private:
  Eigen::VectorXd mean_, variances_;
  Eigen::MatrixXd modes_, scores_;
  double total_ = 0;
};

/// Scores of `count` random members along the first modes, modes x count: normal, cut off at `most` standard deviations.
inline Eigen::MatrixXd random_scores(const LinearModel& model, Index modes, int count, std::uint64_t seed,
                                     double most = 3) {
  require(modes >= 0 && modes <= model.modes() && count >= 0 && most > 0, "random_scores: ", count, " samples of ",
          modes, " modes of ", model.modes(), " within ", most,
          " deviations, give no more modes than there are and a positive bound");
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd scores(modes, count);
  for (double& x : scores.reshaped()) {
    do x = normal(random);
    while (std::abs(x) > most);
  }
  return model.variances().head(modes).cwiseSqrt().asDiagonal() * scores;
}

/// For models of k = 1, 2, ... modes; distances are those of members' vectors.
struct ModelQuality {
  Eigen::VectorXd compactness;     ///< share of the variance in the first k modes
  Eigen::VectorXd generalisation;  ///< distance of a member to the model of the others, mean over members
  Eigen::VectorXd specificity;     ///< distance of a random sample to the nearest member, mean over samples
};

/// source   Davies, Twining, Taylor 2008, chapter 9
inline ModelQuality model_quality(const Eigen::MatrixXd& members, int samples = 200, std::uint64_t seed = 0) {
  require(members.cols() >= 3 && samples > 0, "model_quality: ", members.cols(), " members and ", samples,
          " samples, give at least three and one");
  const Index n = members.cols();
  const LinearModel model(members);
  const Index most = model.modes();
  ModelQuality quality{Eigen::VectorXd::Zero(most), Eigen::VectorXd::Zero(std::min(most, n - 2)),
                       Eigen::VectorXd::Zero(most)};
  for (Index k = 0; k < most; ++k)
    quality.compactness[k] = model.variances().head(k + 1).sum() / model.total_variance();

  for (Index left_out = 0; left_out < n; ++left_out) {
    Eigen::MatrixXd others(members.rows(), n - 1);
    others << members.leftCols(left_out), members.rightCols(n - 1 - left_out);
    const LinearModel rest(others);
    const Eigen::VectorXd x = members.col(left_out) - rest.mean(), scores = rest.project(members.col(left_out));
    double squared = x.squaredNorm();
    for (Index k = 0; k < quality.generalisation.size(); ++k) {
      if (k < scores.size()) squared -= scores[k] * scores[k];
      quality.generalisation[k] += std::sqrt(std::max(squared, 0.0)) / double(n);
    }
  }

  // Members and samples differ by scores: members lie in the span of all modes.
  const Eigen::MatrixXd random = random_scores(model, most, samples, seed);
  for (Index k = 0; k < most; ++k)
    for (int i = 0; i < samples; ++i) {
      Eigen::VectorXd sample = Eigen::VectorXd::Zero(most);
      sample.head(k + 1) = random.col(i).head(k + 1);
      quality.specificity[k] +=
          std::sqrt((model.scores().colwise() - sample).colwise().squaredNorm().minCoeff()) / samples;
    }
  return quality;
}

}  // namespace dsns
