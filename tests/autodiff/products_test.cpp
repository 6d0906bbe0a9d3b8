#include "catch.hpp"

#include <dsns/autodiff/products.hpp>

#include <Eigen/Core>

#include <limits>

namespace products_test {

using namespace dsns;

namespace {

/// Entries from -4 to 4, so that all sums of fewer than a million products are exact in single precision.
template <class T>
Eigen::MatrixX<T> small_integers(Eigen::Index rows, Eigen::Index cols, unsigned seed) {
  Eigen::MatrixX<T> m(rows, cols);
  for (T& entry : m.reshaped()) {
    seed = seed * 1664525u + 1013904223u;
    entry = T(int(seed >> 24) % 9 - 4);
  }
  return m;
}

/// The sums written out.
template <class T, class A, class B>
Eigen::MatrixX<T> by_definition(const A& a, const B& b) {
  Eigen::MatrixX<T> c = Eigen::MatrixX<T>::Zero(a.rows(), b.cols());
  for (Eigen::Index j = 0; j < b.cols(); ++j)
    for (Eigen::Index i = 0; i < a.rows(); ++i)
      for (Eigen::Index k = 0; k < a.cols(); ++k) c(i, j) += a(i, k) * b(k, j);
  return c;
}

template <class T, class A, class B>
void check(const A& a, const B& b) {
  const Eigen::MatrixX<T> expected = by_definition<T>(a, b), before = small_integers<T>(a.rows(), b.cols(), 9);
  Eigen::MatrixX<T> c = Eigen::MatrixX<T>::Constant(a.rows(), b.cols(), std::numeric_limits<T>::quiet_NaN());
  set_product(c, a, b);
  CHECK(c == expected);
  c = before;
  add_product(c, a, b);
  CHECK(c == before + expected);
}

}  // namespace

TEMPLATE_TEST_CASE("products: every shape and transposition is exact in integers", "[autodiff]", float, double) {
  using T = TestType;
  const Eigen::Index m = GENERATE(1, 3, 16, 37, 64, 100), depth = GENERATE(0, 1, 5, 64, 300),
                     n = GENERATE(1, 6, 17, 64);
  const Eigen::MatrixX<T> a = small_integers<T>(m, depth, 1), b = small_integers<T>(depth, n, 2);
  const Eigen::MatrixX<T> at = a.transpose(), bt = b.transpose();
  check<T>(a, b);
  check<T>(at.transpose(), b);
  check<T>(a, bt.transpose());
  check<T>(at.transpose(), bt.transpose());
}

TEMPLATE_TEST_CASE("products: factors that are parts of larger matrices, far apart in memory", "[autodiff]", float,
                   double) {
  using T = TestType;
  const Eigen::MatrixX<T> a = small_integers<T>(700, 200, 3), b = small_integers<T>(700, 200, 4);
  check<T>(a.middleRows(5, 40), b.middleRows(11, 110).transpose());
  check<T>(a.middleRows(5, 90).transpose(), b.middleRows(11, 90));
  Eigen::MatrixX<T> large = Eigen::MatrixX<T>::Zero(60, 130);
  set_product(large.block(3, 7, 40, 110), a.middleRows(5, 40), b.middleRows(11, 110).transpose());
  CHECK(large.block(3, 7, 40, 110) == by_definition<T>(a.middleRows(5, 40), b.middleRows(11, 110).transpose()));
  large.block(3, 7, 40, 110).setZero();
  CHECK(large.isZero(0));
}

TEMPLATE_TEST_CASE("products: equal to Eigen's to rounding", "[autodiff]", float, double) {
  using T = TestType;
  std::srand(5);
  const Eigen::MatrixX<T> a = Eigen::MatrixX<T>::Random(130, 500), b = Eigen::MatrixX<T>::Random(500, 50);
  Eigen::MatrixX<T> c(130, 50);
  set_product(c, a, b);
  CHECK((c - a * b).norm() < 4 * std::numeric_limits<T>::epsilon() * c.norm());
}

}  // namespace products_test
