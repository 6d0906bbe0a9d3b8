#pragma once
/// Forward automatic differentiation, first order: a value with N partial derivatives. Needs nothing but the standard
/// library. Plain values, no expression templates: `auto` is safe. T may be float, double, long double or another
/// differentiable scalar; each level of nesting is a type of its own, so perturbations cannot be confused.
///
///   auto x = Dual<double, 1>::variable(0.5, 0);
///   auto y = exp(sin(x));                            // y.f = value, y.g[0] = dy/dx
#include <dsns/autodiff/functions.hpp>

#include <array>
#include <compare>
#include <cstddef>

namespace dsns {

/// Left uninitialised by the default constructor, as numbers are.
template <class T, int N = 1>
struct Dual {
  using Inner = T;

  T f;
  std::array<T, std::size_t(N)> g;

  Dual() = default;
  /// A constant.
  template <class S>
  requires(std::is_arithmetic_v<S> || std::is_same_v<S, T> || PassiveFor<S, T>) Dual(const S& s)
      : f(static_cast<T>(s)) {
    g.fill(T(0));
  }
  Dual(const T& f_, const std::array<T, std::size_t(N)>& g_) : f(f_), g(g_) {}
  /// The k-th independent variable: derivative 1 in direction k, 0 in the others.
  static Dual variable(const T& x0, int k) {
    Dual x(x0);
    x.g[static_cast<std::size_t>(k)] = T(1);
    return x;
  }

  /// w(x) for a function with value w and derivative d at x.f.
  template <class Second>
  friend Dual chain(const Dual& x, const T& w, const T& d, const Second&) {
    Dual r;
    r.f = w;
    for (std::size_t i = 0; i < N; ++i) r.g[i] = d * x.g[i];
    return r;
  }
  /// w(x, y) for a function with value w and partial derivatives wx, wy.
  template <class Second>
  friend Dual chain(const Dual& x, const Dual& y, const T& w, const T& wx, const T& wy, const Second&) {
    Dual r;
    r.f = w;
    for (std::size_t i = 0; i < N; ++i) r.g[i] = wx * x.g[i] + wy * y.g[i];
    return r;
  }
  friend bool derivatives_vanish(const Dual& x) {
    bool zero = detail::inert(x.f);
    for (const T& d : x.g) zero = zero && d == T(0) && detail::inert(d);
    return zero;
  }

  friend Dual operator+(const Dual& a) { return a; }
  friend Dual operator-(const Dual& a) {
    Dual r;
    r.f = -a.f;
    for (std::size_t i = 0; i < N; ++i) r.g[i] = -a.g[i];
    return r;
  }
  friend Dual operator+(const Dual& a, const Dual& b) {
    Dual r;
    r.f = a.f + b.f;
    for (std::size_t i = 0; i < N; ++i) r.g[i] = a.g[i] + b.g[i];
    return r;
  }
  friend Dual operator-(const Dual& a, const Dual& b) {
    Dual r;
    r.f = a.f - b.f;
    for (std::size_t i = 0; i < N; ++i) r.g[i] = a.g[i] - b.g[i];
    return r;
  }
  friend Dual operator*(const Dual& a, const Dual& b) {
    Dual r;
    r.f = a.f * b.f;
    for (std::size_t i = 0; i < N; ++i) r.g[i] = a.f * b.g[i] + b.f * a.g[i];
    return r;
  }
  friend Dual operator/(const Dual& a, const Dual& b) {
    Dual r;
    const T inverse = 1 / b.f;
    r.f = a.f / b.f;
    for (std::size_t i = 0; i < N; ++i) r.g[i] = (a.g[i] - r.f * b.g[i]) * inverse;
    return r;
  }

  template <PassiveFor<Dual> S>
  friend Dual operator+(const Dual& a, const S& s) {
    return Dual(a.f + detail::constant<Dual>(s), a.g);
  }
  template <PassiveFor<Dual> S>
  friend Dual operator+(const S& s, const Dual& a) {
    return a + s;
  }
  template <PassiveFor<Dual> S>
  friend Dual operator-(const Dual& a, const S& s) {
    return Dual(a.f - detail::constant<Dual>(s), a.g);
  }
  template <PassiveFor<Dual> S>
  friend Dual operator-(const S& s, const Dual& a) {
    Dual r = -a;
    r.f = detail::constant<Dual>(s) - a.f;
    return r;
  }
  template <PassiveFor<Dual> S>
  friend Dual operator*(const Dual& a, const S& s) {
    const auto& c = detail::constant<Dual>(s);
    Dual r;
    r.f = a.f * c;
    for (std::size_t i = 0; i < N; ++i) r.g[i] = a.g[i] * c;
    return r;
  }
  template <PassiveFor<Dual> S>
  friend Dual operator*(const S& s, const Dual& a) {
    return a * s;
  }
  template <PassiveFor<Dual> S>
  friend Dual operator/(const Dual& a, const S& s) {
    const auto& c = detail::constant<Dual>(s);
    Dual r;
    r.f = a.f / c;
    for (std::size_t i = 0; i < N; ++i) r.g[i] = a.g[i] / c;
    return r;
  }
  template <PassiveFor<Dual> S>
  friend Dual operator/(const S& s, const Dual& a) {
    const T q = detail::constant<Dual>(s) / a.f;
    return chain(a, q, -q / a.f, [] {});
  }

  Dual& operator+=(const Dual& b) { return *this = *this + b; }
  Dual& operator-=(const Dual& b) { return *this = *this - b; }
  Dual& operator*=(const Dual& b) { return *this = *this * b; }
  Dual& operator/=(const Dual& b) { return *this = *this / b; }

  /// Comparisons see values only.
  friend bool operator==(const Dual& a, const Dual& b) { return a.f == b.f; }
  friend auto operator<=>(const Dual& a, const Dual& b) { return a.f <=> b.f; }
  template <PassiveFor<Dual> S>
  friend bool operator==(const Dual& a, const S& s) {
    return a.f == detail::constant<Dual>(s);
  }
  template <PassiveFor<Dual> S>
  friend auto operator<=>(const Dual& a, const S& s) {
    return a.f <=> detail::constant<Dual>(s);
  }
};

template <class T, int N>
inline constexpr bool is_differentiable<Dual<T, N>> = true;

}  // namespace dsns
