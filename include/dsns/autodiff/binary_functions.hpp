#pragma once
/// Functions of several differentiable scalars, or of some and constants: min, max, fmin, fmax, fdim, hypot, atan2, pow,
/// fmod, remainder, copysign, fma.
///
/// Where there is no derivative: those of hypot and atan2 are 0 at (0, 0); min and max take their first argument in a
/// tie, as in the standard library; pow(0, 0) = 1 with derivative 0 in both arguments; pow(x < 0, y) has derivative NaN
/// in a y that is not constant. At infinity: the limit where there is one [docs/autodiff.md].
/// accuracy a few ulp of closed forms, second derivatives and nested scalars included [autodiff/functions_test]
#include <dsns/autodiff/scalar.hpp>

#include <cmath>
#include <limits>
#include <type_traits>

namespace dsns {

namespace detail {

/// Whether x is a constant: every derivative of it, at every level, is zero.
template <class X>
bool inert(const X& x) {
  if constexpr (Differentiable<X>) {
    return derivatives_vanish(x);
  } else {
    return true;
  }
}

/// a b, which is 0 for b = 0 also where a is not finite: a direction in which an argument stands still.
template <class T>
T times(const T& a, const T& b) {
  if (!inert(b)) return a * b;
  return select(value(b) == 0, T(0), T(a * b));
}

/// Whether x, or every lane of it, is a number.
template <class X>
bool finite(const X& x) {
  return everywhere(value(x) - value(x) == 0);
}

/// chain for functions whose derivatives may be infinite or undefined.
template <class X, class T, class Second>
DSNS_INLINE X singular_chain(const X& x, const T& w, const T& d, const Second& second) {
  if constexpr (requires { careful_chain(x, w, d, second); }) {
    if (!finite(d)) [[unlikely]]
      return careful_chain(x, w, d, second);
  }
  return chain(x, w, d, second);
}
template <class X, class T, class Second>
DSNS_INLINE X singular_chain(const X& x, const X& y, const T& w, const T& wx, const T& wy, const Second& second) {
  if constexpr (requires { careful_chain(x, y, w, wx, wy, second); }) {
    if (!finite(wx) || !finite(wy) || !everywhere(!(value(x) == 0))) [[unlikely]]
      return careful_chain(x, y, w, wx, wy, second);
  }
  return chain(x, y, w, wx, wy, second);
}

/// Where a number, or a lane, is infinite.
template <class P>
auto infinite(const P& x) {
  constexpr auto infinity = std::numeric_limits<P>::infinity();
  return x == infinity || x == -infinity;
}

template <class T>
struct Direction {
  T c, s;
};
/// What direction() makes of x beside y at infinity, or where the length overflows.
template <class T>
T reduced(const T& x, const T& y) {
  return select(infinite(value(x)), select(value(x) > 0, T(1), T(-1)),
                select(infinite(value(y)), T(0 * value(x)), T(x / 4)));
}
/// x / r and y / r, r = hypot(x, y): 0 for r = 0; a component that is infinite beats one that is not.
template <class T>
Direction<T> direction(const T& x, const T& y, const T& r) {
  using std::hypot;
  if (!finite(r)) [[unlikely]] {
    const T a = reduced(x, y), b = reduced(y, x);
    const T length = hypot(a, b);
    const auto zero = value(length) == 0;
    const T d = select(zero, T(1), length);
    return {T(a / d), T(b / d)};
  }
  const auto zero = value(r) == 0;
  const T d = select(zero, T(1), r);
  return {select(zero, T(0), T(x / d)), select(zero, T(0), T(y / d))};
}

template <class T, class P>
T power(const T& x, const P& p) {
  using std::pow;
  return pow(x, p);
}

/// Whether x^y is 0 and so are its derivatives, whatever their factors: the exponent is infinite, or a positive base is.
template <class T, class P>
auto power_vanishes(const T& x, const P& y) {
  using std::abs;
  const auto b = abs(value(x));
  const auto e = value(y);
  constexpr auto infinity = std::numeric_limits<std::remove_const_t<decltype(e)>>::infinity();
  return (e == infinity && b < 1) || (e == -infinity && b > 1);
}

/// log x, by which the derivative of x^y in y exceeds x^y; 0 where the derivative is 0 and the logarithm infinite.
template <class T, class P>
T power_logarithm(const T& x, const P& y) {
  using std::log;
  const auto b = value(x);
  constexpr auto infinity = std::numeric_limits<std::remove_const_t<decltype(b)>>::infinity();
  const auto flat = (b == 0 && value(y) >= 0) || (b == infinity && value(y) < 0);
  return select(flat, T(0), T(log(x)));
}

/// p x^(p - 1), which is 0 for p = 0 also where x = 0 or no number.
template <class T, class P>
T power_derivative(const T& x, const P& p) {
  const auto flat = value(p) == 0 && !(value(x) < 0) && !(value(x) > 0);
  return select(flat || power_vanishes(x, p), T(0), T(p * power(x, P(p - 1))));
}

/// p (p - 1) x^(p - 2), which is 0 for p = 0 and p = 1 also at x = 0.
template <class T, class P>
T power_second(const T& x, const P& p) {
  const auto flat = (value(p) == 0 || value(p) == 1) && !(value(x) < 0) && !(value(x) > 0);
  return select(flat || power_vanishes(x, p), T(0), T(p * (p - 1) * power(x, P(p - 2))));
}

}  // namespace detail

template <Differentiable X>
X min(const X& x, const X& y) {
  return select(y < x, y, x);
}
template <Differentiable X>
X max(const X& x, const X& y) {
  return select(x < y, y, x);
}
template <Differentiable X, PassiveFor<X> S>
X min(const X& x, const S& s) {
  return select(s < x, X(s), x);
}
template <Differentiable X, PassiveFor<X> S>
X min(const S& s, const X& x) {
  return select(x < s, x, X(s));
}
template <Differentiable X, PassiveFor<X> S>
X max(const X& x, const S& s) {
  return select(x < s, X(s), x);
}
template <Differentiable X, PassiveFor<X> S>
X max(const S& s, const X& x) {
  return select(s < x, x, X(s));
}

/// As min and max, but a number rather than NaN.
template <Differentiable X>
X fmin(const X& x, const X& y) {
  return select(y < x || !(x == x), y, x);
}
template <Differentiable X>
X fmax(const X& x, const X& y) {
  return select(x < y || !(x == x), y, x);
}
/// max(x - y, 0)
template <Differentiable X>
X fdim(const X& x, const X& y) {
  return select(x <= y, X(0), X(x - y));
}

template <Differentiable X>
X hypot(const X& x, const X& y) {
  using std::hypot;
  using T = typename X::Inner;
  const T r = hypot(x.f, y.f);
  const auto [c, s] = detail::direction(x.f, y.f, r);
  const T d = select(value(r) == 0, T(1), r);
  return detail::singular_chain(x, y, r, c, s, [&c = c, &s = s, &d] {
    return detail::Second<T>{T(s * s / d), T(-c * s / d), T(c * c / d)};
  });
}

template <Differentiable X>
X atan2(const X& y, const X& x) {
  using std::atan2, std::hypot;
  using T = typename X::Inner;
  const T r = hypot(x.f, y.f);
  const auto [c, s] = detail::direction(x.f, y.f, r);
  const T d = select(value(r) == 0, T(1), r);
  return detail::singular_chain(y, x, T(atan2(y.f, x.f)), T(c / d), T(-s / d), [&c = c, &s = s, &d] {
    const T mixed = 2 * c * s / (d * d);
    return detail::Second<T>{T(-mixed), T((s * s - c * c) / (d * d)), mixed};
  });
}

/// The length of (x, y, z), without overflow.
template <Differentiable X>
X hypot(const X& x, const X& y, const X& z) {
  using std::abs;
  using P = Passive<X>;
  const P a = abs(value(x)), b = abs(value(y)), c = abs(value(z));
  const P ab = select(a < b, b, a);
  const P largest = select(ab < c, c, ab);
  const auto zero = largest == 0;
  const auto usual = !detail::infinite(largest);
  const P scale = select(zero || !usual, P(1), largest);
  const X squares = sqr(X(x / scale)) + sqr(X(y / scale)) + sqr(X(z / scale));
  const X length = select(zero, X(P(0)), X(scale * sqrt(X(squares + select(zero, P(1), P(0))))));
  if (detail::everywhere(usual)) [[likely]]
    return length;
  return select(usual, length, hypot(X(hypot(x, y)), z));
}

template <Differentiable X, PassiveFor<X> P>
X pow(const X& x, const P& p) {
  using T = typename X::Inner;
  const auto& q = detail::constant<X>(p);
  return detail::singular_chain(x, T(detail::power(x.f, q)), T(detail::power_derivative(x.f, q)),
                                [&]() -> T { return detail::power_second(x.f, q); });
}

template <Differentiable X, PassiveFor<X> P>
X pow(const P& base, const X& y) {
  using T = typename X::Inner;
  const T b = detail::constant<X>(base);
  const T f = detail::power(b, y.f);
  const T l = detail::power_logarithm(b, y.f);
  return detail::singular_chain(y, f, T(f * l), [&]() -> T { return f * l * l; });
}

template <Differentiable X>
X pow(const X& x, const X& y) {
  using std::log;
  using T = typename X::Inner;
  if (detail::inert(y)) return pow(x, y.f);
  const T f = detail::power(x.f, y.f);
  const T l = detail::power_logarithm(x.f, y.f);
  return detail::singular_chain(x, y, f, detail::power_derivative(x.f, y.f), T(f * l), [&] {
    const auto flat = (value(x) == 0 && value(y) > 1) || (value(x) > 0 && detail::infinite(value(x)) && value(y) < 1) ||
                      detail::power_vanishes(x.f, y.f);
    const T mixed = select(flat, T(0), T(detail::power(x.f, T(y.f - 1)) * (1 + y.f * T(log(x.f)))));
    return detail::Second<T>{detail::power_second(x.f, y.f), mixed, f * l * l};
  });
}

/// The sign of y on x. At x = 0 the derivative is 0, as that of abs.
template <Differentiable X>
X copysign(const X& x, const X& y) {
  using std::copysign;
  using P = Passive<X>;
  const P sign = copysign(P(1), value(x)) * copysign(P(1), value(y));
  return x * select(value(x) == 0, P(0) * sign, sign);
}

namespace detail {

/// x - q y for the integer q that gives the remainder r.
template <class X, class T>
X remainder_chain(const X& x, const X& y, const T& r) {
  using std::round;
  const auto q = round((value(x) - value(r)) / value(y));
  return chain(x, y, r, T(1), T(-q), [] { return Second<T>{T(0), T(0), T(0)}; });
}

}  // namespace detail

/// x - q y, q = x / y rounded towards zero; at a jump the derivative of x - q y.
template <Differentiable X>
X fmod(const X& x, const X& y) {
  using std::fmod;
  return detail::remainder_chain(x, y, typename X::Inner(fmod(x.f, y.f)));
}
/// x - q y, q = x / y rounded to the nearest integer.
template <Differentiable X>
X remainder(const X& x, const X& y) {
  using std::remainder;
  return detail::remainder_chain(x, y, typename X::Inner(remainder(x.f, y.f)));
}

/// x y + z, rounded once.
template <Differentiable X>
X fma(const X& x, const X& y, const X& z) {
  using std::fma;
  using T = typename X::Inner;
  const T w = fma(x.f, y.f, z.f);
  const X product = chain(x, y, w, y.f, x.f, [] { return detail::Second<T>{T(0), T(1), T(0)}; });
  return chain(product, z, w, T(1), T(1), [] { return detail::Second<T>{T(0), T(0), T(0)}; });
}

#define DSNS_BESIDE_A_CONSTANT(name)           \
  template <Differentiable X, PassiveFor<X> S> \
  X name(const X& x, const S& s) {             \
    return name(x, X(s));                      \
  }                                            \
  template <Differentiable X, PassiveFor<X> S> \
  X name(const S& s, const X& x) {             \
    return name(X(s), x);                      \
  }
DSNS_BESIDE_A_CONSTANT(fmin)
DSNS_BESIDE_A_CONSTANT(fmax)
DSNS_BESIDE_A_CONSTANT(fdim)
DSNS_BESIDE_A_CONSTANT(hypot)
DSNS_BESIDE_A_CONSTANT(atan2)
DSNS_BESIDE_A_CONSTANT(copysign)
DSNS_BESIDE_A_CONSTANT(fmod)
DSNS_BESIDE_A_CONSTANT(remainder)
#undef DSNS_BESIDE_A_CONSTANT

namespace detail {

template <class X, class S>
concept Beside = std::is_same_v<S, X> || PassiveFor<S, X>;

/// The one for which the others are constants, or its like.
template <class A, class B, class C>
struct outermost {};
template <Differentiable A, class B, class C>
requires(Beside<A, B>&& Beside<A, C>) struct outermost<A, B, C> {
  using type = A;
};
template <class A, Differentiable B, class C>
requires(Beside<B, A>&& Beside<B, C> && !Beside<A, B>) struct outermost<A, B, C> {
  using type = B;
};
template <class A, class B, Differentiable C>
requires(Beside<C, A>&& Beside<C, B> && !Beside<A, C> && !Beside<B, C>) struct outermost<A, B, C> {
  using type = C;
};

}  // namespace detail

template <class A, class B, class C, class X = typename detail::outermost<A, B, C>::type>
X hypot(const A& x, const B& y, const C& z) {
  return hypot(X(x), X(y), X(z));
}
template <class A, class B, class C, class X = typename detail::outermost<A, B, C>::type>
X fma(const A& x, const B& y, const C& z) {
  return fma(X(x), X(y), X(z));
}

}  // namespace dsns
