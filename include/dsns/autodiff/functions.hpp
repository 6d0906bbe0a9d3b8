#pragma once
/// Elementary functions of every differentiable scalar, each written once: value, derivative, and second derivative on
/// demand, joined by `chain`. They are found by argument-dependent lookup: generic code says `using std::sin; sin(x)`.
///
/// Where there is no derivative: that of abs is 0 at 0, those of sqrt and cbrt are infinite (use hypot for lengths).
/// accuracy a few ulp of closed forms, second derivatives and nested scalars included [autodiff/functions_test]
#include <dsns/autodiff/binary_functions.hpp>
#include <dsns/autodiff/scalar.hpp>

#include <cmath>
#include <concepts>

namespace dsns {

template <std::floating_point T>
T sqr(T x) {
  return x * x;
}

/// 1 / (1 + exp(-x)) without overflow.
template <std::floating_point T>
T sigmoid(T x) {
  const T e = std::exp(x < 0 ? x : -x);
  return (x < 0 ? e : T(1)) / (1 + e);
}

/// log(1 + exp(x)) without overflow.
template <std::floating_point T>
T softplus(T x) {
  return (x > 0 ? x : T(0)) + std::log1p(std::exp(x < 0 ? x : -x));
}

/// x sigmoid(x)
template <std::floating_point T>
T silu(T x) {
  return x * sigmoid(x);
}

template <Differentiable X>
DSNS_INLINE X sqr(const X& x) {
  return x * x;
}

template <Differentiable X>
DSNS_INLINE X abs(const X& x) {
  if constexpr (std::is_arithmetic_v<Passive<X>>) {
    using T = typename X::Inner;
    if (x.f == 0) return chain(x, T(0), T(0), [] { return T(0); });
    return x.f < 0 ? X(-x) : x;
  } else {
    using P = Passive<X>;
    return x * select(value(x) < 0, P(-1), select(value(x) == 0, P(0), P(1)));
  }
}
template <Differentiable X>
DSNS_INLINE X fabs(const X& x) {
  return abs(x);
}

template <Differentiable X>
bool isfinite(const X& x) {
  using std::isfinite;
  return isfinite(x.f);
}
template <Differentiable X>
bool isnan(const X& x) {
  using std::isnan;
  return isnan(x.f);
}
template <Differentiable X>
bool isinf(const X& x) {
  using std::isinf;
  return isinf(x.f);
}

template <Differentiable X>
DSNS_INLINE X sqrt(const X& x) {
  using std::sqrt;
  const auto f = sqrt(x.f);
  const auto d = 1 / (2 * f);
  return detail::singular_chain(x, f, d, [&] { return -d / (2 * x.f); });
}

template <Differentiable X>
DSNS_INLINE X cbrt(const X& x) {
  using std::cbrt;
  const auto f = cbrt(x.f);
  const auto d = 1 / (3 * f * f);
  return detail::singular_chain(x, f, d, [&] { return -2 * d / (3 * x.f); });
}

template <Differentiable X>
DSNS_INLINE X exp(const X& x) {
  using std::exp;
  const auto f = exp(x.f);
  return chain(x, f, f, [&] { return f; });
}

template <Differentiable X>
DSNS_INLINE X expm1(const X& x) {
  using std::exp, std::expm1;
  const auto d = exp(x.f);
  return chain(x, expm1(x.f), d, [&] { return d; });
}

template <Differentiable X>
DSNS_INLINE X exp2(const X& x) {
  using std::exp2;
  const auto ln2 = Passive<X>(0.693147180559945309417232121458176568L);
  const auto f = exp2(x.f);
  return chain(x, f, ln2 * f, [&] { return ln2 * ln2 * f; });
}

template <Differentiable X>
DSNS_INLINE X log(const X& x) {
  using std::log;
  const auto d = 1 / x.f;
  return detail::singular_chain(x, log(x.f), d, [&] { return -d * d; });
}

template <Differentiable X>
DSNS_INLINE X log1p(const X& x) {
  using std::log1p;
  const auto d = 1 / (1 + x.f);
  return detail::singular_chain(x, log1p(x.f), d, [&] { return -d * d; });
}

template <Differentiable X>
DSNS_INLINE X log2(const X& x) {
  using std::log2;
  const auto d = Passive<X>(1.442695040888963407359924681001892137L) / x.f;
  return detail::singular_chain(x, log2(x.f), d, [&] { return -d / x.f; });
}

template <Differentiable X>
DSNS_INLINE X log10(const X& x) {
  using std::log10;
  const auto d = Passive<X>(0.434294481903251827651128918916605082L) / x.f;
  return detail::singular_chain(x, log10(x.f), d, [&] { return -d / x.f; });
}

/// Sine and cosine of one angle.
template <class T>
struct SineCosine {
  T sine, cosine;
};
#if defined(__clang__) && defined(__GLIBC__) && defined(_GNU_SOURCE)
namespace detail {

// g++ joins the sine and the cosine of one angle, and all calls for it, by itself; clang joins calls of a function that is
// declared to depend on its argument only.
[[gnu::const, gnu::noinline]] inline SineCosine<double> sine_and_cosine(double x) {
  SineCosine<double> r;
  ::sincos(x, &r.sine, &r.cosine);
  return r;
}

}  // namespace detail
#endif

template <class T>
DSNS_INLINE SineCosine<T> sincos(const T& x) {
#if defined(__clang__) && defined(__GLIBC__) && defined(_GNU_SOURCE)
  if constexpr (std::is_same_v<T, double>) return detail::sine_and_cosine(x);
#endif
  using std::cos, std::sin;
  return {sin(x), cos(x)};
}
template <Differentiable X>
DSNS_INLINE SineCosine<X> sincos(const X& x) {
  const auto a = sincos(x.f);
  return {chain(x, a.sine, a.cosine, [&] { return -a.sine; }), chain(x, a.cosine, -a.sine, [&] { return -a.cosine; })};
}

template <Differentiable X>
DSNS_INLINE X sin(const X& x) {
  const auto a = sincos(x.f);
  return chain(x, a.sine, a.cosine, [&] { return -a.sine; });
}
template <Differentiable X>
DSNS_INLINE X cos(const X& x) {
  const auto a = sincos(x.f);
  return chain(x, a.cosine, -a.sine, [&] { return -a.cosine; });
}

template <Differentiable X>
DSNS_INLINE X tan(const X& x) {
  using std::tan;
  const auto f = tan(x.f);
  const auto d = 1 + f * f;
  return chain(x, f, d, [&] { return 2 * f * d; });
}

template <Differentiable X>
DSNS_INLINE X asin(const X& x) {
  using std::asin, std::sqrt;
  const auto r = (1 - x.f) * (1 + x.f);
  const auto d = 1 / sqrt(r);
  return detail::singular_chain(x, asin(x.f), d, [&] { return x.f * d / r; });
}

template <Differentiable X>
DSNS_INLINE X acos(const X& x) {
  using std::acos, std::sqrt;
  const auto r = (1 - x.f) * (1 + x.f);
  const auto d = -1 / sqrt(r);
  return detail::singular_chain(x, acos(x.f), d, [&] { return x.f * d / r; });
}

template <Differentiable X>
DSNS_INLINE X atan(const X& x) {
  using std::atan;
  const auto d = 1 / (1 + x.f * x.f);
  return chain(x, atan(x.f), d, [&] { return -2 * x.f * d * d; });
}

template <Differentiable X>
DSNS_INLINE X sinh(const X& x) {
  using std::cosh, std::sinh;
  const auto f = sinh(x.f);
  return chain(x, f, cosh(x.f), [&] { return f; });
}

template <Differentiable X>
DSNS_INLINE X cosh(const X& x) {
  using std::cosh, std::sinh;
  const auto f = cosh(x.f);
  return chain(x, f, sinh(x.f), [&] { return f; });
}

template <Differentiable X>
DSNS_INLINE X tanh(const X& x) {
  using std::tanh;
  const auto f = tanh(x.f);
  const auto d = (1 - f) * (1 + f);
  return chain(x, f, d, [&] { return -2 * f * d; });
}

template <Differentiable X>
DSNS_INLINE X asinh(const X& x) {
  using std::asinh, std::sqrt;
  const auto r = 1 + x.f * x.f;
  const auto d = 1 / sqrt(r);
  return chain(x, asinh(x.f), d, [&] { return -x.f * d / r; });
}

template <Differentiable X>
DSNS_INLINE X acosh(const X& x) {
  using std::acosh, std::sqrt;
  const auto r = (x.f - 1) * (x.f + 1);
  const auto d = 1 / sqrt(r);
  return detail::singular_chain(x, acosh(x.f), d, [&] { return -x.f * d / r; });
}

template <Differentiable X>
DSNS_INLINE X atanh(const X& x) {
  using std::atanh;
  const auto d = 1 / ((1 - x.f) * (1 + x.f));
  return detail::singular_chain(x, atanh(x.f), d, [&] { return 2 * x.f * d * d; });
}

template <Differentiable X>
DSNS_INLINE X erf(const X& x) {
  using std::erf, std::exp;
  const auto d = Passive<X>(1.128379167095512573896158903121545172L) * exp(-x.f * x.f);  // 2 / sqrt(pi)
  return chain(x, erf(x.f), d, [&] { return -2 * x.f * d; });
}

template <Differentiable X>
DSNS_INLINE X erfc(const X& x) {
  using std::erfc, std::exp;
  const auto d = Passive<X>(-1.128379167095512573896158903121545172L) * exp(-x.f * x.f);
  return chain(x, erfc(x.f), d, [&] { return -2 * x.f * d; });
}

/// Rounding: derivative 0, also at the jumps.
#define DSNS_ROUNDING(name)               \
  template <Differentiable X>             \
  DSNS_INLINE X name(const X& x) {        \
    using std::name;                      \
    return X(Passive<X>(name(value(x)))); \
  }
DSNS_ROUNDING(floor)
DSNS_ROUNDING(ceil)
DSNS_ROUNDING(trunc)
DSNS_ROUNDING(round)
DSNS_ROUNDING(rint)
DSNS_ROUNDING(nearbyint)
#undef DSNS_ROUNDING

template <Differentiable X>
DSNS_INLINE X sigmoid(const X& x) {
  const auto f = sigmoid(x.f);
  const auto rest = sigmoid(-x.f);  // 1 - f without cancellation
  const auto d = f * rest;
  return chain(x, f, d, [&] { return d * (rest - f); });
}

template <Differentiable X>
DSNS_INLINE X softplus(const X& x) {
  const auto d = sigmoid(x.f);
  return chain(x, softplus(x.f), d, [&] { return d * sigmoid(-x.f); });
}

template <Differentiable X>
DSNS_INLINE X silu(const X& x) {
  const auto s = sigmoid(x.f);
  const auto rest = sigmoid(-x.f);
  return chain(x, x.f * s, s + x.f * s * rest, [&] { return s * rest * (2 + x.f * (rest - s)); });
}

}  // namespace dsns
