#pragma once
/// Principal components of sampled surfaces: one orthonormal basis for all that are compared.
#include <dsns/stats/snapshot_basis.hpp>

#include <Eigen/Cholesky>
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
    total_variance_ = X.squaredNorm() / double(m);
    variances_ = solver.eigenvalues().tail(count).reverse().cwiseMax(0) / double(m);
    modes_ = X * solver.eigenvectors().rightCols(count).rowwise().reverse();
    for (Index k = 0; k < count; ++k) {
      const double length = modes_.col(k).norm();
      if (length > 0) modes_.col(k) /= length;
    }
  }

  /// Of the snapshots that a basis holds; further vectors need its coordinates alone, see project_coordinates().
  /// accuracy modes, variances and reconstructions as from the snapshots themselves, to what the basis leaves [stats/pca_test]
  FunctionalPca(const SnapshotBasis& basis, Eigen::VectorXd weights, const PcaOptions& options = {})
      : weights_(std::move(weights)) {
    const Index n = weights_.size();
    require(basis.snapshots() >= 2, "FunctionalPca: ", basis.snapshots(), " snapshots, give at least two");
    require(basis.vectors().rows() == 3 * n && weights_.minCoeff() >= 0 && weights_.sum() > 0, "FunctionalPca: ", n,
            " weights for ", basis.vectors().rows() / 3, " points, give one non-negative weight a point");
    root_ = weights_.cwiseSqrt().replicate(1, 3).transpose().reshaped();
    const Eigen::VectorXd centre = basis.mean_coordinates();
    mean_ = basis.origin() + basis.vectors() * centre;
    const double m = double(basis.snapshots()), coordinates = 3 * weights_.sum() * m;
    // Snapshots are mean + B c, c - centre of covariance C: with L L^T = B^T W B, L^T C L has the eigenvectors of the modes.
    const Eigen::MatrixXd weighted = root_.asDiagonal() * basis.vectors();
    Eigen::MatrixXd gram = weighted.transpose() * weighted;
    gram.diagonal().array() += 1e-14 * gram.trace();
    const Eigen::LLT<Eigen::MatrixXd> cholesky(gram);
    const Eigen::MatrixXd L = cholesky.matrixL();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(L.transpose() * basis.scatter() * L);
    const Eigen::VectorXd values = solver.eigenvalues().reverse().cwiseMax(0);
    double left = values.sum();
    const double noise = 1e-13 * left;
    Index count = 0;
    while (count < std::min<Index>(options.max_modes, values.size()) && left > options.residual * coordinates &&
           values[count] > noise)
      left -= values[count++];
    count = std::max<Index>(count, 1);
    residual_ = std::max(left, 0.0) / coordinates + basis.residual();
    variances_ = values.head(count) / m;
    total_variance_ = values.sum() / m;
    const Eigen::MatrixXd U = solver.eigenvectors().rightCols(count).rowwise().reverse();
    modes_ = weighted * cholesky.matrixU().solve(U);
    of_coordinates_ = modes_.transpose() * weighted;
    centre_ = centre;
  }

  Index modes() const { return modes_.cols(); }
  /// Mean squared coordinate distance of the snapshots to their reconstructions.
  double residual() const { return residual_; }
  /// Mean squared coefficient of each mode, largest first.
  const Eigen::VectorXd& variances() const { return variances_; }

  /// Sum of all variances, those of modes not kept among them.
  double total_variance() const { return total_variance_; }

  /// Coefficients of positions, 3 x n.
  Eigen::VectorXd project(const Mat3X& x) const { return project_vector(x.reshaped() - mean_); }
  /// Coefficients of velocities, 3 x n: no mean is taken off.
  Eigen::VectorXd project_velocity(const Mat3X& v) const { return project_vector(v.reshaped()); }
  /// The same from coordinates in the basis of which the components were made: positions, or velocities, one a column.
  Eigen::MatrixXd project_coordinates(const Eigen::MatrixXd& positions) const {
    return of_coordinates_ * (positions.colwise() - centre_);
  }
  Eigen::MatrixXd project_velocity_coordinates(const Eigen::MatrixXd& velocities) const {
    return of_coordinates_ * velocities;
  }
  /// Positions of coefficients, 3 x n.
  Mat3X reconstruct(const Eigen::VectorXd& a) const {
    Eigen::VectorXd x = modes_ * a;
    for (Index i = 0; i < x.size(); ++i) x[i] = root_[i] > 0 ? x[i] / root_[i] : 0;
    return Eigen::Map<const Mat3X>(x.data(), 3, x.size() / 3) + Eigen::Map<const Mat3X>(mean_.data(), 3, x.size() / 3);
  }

 private:
  Eigen::VectorXd project_vector(const Eigen::VectorXd& x) const { return modes_.transpose() * x.cwiseProduct(root_); }

  Eigen::VectorXd weights_, root_, mean_, variances_;
  Eigen::MatrixXd modes_;           // scaled by the square roots of the weights: orthonormal columns
  Eigen::MatrixXd of_coordinates_;  // of a basis
  Eigen::VectorXd centre_;
  double residual_ = 0, total_variance_ = 0;
};

}  // namespace dsns
