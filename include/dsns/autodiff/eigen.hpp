#pragma once
/// Eigen matrices of differentiable scalars, mixed freely with their passive scalars at every level of nesting.
/// Products, sums, norms and element-wise functions differentiate; Eigen's decompositions do not (they branch on values
/// and drop zero entries that carry derivatives): use those of autodiff/linear_algebra.hpp. Where Eigen refuses the product of a
/// passive and a differentiable matrix of dynamic sizes, cast the passive one: m.cast<X>().
#include <dsns/autodiff/dual.hpp>
#include <dsns/autodiff/jet2.hpp>

#include <Eigen/Core>

namespace dsns::detail {

template <class X>
struct DifferentiableTraits : Eigen::NumTraits<typename X::Inner> {
  using Real = X;
  using NonInteger = X;
  using Nested = X;
  using Literal = typename Eigen::NumTraits<typename X::Inner>::Literal;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = !std::is_trivially_default_constructible_v<X>,
    ReadCost = int(sizeof(X) / sizeof(Passive<X>)),
    AddCost = ReadCost,
    MulCost = 3 * ReadCost
  };
};

}  // namespace dsns::detail

namespace Eigen {

template <dsns::Differentiable X>
struct NumTraits<X> : dsns::detail::DifferentiableTraits<X> {};

template <dsns::Differentiable X, dsns::PassiveFor<X> S, class Op>
struct ScalarBinaryOpTraits<X, S, Op> {
  using ReturnType = X;
};
template <dsns::Differentiable X, dsns::PassiveFor<X> S, class Op>
struct ScalarBinaryOpTraits<S, X, Op> {
  using ReturnType = X;
};

}  // namespace Eigen
