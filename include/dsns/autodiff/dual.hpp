#pragma once
/// Forward automatic differentiation, first order: a value with N partial derivatives. Needs nothing but the standard
/// library. Plain values, no expression templates: `auto` is safe. T may be float, double, long double or another
/// differentiable scalar; each level of nesting is a type of its own, so perturbations cannot be confused.
///
///   auto x = Dual<double, 1>::variable(0.5, 0);
///   auto y = exp(sin(x));                            // y.f = value, y.g[0] = dy/dx
#include <dsns/autodiff/functions.hpp>
#include <dsns/autodiff/tangents.hpp>

#include <compare>
#include <cstddef>
#include <utility>

namespace dsns {

/// Left uninitialised by the default constructor, as numbers are.
template <class T, int N = 1>
struct Dual {
  using Inner = T;

  T f;
  Tangents<T, N> g;

  Dual() = default;
  /// A constant.
  template <class S>
  requires(std::is_arithmetic_v<S> || std::is_same_v<S, T> || PassiveFor<S, T>) DSNS_INLINE Dual(const S& s)
      : f(static_cast<T>(s)), g(Tangents<T, N>::zero()) {}
  Dual(const T& f_, const Tangents<T, N>& g_) : f(f_), g(g_) {}
  template <class F, class G>
  requires(std::is_same_v<std::remove_cvref_t<F>, T>&& std::is_same_v<std::remove_cvref_t<G>, Tangents<T, N>>)
      DSNS_INLINE Dual(F&& f_, G&& g_)
      : f(std::forward<F>(f_)), g(std::forward<G>(g_)) {}
  /// The k-th independent variable: derivative 1 in direction k, 0 in the others.
  DSNS_INLINE static Dual variable(const T& x0, int k) { return Dual(x0, Tangents<T, N>::unit(k)); }

  /// w(x) for a function with value w and derivative d at x.f.
  template <class Second>
  DSNS_INLINE friend Dual chain(const Dual& x, const T& w, const T& d, const Second&) {
    return Dual(w, each([&](const auto& dx) { return d * dx; }, x.g));
  }
  /// w(x, y) for a function with value w and partial derivatives wx, wy.
  template <class Second>
  DSNS_INLINE friend Dual chain(const Dual& x, const Dual& y, const T& w, const T& wx, const T& wy, const Second&) {
    return Dual(w, each([&](const auto& dx, const auto& dy) { return wx * dx + wy * dy; }, x.g, y.g));
  }
  /// The same where derivatives are not finite: a direction in which x stands still keeps derivative 0.
  template <class Second>
  friend Dual careful_chain(const Dual& x, const T& w, const T& d, const Second&) {
    Dual r(w);
    for (std::size_t i = 0; i < N; ++i) r.g[i] = detail::times(d, T(x.g[i]));
    return r;
  }
  template <class Second>
  friend Dual careful_chain(const Dual& x, const Dual& y, const T& w, const T& wx, const T& wy, const Second&) {
    Dual r(w);
    for (std::size_t i = 0; i < N; ++i) r.g[i] = detail::times(wx, T(x.g[i])) + detail::times(wy, T(y.g[i]));
    return r;
  }
  friend bool derivatives_vanish(const Dual& x) {
    bool zero = detail::inert(x.f);
    for (const T& d : x.g) zero = zero && detail::everywhere(d == T(0)) && detail::inert(d);
    return zero;
  }
  /// a where the mask holds, else b, for T over a Batch.
  template <class M>
  requires(!std::is_convertible_v<M, bool>) friend Dual select(const M& mask, const Dual& a, const Dual& b) {
    return Dual(select(mask, a.f, b.f), each([&](const T& da, const T& db) { return select(mask, da, db); }, a.g, b.g));
  }

  DSNS_INLINE friend Dual operator+(const Dual& a) { return a; }
  DSNS_INLINE friend Dual operator-(const Dual& a) {
    return Dual(-a.f, each([](const auto& da) { return -da; }, a.g));
  }
  DSNS_INLINE friend Dual operator+(const Dual& a, const Dual& b) {
    return Dual(a.f + b.f, each([](const auto& da, const auto& db) { return da + db; }, a.g, b.g));
  }
  DSNS_INLINE friend Dual operator-(const Dual& a, const Dual& b) {
    return Dual(a.f - b.f, each([](const auto& da, const auto& db) { return da - db; }, a.g, b.g));
  }
  DSNS_INLINE friend Dual operator*(const Dual& a, const Dual& b) {
    return Dual(a.f * b.f, each([&](const auto& da, const auto& db) { return a.f * db + b.f * da; }, a.g, b.g));
  }
  DSNS_INLINE friend Dual operator/(const Dual& a, const Dual& b) {
    const T inverse = 1 / b.f, q = a.f / b.f;
    return Dual(q, each([&](const auto& da, const auto& db) { return (da - q * db) * inverse; }, a.g, b.g));
  }

  template <PassiveFor<Dual> S>
  DSNS_INLINE friend Dual operator+(const Dual& a, const S& s) {
    return Dual(a.f + detail::constant<Dual>(s), a.g);
  }
  template <PassiveFor<Dual> S>
  DSNS_INLINE friend Dual operator+(const S& s, const Dual& a) {
    return a + s;
  }
  template <PassiveFor<Dual> S>
  DSNS_INLINE friend Dual operator-(const Dual& a, const S& s) {
    return Dual(a.f - detail::constant<Dual>(s), a.g);
  }
  template <PassiveFor<Dual> S>
  DSNS_INLINE friend Dual operator-(const S& s, const Dual& a) {
    Dual r = -a;
    r.f = detail::constant<Dual>(s) - a.f;
    return r;
  }
  template <PassiveFor<Dual> S>
  DSNS_INLINE friend Dual operator*(const Dual& a, const S& s) {
    const auto& c = detail::constant<Dual>(s);
    return Dual(a.f * c, each([&](const auto& da) { return da * c; }, a.g));
  }
  template <PassiveFor<Dual> S>
  DSNS_INLINE friend Dual operator*(const S& s, const Dual& a) {
    return a * s;
  }
  template <PassiveFor<Dual> S>
  DSNS_INLINE friend Dual operator/(const Dual& a, const S& s) {
    const auto& c = detail::constant<Dual>(s);
    return Dual(a.f / c, each([&](const auto& da) { return da / c; }, a.g));
  }
  template <PassiveFor<Dual> S>
  DSNS_INLINE friend Dual operator/(const S& s, const Dual& a) {
    const T q = detail::constant<Dual>(s) / a.f;
    return chain(a, q, -q / a.f, [] {});
  }

  /// By value, so that a temporary's entries are added as the temporaries they are (see Var).
  DSNS_INLINE Dual& operator+=(Dual b) {
    f += std::move(b.f);
    g += std::move(b.g);
    return *this;
  }
  DSNS_INLINE Dual& operator-=(Dual b) {
    f -= std::move(b.f);
    g -= std::move(b.g);
    return *this;
  }
  DSNS_INLINE Dual& operator*=(const Dual& b) { return *this = *this * b; }
  DSNS_INLINE Dual& operator/=(const Dual& b) { return *this = *this / b; }

  /// Comparisons see values only.
  friend detail::Equality<T> operator==(const Dual& a, const Dual& b) { return a.f == b.f; }
  friend auto operator<=>(const Dual& a, const Dual& b) { return a.f <=> b.f; }
  template <PassiveFor<Dual> S>
  friend detail::Equality<T> operator==(const Dual& a, const S& s) {
    return a.f == detail::constant<Dual>(s);
  }
  template <PassiveFor<Dual> S>
  friend auto operator<=>(const Dual& a, const S& s) {
    return a.f <=> detail::constant<Dual>(s);
  }

 private:
  template <class Op, class... X>
  DSNS_INLINE static Tangents<T, N> each(const Op& op, const X&... x) {
    return Tangents<T, N>::each(op, x...);
  }
};

template <class T, int N>
inline constexpr bool is_differentiable<Dual<T, N>> = true;

}  // namespace dsns
