#pragma once
/// Principal components of sampled surfaces: one orthonormal basis for all that are compared.
#include <dsns/core/errors.hpp>
#include <dsns/core/types.hpp>

#include <Eigen/Eigenvalues>
#include <vector>

namespace dsns {

struct PcaOptions {
  double residual = 1e-7;  ///< stop at this mean squared coordinate error of the snapshots, squared length unit
  int max_modes = 80;
};

/// x = mean + sum_k a_k mode_k at n points, orthonormal in <x, y> = sum_i w_i x_i . y_i.
class FunctionalPca {
 public:
  /// snapshots  each 3 x n; weights  n areas, all positive or zero
  /// accuracy   reconstruction of the snapshots to the residual asked for [stats/pca_test]
  FunctionalPca(const std::vector<Mat3X>& snapshots, Eigen::VectorXd weights, const PcaOptions& options = {})
      : weights_(std::move(weights)) {
    require(snapshots.size() >= 2, "FunctionalPca: ", snapshots.size(), " snapshots, give at least two");
    const Index n = weights_.size(), m = Index(snapshots.size());
    require(snapshots.front().cols() == n && weights_.minCoeff() >= 0 && weights_.sum() > 0, "FunctionalPca: ", n,
            " weights for ", snapshots.front().cols(), " points, give one non-negative weight a point");
    root_ = weights_.cwiseSqrt().replicate(1, 3).transpose().reshaped();
    Eigen::MatrixXd X(3 * n, m);
    for (Index k = 0; k < m; ++k) X.col(k) = snapshots[std::size_t(k)].reshaped();
    mean_ = X.rowwise().mean();
    X.colwise() -= mean_;
    X.array().colwise() *= root_.array();
    // The Gram matrix of the snapshots is small; its eigenvectors give the modes.
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(X.transpose() * X);
    const double coordinates = 3 * weights_.sum() * double(m);
    double left = X.squaredNorm();
    const double noise = 1e-13 * left;
    Index count = 0;
    while (count < std::min<Index>(options.max_modes, m - 1) && left > options.residual * coordinates &&
           solver.eigenvalues()[m - 1 - count] > noise) {
      left -= solver.eigenvalues()[m - 1 - count];
      ++count;
    }
    count = std::max<Index>(count, 1);
    residual_ = std::max(left, 0.0) / coordinates;
    variances_ = solver.eigenvalues().tail(count).reverse().cwiseMax(0) / double(m);
    modes_ = X * solver.eigenvectors().rightCols(count).rowwise().reverse();
    for (Index k = 0; k < count; ++k) {
      const double length = modes_.col(k).norm();
      if (length > 0) modes_.col(k) /= length;
    }
  }

  Index modes() const { return modes_.cols(); }
  /// Mean squared coordinate distance of the snapshots to their reconstructions.
  double residual() const { return residual_; }
  /// Mean squared coefficient of each mode, largest first.
  const Eigen::VectorXd& variances() const { return variances_; }

  /// Coefficients of positions, 3 x n.
  Eigen::VectorXd project(const Mat3X& x) const { return project_vector(x.reshaped() - mean_); }
  /// Coefficients of velocities, 3 x n: no mean is taken off.
  Eigen::VectorXd project_velocity(const Mat3X& v) const { return project_vector(v.reshaped()); }
  /// Positions of coefficients, 3 x n.
  Mat3X reconstruct(const Eigen::VectorXd& a) const {
    Eigen::VectorXd x = modes_ * a;
    for (Index i = 0; i < x.size(); ++i) x[i] = root_[i] > 0 ? x[i] / root_[i] : 0;
    return Eigen::Map<const Mat3X>(x.data(), 3, x.size() / 3) + Eigen::Map<const Mat3X>(mean_.data(), 3, x.size() / 3);
  }

 private:
  Eigen::VectorXd project_vector(const Eigen::VectorXd& x) const { return modes_.transpose() * x.cwiseProduct(root_); }

  Eigen::VectorXd weights_, root_, mean_, variances_;
  Eigen::MatrixXd modes_;  // scaled by the square roots of the weights: orthonormal columns
  double residual_ = 0;
};

}  // namespace dsns
