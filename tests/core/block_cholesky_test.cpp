#include "catch.hpp"

#include <dsns/core/block_cholesky.hpp>

namespace block_cholesky_test {

using namespace dsns;

namespace {

/// Unknowns 0 .. 9 and 10 .. 19 meet only through 20 .. 24; x^T A x = sum over a few sets of (sum of x)^2 and |x|^2.
struct Separated {
  BlockCholesky blocks{{0, 4, 10, 17, 20, 22, 25}};
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(25, 25);

  Separated() {
    for (const std::vector<Index>& at : {std::vector<Index>{0, 3, 5, 9, 20},
                                         {1, 2, 4, 6, 7, 8, 24},
                                         {0, 8, 21, 22},
                                         {10, 12, 19, 20, 23},
                                         {11, 13, 14, 15, 18},
                                         {14, 16, 17, 24}}) {
      const Index n = Index(at.size());
      Eigen::MatrixXd m = Eigen::MatrixXd::Identity(n, n);
      for (Index i = 0; i < n; ++i)
        for (Index j = 0; j < n; ++j) m(i, j) += std::cos(double(i) - double(j));  // of rank 2, not negative
      blocks.add(at, m);
      for (Index i = 0; i < n; ++i)
        for (Index j = 0; j < n; ++j) dense(at[std::size_t(i)], at[std::size_t(j)]) += m(i, j);
    }
  }
};

}  // namespace

TEST_CASE("a factorization by blocks solves as a dense one does, with any number of threads", "[core]") {
  const Eigen::MatrixXd b =
      Eigen::MatrixXd::NullaryExpr(25, 3, [](Index i, Index j) { return std::sin(double(i + 7 * j)); });
  Eigen::MatrixXd first;
  for (const int threads : {1, 3}) {
    Separated s;
    s.blocks.add_ridge(0.1);
    s.dense.diagonal().array() += 0.1 * s.dense.diagonal().mean();
    REQUIRE(s.blocks.factorize(threads));
    Eigen::MatrixXd x = b;
    s.blocks.solve_in_place(x);
    CHECK((x - s.dense.llt().solve(b)).norm() < 1e-12);
    if (threads == 1)
      first = x;
    else
      CHECK(x == first);
  }
}

TEST_CASE("a matrix that is not positive definite has no factor by blocks", "[core]") {
  Separated s;
  s.blocks.add({24}, Eigen::MatrixXd::Constant(1, 1, -100));
  CHECK_FALSE(s.blocks.factorize(1));
}

}  // namespace block_cholesky_test
