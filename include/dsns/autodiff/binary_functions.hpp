#pragma once
/// Functions of two differentiable scalars, or of one and a constant: min, max, hypot, atan2, pow.
///
/// Where there is no derivative: those of hypot and atan2 are 0 at (0, 0); min and max take their first argument in a
/// tie, as in the standard library; pow(0, 0) = 1 with derivative 0 in both arguments; pow(x < 0, y) has derivative NaN
/// in a y that is not constant.
/// accuracy a few ulp of closed forms, second derivatives and nested scalars included [autodiff/functions_test]
#include <dsns/autodiff/scalar.hpp>

#include <cmath>

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

template <class T, class P>
T power(const T& x, const P& p) {
  using std::pow;
  return pow(x, p);
}

/// p x^(p - 1), which is 0 for p = 0 also at x = 0.
template <class T, class P>
T power_derivative(const T& x, const P& p) {
  return select(value(x) == 0 && value(p) == 0, T(0), T(p * power(x, P(p - 1))));
}

/// p (p - 1) x^(p - 2), which is 0 for p = 0 and p = 1 also at x = 0.
template <class T, class P>
T power_second(const T& x, const P& p) {
  return select(value(x) == 0 && (value(p) == 0 || value(p) == 1), T(0), T(p * (p - 1) * power(x, P(p - 2))));
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

template <Differentiable X>
X hypot(const X& x, const X& y) {
  using std::hypot;
  using T = typename X::Inner;
  const T f = hypot(x.f, y.f);
  const auto zero = value(f) == 0;
  const T r = select(zero, T(1), f);  // divides where f does not
  const T fx = select(zero, T(0), T(x.f / r)), fy = select(zero, T(0), T(y.f / r));
  return chain(x, y, f, fx, fy, [&] { return detail::Second<T>{T(fy * fy / r), T(-fx * fy / r), T(fx * fx / r)}; });
}

template <Differentiable X>
X atan2(const X& y, const X& x) {
  using std::atan2, std::hypot;
  using T = typename X::Inner;
  const T length = hypot(x.f, y.f);
  const auto zero = value(length) == 0;
  const T r = select(zero, T(1), length);
  const T c = select(zero, T(0), T(x.f / r)), s = select(zero, T(0), T(y.f / r));
  return chain(y, x, T(atan2(y.f, x.f)), T(c / r), T(-s / r), [&] {
    const T mixed = 2 * c * s / (r * r);
    return detail::Second<T>{T(-mixed), T((s * s - c * c) / (r * r)), mixed};
  });
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
  using std::log;
  using T = typename X::Inner;
  const T b = detail::constant<X>(base);
  const T f = detail::power(b, y.f);
  const T l = select(value(b) == 0 && value(y) >= 0, T(0), T(log(b)));
  return detail::singular_chain(y, f, T(f * l), [&]() -> T { return f * l * l; });
}

template <Differentiable X>
X pow(const X& x, const X& y) {
  using std::log;
  using T = typename X::Inner;
  if (detail::inert(y)) return pow(x, y.f);
  const T f = detail::power(x.f, y.f);
  const auto flat = value(x) == 0 && value(y) >= 0;
  const T l = select(flat, T(0), T(log(x.f)));
  return detail::singular_chain(x, y, f, detail::power_derivative(x.f, y.f), T(f * l), [&] {
    const T mixed = select(flat && value(y) > 1, T(0), T(detail::power(x.f, T(y.f - 1)) * (1 + y.f * T(log(x.f)))));
    return detail::Second<T>{detail::power_second(x.f, y.f), mixed, f * l * l};
  });
}

/// hypot and atan2 with one constant argument.
template <Differentiable X, PassiveFor<X> S>
X hypot(const X& x, const S& s) {
  return hypot(x, X(s));
}
template <Differentiable X, PassiveFor<X> S>
X hypot(const S& s, const X& x) {
  return hypot(X(s), x);
}
template <Differentiable X, PassiveFor<X> S>
X atan2(const X& y, const S& x) {
  return atan2(y, X(x));
}
template <Differentiable X, PassiveFor<X> S>
X atan2(const S& y, const X& x) {
  return atan2(X(y), x);
}

}  // namespace dsns
