#pragma once
/// Derivatives of a generic callable in some of its arguments, numbers or Eigen matrices of them:
///
///   const auto f = [](const auto& x, double a) { return a * x.squaredNorm(); };
///   const Eigen::VectorXd g = gradient(f, wrt(x), at(x, a));
///
/// wrt names arguments by identity: the same object must stand in at. Derivatives come flat, in the order of wrt,
/// matrices column by column. The callable sees Var in place of the differentiated arguments and the rest as it is;
/// what it returns is evaluated while its arguments live, so lambdas may return `auto`.
#include <dsns/autodiff/dual.hpp>
#include <dsns/autodiff/eigen.hpp>
#include <dsns/autodiff/jet2.hpp>
#include <dsns/autodiff/tape.hpp>

#include <cstddef>
#include <tuple>
#include <utility>

namespace dsns {

template <class... X>
struct Wrt {
  std::tuple<const X&...> arguments;
};
template <class... X>
struct At {
  std::tuple<const X&...> arguments;
};

template <class... X>
Wrt<X...> wrt(const X&... x) {
  return {{x...}};
}
template <class... X>
At<X...> at(const X&... x) {
  return {{x...}};
}

template <class T>
struct ValueAndGradient {
  T value;
  Eigen::VectorX<T> gradient;
};

namespace detail {

template <class X>
struct argument {
  using Scalar = X;
  template <class V>
  using Lifted = V;
};
template <class X>
requires std::is_base_of_v<Eigen::DenseBase<X>, X>
struct argument<X> {
  using Scalar = typename X::Scalar;
  template <class V>
  using Lifted = Eigen::Matrix<V, X::RowsAtCompileTime, X::ColsAtCompileTime>;
};

template <class X, class Visit>
void for_each_entry(X& x, const Visit& visit) {
  if constexpr (requires { x.rows(); }) {
    for (Eigen::Index j = 0; j < x.cols(); ++j)
      for (Eigen::Index i = 0; i < x.rows(); ++i) visit(x(i, j));
  } else {
    visit(x);
  }
}

/// x with entries of type V, constants.
template <class V, class X>
auto lift(const X& x) {
  if constexpr (requires { x.rows(); }) {
    return typename argument<X>::template Lifted<V>(x.template cast<V>());
  } else {
    return V(x);
  }
}

/// An argument as the callable sees it: lifted where its type is that of a differentiated one, else as it is. (Identity
/// is known only at run time: an unnamed argument of such a type becomes a constant V.)
template <class V, class X, class... W>
decltype(auto) lift_if_named(const X& x, const Wrt<W...>&) {
  if constexpr ((std::is_same_v<X, W> || ...)) {
    return lift<V>(x);
  } else {
    return (x);
  }
}

template <class X>
auto evaluated(const X& y) {
  if constexpr (requires { y.eval(); }) {
    return y.eval();
  } else {
    return y;
  }
}

template <class... W>
Eigen::Index entries(const Wrt<W...>& wrt) {
  Eigen::Index n = 0;
  std::apply([&](const auto&... w) { (for_each_entry(w, [&](const auto&) { ++n; }), ...); }, wrt.arguments);
  return n;
}

/// Calls f with variables made by make_variable(value, k), k counting the entries of wrt, and hands its result on.
template <class V, class F, class... W, class... A, class Make>
auto call_lifted(const F& f, const Wrt<W...>& wrt, const At<A...>& at, const Make& make_variable) {
  std::tuple<decltype(lift_if_named<V>(std::declval<const A&>(), wrt))...> lifted = std::apply(
      [&](const auto&... a) { return std::tuple<decltype(lift_if_named<V>(a, wrt))...>(lift_if_named<V>(a, wrt)...); },
      at.arguments);
  Eigen::Index k = 0;
  const auto place = [&](const auto& w) {
    bool found = false;
    const auto try_argument = [&](const auto& a, auto& l) {
      if constexpr (!std::is_same_v<std::decay_t<decltype(a)>, std::decay_t<decltype(l)>>) {
        if (found || static_cast<const void*>(&a) != static_cast<const void*>(&w)) return;
        for_each_entry(l, [&](V& entry) { entry = make_variable(entry.f, k++); });
        found = true;
      }
    };
    [&]<std::size_t... i>(std::index_sequence<i...>) {
      (try_argument(std::get<i>(at.arguments), std::get<i>(lifted)), ...);
    }
    (std::index_sequence_for<A...>{});
    require(found, "wrt: an argument is not among those of at(...); name the same object in both");
  };
  std::apply([&](const auto&... w) { (place(w), ...); }, wrt.arguments);
  return std::apply([&](const auto&... l) { return evaluated(f(l...)); }, lifted);
}

template <class... W>
using scalar_of = typename argument<std::tuple_element_t<0, std::tuple<W...>>>::Scalar;

}  // namespace detail

namespace detail {

/// What a driver got from the callable, as the number it must be.
template <class V, class Y>
V one_number(const Y& y) {
  if constexpr (std::is_convertible_v<const Y&, V>) {
    return y;
  } else {
    static_assert(sizeof(Y) == 0, "the function returns more than one number: use jacobian, or take one of them");
  }
}
template <class Y>
constexpr bool several_numbers = requires(const Y& y) {
  y.reshaped();
};

}  // namespace detail

/// Value and gradient of a scalar function by one reverse sweep.
/// returns  value, and one derivative for each entry of wrt
/// accuracy of the elementary functions [autodiff/gradient_test]
/// throws   InvalidArgument where wrt names an object that at does not hold
template <class F, class... W, class... A>
auto value_and_gradient(const F& f, const Wrt<W...>& wrt, const At<A...>& at) {
  using T = detail::scalar_of<W...>;
  Tape<T> tape;
  const auto recording = tape.record();
  std::vector<Var<T>> variables;
  const Var<T> y = detail::one_number<Var<T>>(detail::call_lifted<Var<T>>(
      f, wrt, at, [&](const T& x, Eigen::Index) { return variables.emplace_back(tape.variable(x)); }));
  tape.backward(y);
  ValueAndGradient<T> result{y.f, Eigen::VectorX<T>(Eigen::Index(variables.size()))};
  for (std::size_t k = 0; k < variables.size(); ++k) result.gradient[Eigen::Index(k)] = tape.adjoint(variables[k]);
  return result;
}

/// The gradient alone.
template <class F, class... W, class... A>
auto gradient(const F& f, const Wrt<W...>& wrt, const At<A...>& at) {
  return value_and_gradient(f, wrt, at).gradient;
}

/// Jacobian of a function with vector result, one reverse sweep an output.
/// returns  outputs x entries of wrt
template <class F, class... W, class... A>
auto jacobian(const F& f, const Wrt<W...>& wrt, const At<A...>& at) {
  using T = detail::scalar_of<W...>;
  Tape<T> tape;
  const auto recording = tape.record();
  std::vector<Var<T>> variables;
  const auto y = detail::call_lifted<Var<T>>(
      f, wrt, at, [&](const T& x, Eigen::Index) { return variables.emplace_back(tape.variable(x)); });
  static_assert(detail::several_numbers<std::decay_t<decltype(y)>>,
                "jacobian: the function returns one number: use gradient");
  Eigen::MatrixX<T> J(y.size(), Eigen::Index(variables.size()));
  for (Eigen::Index i = 0; i < J.rows(); ++i) {
    tape.backward(Var<T>(y.reshaped()[i]));
    for (Eigen::Index k = 0; k < J.cols(); ++k) J(i, k) = tape.adjoint(variables[std::size_t(k)]);
  }
  return J;
}

/// Hessian of a scalar function, forward over reverse: one sweep a column.
/// returns  symmetric matrix over the entries of wrt
template <class F, class... W, class... A>
auto hessian(const F& f, const Wrt<W...>& wrt, const At<A...>& at) {
  using T = detail::scalar_of<W...>;
  using D = Dual<T, 1>;
  const Eigen::Index n = detail::entries(wrt);
  Eigen::MatrixX<T> H(n, n);
  Tape<D> tape;
  for (Eigen::Index j = 0; j < n; ++j) {
    const auto recording = tape.record();
    std::vector<Var<D>> variables;
    const Var<D> y =
        detail::one_number<Var<D>>(detail::call_lifted<Var<D>>(f, wrt, at, [&](const D& x, Eigen::Index k) {
          return variables.emplace_back(tape.variable(D(x.f, {T(k == j ? 1 : 0)})));
        }));
    tape.backward(y);
    for (Eigen::Index i = 0; i < n; ++i) H(i, j) = tape.adjoint(variables[std::size_t(i)]).g[0];
  }
  return H;
}

template <class T>
struct ValueAndDerivative {
  T value;
  T derivative;
};

/// The derivative along one direction, by one forward pass: the product of the Jacobian and `direction`.
/// direction  one number for each entry of wrt
/// returns    {f, J direction}, shaped as the result of f is
/// throws     InvalidArgument for a direction of another size
template <class F, class... W, class... A, class Direction>
auto jvp(const F& f, const Wrt<W...>& wrt, const At<A...>& at, const Eigen::MatrixBase<Direction>& direction) {
  using T = detail::scalar_of<W...>;
  using D = Dual<T, 1>;
  require(direction.size() == detail::entries(wrt), "jvp: a direction of ", direction.size(), " entries for ",
          detail::entries(wrt), " variables");
  const auto y = detail::call_lifted<D>(f, wrt, at, [&](const T& x, Eigen::Index k) { return D(x, {direction(k)}); });
  if constexpr (requires { y.rows(); }) {
    using M = Eigen::MatrixX<T>;
    return ValueAndDerivative<M>{M(y.unaryExpr([](const D& d) { return d.f; })),
                                 M(y.unaryExpr([](const D& d) { return T(d.g[0]); }))};
  } else {
    return ValueAndDerivative<T>{y.f, T(y.g[0])};
  }
}

/// The gradient of a weighted sum of results, by one backward sweep: the product of `weights` and the Jacobian.
/// weights  one number for each entry of the result
/// returns  one number for each entry of wrt
/// throws   InvalidArgument for weights of another size
template <class F, class... W, class... A, class Weights>
auto vjp(const F& f, const Wrt<W...>& wrt, const At<A...>& at, const Eigen::MatrixBase<Weights>& weights) {
  return gradient(
      [&](const auto&... x) {
        const auto y = detail::evaluated(f(x...));
        require(y.size() == weights.size(), "vjp: ", weights.size(), " weights for a result of ", y.size(), " entries");
        auto sum = y(0) * weights(0);
        for (Eigen::Index k = 1; k < y.size(); ++k) sum += y.reshaped()(k) * weights(k);
        return sum;
      },
      wrt, at);
}

/// The Hessian of a scalar function times a direction, forward over reverse: the cost of a few gradients.
/// throws   InvalidArgument for a direction of another size
template <class F, class... W, class... A, class Direction>
auto hvp(const F& f, const Wrt<W...>& wrt, const At<A...>& at, const Eigen::MatrixBase<Direction>& direction) {
  using T = detail::scalar_of<W...>;
  using D = Dual<T, 1>;
  require(direction.size() == detail::entries(wrt), "hvp: a direction of ", direction.size(), " entries for ",
          detail::entries(wrt), " variables");
  Tape<D> tape;
  const auto recording = tape.record();
  std::vector<Var<D>> variables;
  const Var<D> y = detail::one_number<Var<D>>(detail::call_lifted<Var<D>>(f, wrt, at, [&](const D& x, Eigen::Index k) {
    return variables.emplace_back(tape.variable(D(x.f, {direction(k)})));
  }));
  tape.backward(y);
  Eigen::VectorX<T> product{Eigen::Index(variables.size())};
  for (std::size_t k = 0; k < variables.size(); ++k) product[Eigen::Index(k)] = tape.adjoint(variables[k]).g[0];
  return product;
}

/// The 2-jet of a function of two numbers: value, gradient and Hessian, by one forward pass.
template <class F, class T>
auto jet2(const F& f, const T& u, const T& v) {
  return f(Jet2<T, 2>::variable(u, 0), Jet2<T, 2>::variable(v, 1));
}

}  // namespace dsns
