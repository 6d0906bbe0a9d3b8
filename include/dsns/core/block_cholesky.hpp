#pragma once
/// Cholesky factorization of a symmetric positive definite matrix most of whose blocks are zero: dense arithmetic on the
/// blocks that are not.
#include <dsns/core/errors.hpp>
#include <dsns/core/parallel.hpp>
#include <dsns/core/types.hpp>

#include <Eigen/Cholesky>

#include <utility>
#include <vector>

namespace dsns {

/// The lower triangle of a symmetric matrix in blocks, then its factor. How many blocks fill up depends on the order of the
/// unknowns: sets that separate others from each other belong last.
class BlockCholesky {
 public:
  /// starts   where each block of unknowns begins, and at the end their number
  explicit BlockCholesky(std::vector<Index> starts)
      : starts_(std::move(starts)), of_(std::size_t(starts_.back())), blocks_(std::size_t(count() * count())) {
    for (Index b = 0; b < count(); ++b)
      for (Index k = starts_[std::size_t(b)]; k < starts_[std::size_t(b) + 1]; ++k) of_[std::size_t(k)] = b;
  }

  Index size() const { return starts_.back(); }

  /// Adds a symmetric matrix, of which the lower triangle is read, at increasing rows and columns.
  void add(const std::vector<Index>& at, const Eigen::MatrixXd& matrix) {
    for (std::size_t j = 0; j < at.size(); ++j)
      for (std::size_t i = j; i < at.size(); ++i) {
        Eigen::MatrixXd& block = filled(of_[std::size_t(at[i])], of_[std::size_t(at[j])]);
        block(local(at[i]), local(at[j])) += matrix(Index(i), Index(j));
      }
  }
  /// Adds a multiple of the mean diagonal to the diagonal.
  void add_ridge(double ridge) {
    double sum = 0;
    for (Index b = 0; b < count(); ++b) sum += filled(b, b).trace();
    for (Index b = 0; b < count(); ++b) filled(b, b).diagonal().array() += ridge * sum / double(size());
  }

  /// Replaces the matrix by its factor. The result does not depend on the threads.
  /// accuracy solutions 1e-12 against a dense factorization [core/block_cholesky_test]
  /// returns  false where the matrix is not positive definite
  [[nodiscard]] bool factorize(int threads) {
    std::vector<Index> below;
    std::vector<std::pair<Index, Index>> pairs;
    for (Index c = 0; c < count(); ++c) {
      Eigen::MatrixXd& pivot = filled(c, c);
      const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(pivot);
      if (factor.info() != Eigen::Success) return false;
      below.clear(), pairs.clear();
      for (Index r = c + 1; r < count(); ++r)
        if (block(r, c).size() > 0) below.push_back(r);
      parallel_for(int(below.size()), threads, [&](int k) {
        Eigen::MatrixXd& b = block(below[std::size_t(k)], c);
        factor.matrixL().transpose().template solveInPlace<Eigen::OnTheRight>(b);
      });
      for (const Index r : below)
        for (const Index k : below)
          if (k <= r) filled(r, k), pairs.emplace_back(r, k);
      parallel_for(int(pairs.size()), threads, [&](int p) {
        const auto [r, k] = pairs[std::size_t(p)];
        block(r, k).noalias() -= block(r, c) * block(k, c).transpose();
      });
    }
    return true;
  }

  /// Solves after factorize().
  void solve_in_place(Eigen::MatrixXd& x) const {
    const auto rows = [&](Index b) { return x.middleRows(starts_[std::size_t(b)], width(b)); };
    for (Index c = 0; c < count(); ++c) {
      block(c, c).triangularView<Eigen::Lower>().solveInPlace(rows(c));
      for (Index r = c + 1; r < count(); ++r)
        if (block(r, c).size() > 0) rows(r).noalias() -= block(r, c) * rows(c);
    }
    for (Index c = count() - 1; c >= 0; --c) {
      for (Index r = c + 1; r < count(); ++r)
        if (block(r, c).size() > 0) rows(c).noalias() -= block(r, c).transpose() * rows(r);
      block(c, c).triangularView<Eigen::Lower>().transpose().solveInPlace(rows(c));
    }
  }

 private:
  Index count() const { return Index(starts_.size()) - 1; }
  Index width(Index b) const { return starts_[std::size_t(b) + 1] - starts_[std::size_t(b)]; }
  Index local(Index k) const { return k - starts_[std::size_t(of_[std::size_t(k)])]; }
  Eigen::MatrixXd& block(Index r, Index c) { return blocks_[std::size_t(r * count() + c)]; }
  const Eigen::MatrixXd& block(Index r, Index c) const { return blocks_[std::size_t(r * count() + c)]; }
  Eigen::MatrixXd& filled(Index r, Index c) {
    Eigen::MatrixXd& b = block(r, c);
    if (b.size() == 0) b.setZero(width(r), width(c));
    return b;
  }

  std::vector<Index> starts_, of_;
  std::vector<Eigen::MatrixXd> blocks_;  // without entries where zero
};

}  // namespace dsns
