#pragma once
/// An orthonormal basis that grows with the snapshots it is shown: what many surfaces leave behind when each is seen but once, so
/// that memory grows with their variety and not with their number.
#include <dsns/core/errors.hpp>
#include <dsns/core/types.hpp>

#include <Eigen/Eigenvalues>
#include <utility>
#include <vector>

namespace dsns {

struct SnapshotBasisOptions {
  double residual =
      1e-10;         ///< mean squared coordinate error of the snapshots of a member, at most, squared length unit
  Index most = 600;  ///< vectors: beyond that the least important half is dropped, and counted in residual()
};

/// Members are sequences of snapshots, 3 x n each, and of vectors such as velocities, which do not extend the basis.
class SnapshotBasis {
 public:
  explicit SnapshotBasis(const SnapshotBasisOptions& options = {}) : options_(options) {}

  /// accuracy snapshots come back from their coordinates to the residual asked for [stats/pca_test]
  void add(const std::vector<Mat3X>& snapshots, const std::vector<Mat3X>& vectors = {}) {
    require(!snapshots.empty() && (origin_.size() == 0 || snapshots.front().size() == origin_.size()),
            "SnapshotBasis: ", snapshots.size(), " snapshots of ", snapshots.empty() ? 0 : snapshots.front().cols(),
            " points, give at least one, of as many points as the former");
    if (origin_.size() == 0) {
      origin_ = snapshots.front().reshaped();
      basis_.resize(origin_.size(), 0);
    }
    Eigen::MatrixXd X = columns(snapshots).colwise() - origin_;
    extend(X);
    members_.push_back({basis_.transpose() * X, basis_.transpose() * columns(vectors)});
    count_ += X.cols();
    if (basis_.cols() > options_.most) compress();
  }

  std::size_t members() const { return members_.size(); }
  Index snapshots() const { return count_; }
  const Eigen::VectorXd& origin() const { return origin_; }
  /// Orthonormal columns, 3 n x k.
  const Eigen::MatrixXd& vectors() const { return basis_; }
  /// Of the snapshots less the origin, k x count; likewise of the further vectors.
  Eigen::MatrixXd coordinates(std::size_t member) const { return padded(members_[member].first); }
  Eigen::MatrixXd vector_coordinates(std::size_t member) const { return padded(members_[member].second); }
  Eigen::VectorXd mean_coordinates() const {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(basis_.cols());
    for (const auto& [c, v] : members_) sum.head(c.rows()) += c.rowwise().sum();
    return sum / double(std::max<Index>(count_, 1));
  }
  /// Sum of (c - mean)(c - mean)^T over all snapshots.
  Eigen::MatrixXd scatter() const {
    const Eigen::VectorXd mean = mean_coordinates();
    Eigen::MatrixXd sum = -double(count_) * mean * mean.transpose();
    for (const auto& [c, v] : members_) sum.topLeftCorner(c.rows(), c.rows()) += c * c.transpose();
    return sum;
  }
  /// Mean squared coordinate error by what was dropped.
  double residual() const { return dropped_ / std::max(1.0, double(origin_.size()) * double(count_)); }

 private:
  Eigen::MatrixXd columns(const std::vector<Mat3X>& fields) const {
    Eigen::MatrixXd X(origin_.size(), Index(fields.size()));
    for (std::size_t k = 0; k < fields.size(); ++k) X.col(Index(k)) = fields[k].reshaped();
    return X;
  }
  Eigen::MatrixXd padded(const Eigen::MatrixXd& c) const {
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(basis_.cols(), c.cols());
    out.topRows(c.rows()) = c;
    return out;
  }

  /// With the largest components of what the basis leaves of X.
  void extend(const Eigen::MatrixXd& X) {
    Eigen::MatrixXd rest = X;
    for (int twice = 0; twice < 2; ++twice) rest -= basis_ * (basis_.transpose() * rest);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(rest.transpose() * rest);
    const Eigen::VectorXd values = solver.eigenvalues().reverse().cwiseMax(0);
    const double allowed = options_.residual * double(X.size()), noise = 1e-13 * X.squaredNorm();
    double left = values.sum();
    Index more = 0;
    while (more < values.size() && left > allowed && values[more] > noise) left -= values[more++];
    dropped_ += std::max(left, 0.0);
    if (more == 0) return;
    Eigen::MatrixXd fresh = rest * solver.eigenvectors().rightCols(more).rowwise().reverse();
    for (Index k = 0; k < more; ++k) {
      fresh.col(k) -= basis_ * (basis_.transpose() * fresh.col(k));
      fresh.col(k) -= fresh.leftCols(k) * (fresh.leftCols(k).transpose() * fresh.col(k));
      fresh.col(k).normalize();
    }
    Eigen::MatrixXd both(basis_.rows(), basis_.cols() + more);
    both << basis_, fresh;
    basis_ = std::move(both);
  }

  void compress() {
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(basis_.cols(), basis_.cols());
    for (const auto& [c, v] : members_) sum.topLeftCorner(c.rows(), c.rows()) += c * c.transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(sum);
    const Index kept = options_.most / 2;
    dropped_ += solver.eigenvalues().head(basis_.cols() - kept).cwiseMax(0).sum();
    const Eigen::MatrixXd U = solver.eigenvectors().rightCols(kept).rowwise().reverse();
    for (auto& [c, v] : members_) {
      c = U.transpose() * padded(c);
      v = U.transpose() * padded(v);
    }
    basis_ = basis_ * U;
  }

  SnapshotBasisOptions options_;
  Eigen::VectorXd origin_;
  Eigen::MatrixXd basis_;
  std::vector<std::pair<Eigen::MatrixXd, Eigen::MatrixXd>> members_;
  Index count_ = 0;
  double dropped_ = 0;
};

}  // namespace dsns
