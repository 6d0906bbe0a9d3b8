#pragma once
/// Small dense linear algebra whose results differentiate: the numbers at the bottom go through Eigen's decompositions, and
/// the derivatives follow from the equations that the results satisfy. For matrices of every differentiable scalar.
///
///   const Eigen::Matrix2<D> A = ...;                      // D = Dual<double, 2>, Jet2<double>, Var<double>, ...
///   const auto x = solve(A, b);                           // A x = b
///   const auto e = symmetric_eigen(A);                    // e.values, e.vectors
///
/// accuracy   of Eigen's PartialPivLU and SelfAdjointEigenSolver, times the condition of the problem
///            [autodiff/linear_algebra_test]
/// source     Giles 2008, Collected matrix derivative results for forward and reverse mode algorithmic differentiation
#include <dsns/autodiff/dual.hpp>
#include <dsns/autodiff/eigen.hpp>
#include <dsns/autodiff/jet2.hpp>
#include <dsns/autodiff/tape.hpp>
#include <dsns/core/errors.hpp>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <algorithm>
#include <limits>
#include <span>
#include <vector>

namespace dsns {

namespace detail {

/// part(entry) of every entry of m.
template <class M, class Part>
auto parts(const M& m, const Part& part) {
  using T = std::decay_t<decltype(part(m(0, 0)))>;
  Eigen::MatrixX<T> r(m.rows(), m.cols());
  for (Eigen::Index j = 0; j < m.cols(); ++j)
    for (Eigen::Index i = 0; i < m.rows(); ++i) r(i, j) = part(m(i, j));
  return r;
}
template <class M>
auto values_of(const M& m) {
  return parts(m, [](const auto& x) { return x.f; });
}

/// A x = b for any b, with A's numbers factored once.
template <class X>
class ImplicitLu;

template <std::floating_point T>
class ImplicitLu<T> {
 public:
  explicit ImplicitLu(const Eigen::MatrixX<T>& a) : lu_(a) {
    require(a.rows() == a.cols(), "solve: a matrix of ", a.rows(), " x ", a.cols(), " is not square");
  }
  Eigen::MatrixX<T> solve(const Eigen::MatrixX<T>& b) const { return lu_.solve(b); }

 private:
  Eigen::PartialPivLU<Eigen::MatrixX<T>> lu_;
};

// From A x = b: A x' = b' - A' x.
template <class T, int N>
class ImplicitLu<Dual<T, N>> {
 public:
  using X = Dual<T, N>;
  explicit ImplicitLu(const Eigen::MatrixX<X>& a) : a_(a), lu_(values_of(a)) {}
  Eigen::MatrixX<X> solve(const Eigen::MatrixX<X>& b) const {
    const Eigen::MatrixX<T> x = lu_.solve(values_of(b));
    Eigen::MatrixX<X> r = x.template cast<X>();
    for (std::size_t k = 0; k < N; ++k) {
      const auto part = [k](const X& e) { return T(e.g[k]); };
      const Eigen::MatrixX<T> xk = lu_.solve(Eigen::MatrixX<T>(parts(b, part) - parts(a_, part) * x));
      for (Eigen::Index e = 0; e < r.size(); ++e) r.reshaped()[e].g[k] = xk.reshaped()[e];
    }
    return r;
  }

 private:
  Eigen::MatrixX<X> a_;
  ImplicitLu<T> lu_;
};

// And A x'' = b'' - A'' x - 2 A' x'.
template <class T, int N>
class ImplicitLu<Jet2<T, N>> {
 public:
  using X = Jet2<T, N>;
  explicit ImplicitLu(const Eigen::MatrixX<X>& a) : a_(a), lu_(values_of(a)) {}
  Eigen::MatrixX<X> solve(const Eigen::MatrixX<X>& b) const {
    using M = Eigen::MatrixX<T>;
    const M x = lu_.solve(values_of(b));
    Eigen::MatrixX<X> r = x.template cast<X>();
    std::vector<M> a1, x1;
    for (std::size_t k = 0; k < N; ++k) {
      const auto part = [k](const X& e) { return T(e.g[k]); };
      a1.push_back(parts(a_, part));
      x1.push_back(lu_.solve(M(parts(b, part) - a1[k] * x)));
      for (Eigen::Index e = 0; e < r.size(); ++e) r.reshaped()[e].g[k] = x1[k].reshaped()[e];
    }
    for (std::size_t i = 0, m = 0; i < N; ++i)
      for (std::size_t j = i; j < N; ++j, ++m) {
        const auto part = [m](const X& e) { return T(e.h[m]); };
        const M x2 = lu_.solve(M(parts(b, part) - parts(a_, part) * x - a1[i] * x1[j] - a1[j] * x1[i]));
        for (Eigen::Index e = 0; e < r.size(); ++e) r.reshaped()[e].h[m] = x2.reshaped()[e];
      }
    return r;
  }

 private:
  Eigen::MatrixX<X> a_;
  ImplicitLu<T> lu_;
};

/// Matrices of variables, one after the other, as operands of a function on the tape.
template <class T, class... M>
std::vector<Var<T>> operands(const M&... m) {
  std::vector<Var<T>> v;
  (v.insert(v.end(), m.reshaped().begin(), m.reshaped().end()), ...);
  return v;
}

// Backward: what comes to b is A^-T what came to x, and to A minus that times x^T.
template <class T>
class ImplicitLu<Var<T>> {
 public:
  using X = Var<T>;
  explicit ImplicitLu(const Eigen::MatrixX<X>& a) : a_(a), lu_(values_of(a)) {}
  Eigen::MatrixX<X> solve(const Eigen::MatrixX<X>& b) const {
    using M = Eigen::MatrixX<T>;
    const M x = lu_.solve(values_of(b));
    const auto pullback = [x, transposed = ImplicitLu<T>(M(values_of(a_).transpose()))](std::span<const T> results,
                                                                                        std::span<T> out) {
      const M back = transposed.solve(Eigen::Map<const M>(results.data(), x.rows(), x.cols()));
      Eigen::Map<M>(out.data(), x.rows(), x.rows()) -= back * x.transpose();
      Eigen::Map<M>(out.data() + x.rows() * x.rows(), x.rows(), x.cols()) += back;
    };
    const std::vector<X> all = operands<T>(a_, b);
    const std::vector<X> r =
        Tape<T>::function(std::span<const X>(all), std::span<const T>(x.data(), std::size_t(x.size())), pullback);
    return Eigen::Map<const Eigen::MatrixX<X>>(r.data(), x.rows(), x.cols());
  }

 private:
  Eigen::MatrixX<X> a_;
  ImplicitLu<T> lu_;
};

}  // namespace detail

/// The solution of A x = b, for one or more columns b.
/// throws   InvalidArgument where the sizes do not fit; a singular A gives values that are not finite, as in Eigen
template <class A, class B>
auto solve(const Eigen::MatrixBase<A>& a, const Eigen::MatrixBase<B>& b) {
  using X = typename A::Scalar;
  static_assert(std::is_same_v<X, typename B::Scalar>,
                "solve: matrix and right-hand side have different scalars; cast the constant one: b.cast<X>()");
  require(a.rows() == a.cols() && a.cols() == b.rows(), "solve: a matrix of ", a.rows(), " x ", a.cols(),
          " and a right-hand side of ", b.rows(), " rows");
  using Result = Eigen::Matrix<X, A::ColsAtCompileTime, B::ColsAtCompileTime>;
  return Result(detail::ImplicitLu<X>(Eigen::MatrixX<X>(a)).solve(Eigen::MatrixX<X>(b)));
}

/// A^-1
template <class A>
auto inverse(const Eigen::MatrixBase<A>& a) {
  using X = typename A::Scalar;
  using Result = Eigen::Matrix<X, A::RowsAtCompileTime, A::ColsAtCompileTime>;
  return Result(solve(a, Eigen::MatrixX<X>(Eigen::MatrixX<X>::Identity(a.rows(), a.cols()))));
}

/// The Euclidean norm, without overflow; at zero its derivatives are 0.
template <class V>
auto norm(const Eigen::MatrixBase<V>& v) {
  using X = typename V::Scalar;
  using std::sqrt;
  using P = Passive<X>;
  P largest(0);
  for (Eigen::Index k = 0; k < v.size(); ++k) largest = std::max(largest, std::abs(value(v.derived().reshaped()[k])));
  if (!(largest > 0) || largest > std::numeric_limits<P>::max()) return X(largest);
  X sum(0);
  for (Eigen::Index k = 0; k < v.size(); ++k) {
    const X x = v.derived().reshaped()[k] / largest;
    sum += x * x;
  }
  return X(sqrt(sum) * largest);
}

template <class X>
struct SymmetricEigen {
  Eigen::VectorX<X> values;   ///< ascending
  Eigen::MatrixX<X> vectors;  ///< columns, of norm 1
};

namespace detail {

/// 1 / (lambda_k - lambda_j), and 0 where these are equal but for rounding: there the eigenvectors have no derivative.
template <class T>
Eigen::MatrixX<T> inverse_gaps(const Eigen::VectorX<T>& lambda) {
  const Eigen::Index n = lambda.size();
  using P = Passive<T>;
  P largest(0);
  for (Eigen::Index k = 0; k < n; ++k) largest = std::max(largest, std::abs(value(lambda[k])));
  const P least = P(64) * std::numeric_limits<P>::epsilon() * largest;
  Eigen::MatrixX<T> gaps = Eigen::MatrixX<T>::Constant(n, n, T(0));
  for (Eigen::Index k = 0; k < n; ++k)
    for (Eigen::Index j = 0; j < n; ++j)
      if (std::abs(value(lambda[k]) - value(lambda[j])) > least) gaps(j, k) = 1 / (lambda[k] - lambda[j]);
  return gaps;
}

template <class X>
struct ImplicitEigen;

template <std::floating_point T>
struct ImplicitEigen<T> {
  static SymmetricEigen<T> of(const Eigen::MatrixX<T>& a) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixX<T>> e(a);
    return {e.eigenvalues(), e.eigenvectors()};
  }
};

template <class T, int N>
struct ImplicitEigen<Dual<T, N>> {
  using X = Dual<T, N>;
  static SymmetricEigen<X> of(const Eigen::MatrixX<X>& a) {
    const SymmetricEigen<T> e = ImplicitEigen<T>::of(values_of(a));
    const Eigen::MatrixX<T> gaps = inverse_gaps<T>(e.values);
    SymmetricEigen<X> r{e.values.template cast<X>(), e.vectors.template cast<X>()};
    for (std::size_t k = 0; k < N; ++k) {
      const Eigen::MatrixX<T> m = e.vectors.transpose() * parts(a, [k](const X& x) { return T(x.g[k]); }) * e.vectors;
      const Eigen::MatrixX<T> v = e.vectors * gaps.cwiseProduct(m);
      for (Eigen::Index i = 0; i < r.values.size(); ++i) r.values[i].g[k] = m(i, i);
      for (Eigen::Index i = 0; i < v.size(); ++i) r.vectors.reshaped()[i].g[k] = v.reshaped()[i];
    }
    return r;
  }
};

// The second order is the first order of the first.
template <class T, int N>
struct ImplicitEigen<Jet2<T, N>> {
  using X = Jet2<T, N>;
  static SymmetricEigen<X> of(const Eigen::MatrixX<X>& a) {
    using D = Dual<Dual<T, N>, N>;
    const auto nested = ImplicitEigen<D>::of(parts(a, [](const X& x) {
      D d(Dual<T, N>(x.f, x.g));
      for (std::size_t i = 0; i < N; ++i) {
        d.g[i].f = x.g[i];
        for (std::size_t j = 0; j < N; ++j) d.g[i].g[j] = x.hessian(int(i), int(j));
      }
      return d;
    }));
    const auto back = [](const D& d) {
      X x(d.f.f);
      for (std::size_t i = 0, m = 0; i < N; ++i) {
        x.g[i] = d.g[i].f;
        for (std::size_t j = i; j < N; ++j, ++m) x.h[m] = d.g[i].g[j];
      }
      return x;
    };
    return {parts(nested.values, back), parts(nested.vectors, back)};
  }
};

template <class T>
struct ImplicitEigen<Var<T>> {
  using X = Var<T>;
  static SymmetricEigen<X> of(const Eigen::MatrixX<X>& a) {
    using M = Eigen::MatrixX<T>;
    const SymmetricEigen<T> e = ImplicitEigen<T>::of(values_of(a));
    const Eigen::Index n = a.rows();
    std::vector<T> results(e.values.begin(), e.values.end());
    results.insert(results.end(), e.vectors.reshaped().begin(), e.vectors.reshaped().end());
    const auto pullback = [e, n, gaps = inverse_gaps<T>(e.values)](std::span<const T> back, std::span<T> out) {
      const Eigen::Map<const M> vectors(back.data() + n, n, n);
      M inner = gaps.cwiseProduct(M(e.vectors.transpose() * vectors));
      for (Eigen::Index k = 0; k < n; ++k) inner(k, k) += back[std::size_t(k)];
      const M full = e.vectors * inner * e.vectors.transpose();
      Eigen::Map<M>(out.data(), n, n) += T(0.5) * (full + full.transpose());
    };
    const std::vector<X> all = operands<T>(a);
    const std::vector<X> r = Tape<T>::function(std::span<const X>(all), std::span<const T>(results), pullback);
    return {Eigen::Map<const Eigen::VectorX<X>>(r.data(), n), Eigen::Map<const Eigen::MatrixX<X>>(r.data() + n, n, n)};
  }
};

}  // namespace detail

/// Eigenvalues and eigenvectors of a symmetric matrix. Where eigenvalues are equal, each has the derivative of its place in
/// the basis that was found, and the eigenvectors have none between them (0): take a function of the matrix that does not
/// depend on the basis, or the trace and the determinant.
/// throws   InvalidArgument for a matrix that is not square
template <class A>
SymmetricEigen<typename A::Scalar> symmetric_eigen(const Eigen::MatrixBase<A>& a) {
  using X = typename A::Scalar;
  require(a.rows() == a.cols(), "symmetric_eigen: a matrix of ", a.rows(), " x ", a.cols(), " is not square");
  return detail::ImplicitEigen<X>::of(Eigen::MatrixX<X>(a));
}

}  // namespace dsns
