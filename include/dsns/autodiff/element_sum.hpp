#pragma once
/// Value, gradient and sparse Hessian of a sum of small functions, each of few of the variables: energies of meshes and
/// time series.
///
///   const ElementSum<2> springs(n, edges);                       // pairs of variables
///   const auto e = springs.second_order([](const auto& x) { return sqr(x[1] - x[0] - 1); }, positions);
///   solver.compute(e.hessian);                                   // Eigen::SparseMatrix
#include <dsns/autodiff/jet2.hpp>
#include <dsns/core/errors.hpp>

#include <Eigen/SparseCore>

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace dsns {

template <class T>
struct SecondOrderSum {
  T value;
  Eigen::VectorX<T> gradient;
  Eigen::SparseMatrix<T> hessian;  ///< symmetric, both triangles
};

/// Where the elements of a sum act; the pattern of the Hessian is found once.
template <int N, class T = double>
class ElementSum {
 public:
  using Element = std::array<int, std::size_t(N)>;

  /// variables  how many there are
  /// elements   each the places of N of them, none twice
  /// throws     InvalidArgument for a place out of range or twice in an element
  ElementSum(Eigen::Index variables, std::vector<Element> elements) : elements_(std::move(elements)), pattern_{} {
    std::vector<Eigen::Triplet<T>> entries;
    entries.reserve(elements_.size() * std::size_t(N * N));
    for (std::size_t e = 0; e < elements_.size(); ++e) {
      for (std::size_t i = 0; i < std::size_t(N); ++i) {
        const int p = elements_[e][i];
        require(p >= 0 && p < variables, "ElementSum: element ", e, " names variable ", p, " of ", variables);
        require(std::find(elements_[e].begin(), elements_[e].begin() + std::ptrdiff_t(i), p) ==
                    elements_[e].begin() + std::ptrdiff_t(i),
                "ElementSum: element ", e, " names variable ", p, " twice; use it twice in the function instead");
        for (const int q : elements_[e]) entries.emplace_back(p, q, T(0));
      }
    }
    pattern_.resize(variables, variables);
    pattern_.setFromTriplets(entries.begin(), entries.end());
    pattern_.makeCompressed();
    slots_.reserve(elements_.size() * std::size_t(N * (N + 1) / 2));
    for (const Element& e : elements_)
      for (std::size_t i = 0; i < std::size_t(N); ++i)
        for (std::size_t j = i; j < std::size_t(N); ++j) slots_.push_back({slot(e[i], e[j]), slot(e[j], e[i])});
  }

  /// f takes an array of N differentiable scalars and returns one.
  template <class F>
  SecondOrderSum<T> second_order(const F& f, const Eigen::VectorX<T>& x) const {
    SecondOrderSum<T> r{T(0), {}, pattern_};
    second_order(f, x, r);
    return r;
  }
  /// The same into the memory of an earlier result of this sum.
  template <class F>
  void second_order(const F& f, const Eigen::VectorX<T>& x, SecondOrderSum<T>& r) const {
    require(x.size() == pattern_.cols(), "ElementSum: ", x.size(), " values for ", pattern_.cols(), " variables");
    require(r.hessian.nonZeros() == pattern_.nonZeros() && r.hessian.cols() == pattern_.cols(),
            "ElementSum: the result to write to is not one of this sum");
    r.value = T(0);
    r.gradient.setZero(x.size());
    T* const h = r.hessian.valuePtr();
    std::fill(h, h + r.hessian.nonZeros(), T(0));
    const Slot* s = slots_.data();
    for (const Element& e : elements_) {
      std::array<Jet2<T, N>, std::size_t(N)> local;
      for (std::size_t i = 0; i < std::size_t(N); ++i) local[i] = Jet2<T, N>::variable(x[e[i]], int(i));
      const Jet2<T, N> y = f(local);
      r.value += y.f;
      std::size_t m = 0;
      for (std::size_t i = 0; i < std::size_t(N); ++i) {
        r.gradient[e[i]] += y.g[i];
        for (std::size_t j = i; j < std::size_t(N); ++j, ++m, ++s) {
          h[s->upper] += y.h[m];
          if (i != j) h[s->lower] += y.h[m];
        }
      }
    }
  }

 private:
  struct Slot {
    int upper, lower;
  };
  int slot(int row, int col) const {
    const int* const begin = pattern_.innerIndexPtr() + pattern_.outerIndexPtr()[col];
    const int* const end = pattern_.innerIndexPtr() + pattern_.outerIndexPtr()[col + 1];
    return int(std::lower_bound(begin, end, row) - pattern_.innerIndexPtr());
  }

  std::vector<Element> elements_;
  std::vector<Slot> slots_;  // in the values of the matrix, element by element
  Eigen::SparseMatrix<T> pattern_;
};

}  // namespace dsns
