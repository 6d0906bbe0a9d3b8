#pragma once
/// What a differentiable scalar is: a value `f` of some inner type plus derivatives. Dual, Jet2 and Var are such
/// scalars, and nest in one another; at the bottom lies an arithmetic type, the passive scalar.
#include <limits>
#include <type_traits>
#include <utility>

/// For operators of a few instructions each, which compilers count as calls when they decide what to inline.
#if defined(__GNUC__)
#define DSNS_INLINE [[gnu::always_inline]] inline
#define DSNS_INLINE_LAMBDA __attribute__((always_inline))
#define DSNS_UNREACHABLE __builtin_unreachable()
#else
#define DSNS_INLINE inline
#define DSNS_INLINE_LAMBDA
#define DSNS_UNREACHABLE static_cast<void>(0)
#endif

namespace dsns {

/// Customisation point: true for scalars that supply
///   Inner                                            the type of the value f and of each derivative,
///   chain(x, f, d, second)                           one argument, and
///   chain(x, y, f, fx, fy, second)                   two arguments,
/// where second() returns f'' or the triple {f_xx, f_xy, f_yy} and is called only by scalars that carry second order.
template <class X>
inline constexpr bool is_differentiable = false;

template <class X>
concept Differentiable = is_differentiable<X>;

namespace detail {

template <class X>
struct passive_type {
  using type = X;
};
template <Differentiable X>
struct passive_type<X> : passive_type<typename X::Inner> {};

template <class S, class X>
struct is_passive_for : std::false_type {};
template <class S, Differentiable X>
struct is_passive_for<S, X>
    : std::bool_constant<std::is_same_v<S, typename X::Inner> || is_passive_for<S, typename X::Inner>::value> {};

template <class T>
struct Second {
  T xx, xy, yy;
};

}  // namespace detail

/// The arithmetic type at the bottom of a nest of differentiable scalars.
template <class X>
using Passive = typename detail::passive_type<X>::type;

/// S is constant with respect to X: a number, or a type that X is nested over.
template <class S, class X>
concept PassiveFor = Differentiable<X> &&(std::is_arithmetic_v<S> || detail::is_passive_for<S, X>::value);

/// The number at the bottom of x, all derivatives dropped.
template <class X>
constexpr Passive<X> value(const X& x) {
  if constexpr (Differentiable<X>) {
    return value(x.f);
  } else {
    return x;
  }
}

/// condition ? a : b; scalars over a Batch have their own, lane by lane.
template <class X>
constexpr const X& select(bool condition, const X& a, const X& b) {
  return condition ? a : b;
}

namespace detail {

/// bool, or the mask of a batch.
template <class T>
using Equality = decltype(std::declval<const T&>() == std::declval<const T&>());

constexpr bool everywhere(bool condition) { return condition; }
template <class M>
bool everywhere(const M& mask) {
  return all(mask);
}

/// The constant s in the form in which X's arithmetic takes it: numbers as X's passive type, inner scalars as they are.
template <class X, class S>
constexpr decltype(auto) constant(const S& s) {
  if constexpr (std::is_arithmetic_v<S>) {
    return static_cast<Passive<X>>(s);
  } else {
    return (s);
  }
}

}  // namespace detail
}  // namespace dsns

/// The limits of a scalar are those of the number at its bottom.
template <dsns::Differentiable X>
class std::numeric_limits<X> : public std::numeric_limits<dsns::Passive<X>> {};
