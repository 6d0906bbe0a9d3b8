#pragma once
/// Forward automatic differentiation, second order: a value with gradient and packed symmetric Hessian in N variables.
/// With N = 2 it is the 2-jet of a surface in a chart (u, v). Needs nothing but the standard library.
///
///   const auto u = Jet2<double>::variable(0.3, 0), v = Jet2<double>::variable(0.4, 1);
///   const auto y = sin(u * v);                       // y.g = {y_u, y_v}, y.h = {y_uu, y_uv, y_vv}
#include <dsns/autodiff/functions.hpp>
#include <dsns/autodiff/tangents.hpp>

#include <compare>
#include <cstddef>
#include <utility>

namespace dsns {

/// Left uninitialised by the default constructor, as numbers are.
template <class T, int N = 2>
struct Jet2 {
  using Inner = T;
  static constexpr int packed = N * (N + 1) / 2;

  T f;
  Tangents<T, N> g;
  Tangents<T, packed> h;  ///< upper triangle, row by row

  Jet2() = default;
  /// A constant.
  template <class S>
  requires(std::is_arithmetic_v<S> || std::is_same_v<S, T> || PassiveFor<S, T>) DSNS_INLINE Jet2(const S& s)
      : f(static_cast<T>(s)), g(Tangents<T, N>::zero()), h(Tangents<T, packed>::zero()) {}
  Jet2(const T& f_, const Tangents<T, N>& g_, const Tangents<T, packed>& h_) : f(f_), g(g_), h(h_) {}
  template <class F, class G, class H>
  requires(std::is_same_v<std::remove_cvref_t<F>, T>&& std::is_same_v<std::remove_cvref_t<G>, Tangents<T, N>>&&
               std::is_same_v<std::remove_cvref_t<H>, Tangents<T, packed>>) DSNS_INLINE Jet2(F&& f_, G&& g_, H&& h_)
      : f(std::forward<F>(f_)), g(std::forward<G>(g_)), h(std::forward<H>(h_)) {}
  /// The k-th independent variable.
  DSNS_INLINE static Jet2 variable(const T& x0, int k) {
    return Jet2(x0, Tangents<T, N>::unit(k), Tangents<T, packed>::zero());
  }
  /// The second derivative in variables i and j.
  T hessian(int i, int j) const {
    const int a = i < j ? i : j, b = i < j ? j : i;
    return h[static_cast<std::size_t>(a * N - a * (a + 1) / 2 + b)];
  }

  /// w(x) for a function with value w, derivative d and second derivative second() at x.f.
  template <class Second>
  DSNS_INLINE friend Jet2 chain(const Jet2& x, const T& w, const T& d, const Second& second) {
    const T d2 = second();
    Jet2 r;
    r.f = w;
    if constexpr (vectors) {
      r.g.v = d * x.g.v;
      r.h.v = d * x.h.v + d2 * (of_row(x) * of_column(x));
    } else {
      for (std::size_t i = 0, m = 0; i < N; ++i) {
        r.g[i] = d * x.g[i];
        const T bend = d2 * x.g[i];
        for (std::size_t j = i; j < N; ++j, ++m) r.h[m] = d * x.h[m] + bend * x.g[j];
      }
    }
    return r;
  }
  /// w(x, y) for a function with value w, partial derivatives wx, wy and second derivatives second() = {xx, xy, yy}.
  template <class Second>
  DSNS_INLINE friend Jet2 chain(const Jet2& x, const Jet2& y, const T& w, const T& wx, const T& wy,
                                const Second& second) {
    const auto s = second();
    Jet2 r;
    r.f = w;
    for (std::size_t i = 0, m = 0; i < N; ++i) {
      r.g[i] = wx * x.g[i] + wy * y.g[i];
      const T bend_x = s.xx * x.g[i] + s.xy * y.g[i], bend_y = s.xy * x.g[i] + s.yy * y.g[i];
      for (std::size_t j = i; j < N; ++j, ++m) r.h[m] = wx * x.h[m] + wy * y.h[m] + bend_x * x.g[j] + bend_y * y.g[j];
    }
    return r;
  }
  /// The same where derivatives are not finite: a direction in which x stands still keeps derivative 0.
  template <class Second>
  friend Jet2 careful_chain(const Jet2& x, const T& w, const T& d, const Second& second) {
    const T d2 = second();
    Jet2 r(w);
    for (std::size_t i = 0, m = 0; i < N; ++i) {
      r.g[i] = detail::times(d, T(x.g[i]));
      for (std::size_t j = i; j < N; ++j, ++m)
        r.h[m] = detail::times(d, T(x.h[m])) + detail::times(d2, T(x.g[i] * x.g[j]));
    }
    return r;
  }
  template <class Second>
  friend Jet2 careful_chain(const Jet2& x, const Jet2& y, const T& w, const T& wx, const T& wy, const Second& second) {
    using detail::times;
    const auto s = second();
    Jet2 r(w);
    for (std::size_t i = 0, m = 0; i < N; ++i) {
      r.g[i] = times(wx, T(x.g[i])) + times(wy, T(y.g[i]));
      for (std::size_t j = i; j < N; ++j, ++m)
        r.h[m] = times(wx, T(x.h[m])) + times(wy, T(y.h[m])) + times(T(s.xx), T(x.g[i] * x.g[j])) +
                 times(T(s.xy), T(x.g[i] * y.g[j] + y.g[i] * x.g[j])) + times(T(s.yy), T(y.g[i] * y.g[j]));
    }
    return r;
  }
  friend bool derivatives_vanish(const Jet2& x) {
    bool zero = detail::inert(x.f);
    for (const T& d : x.g) zero = zero && detail::everywhere(d == T(0)) && detail::inert(d);
    for (const T& d : x.h) zero = zero && detail::everywhere(d == T(0)) && detail::inert(d);
    return zero;
  }
  /// a where the mask holds, else b, for T over a Batch.
  template <class M>
  requires(!std::is_convertible_v<M, bool>) friend Jet2 select(const M& mask, const Jet2& a, const Jet2& b) {
    return each(a, b, [&](const T& x, const T& y) { return select(mask, x, y); });
  }

  DSNS_INLINE friend Jet2 operator+(const Jet2& a) { return a; }
  DSNS_INLINE friend Jet2 operator-(const Jet2& a) {
    return each(a, [](const auto& x) { return -x; });
  }
  DSNS_INLINE friend Jet2 operator+(const Jet2& a, const Jet2& b) {
    return each(a, b, [](const auto& x, const auto& y) { return x + y; });
  }
  DSNS_INLINE friend Jet2 operator-(const Jet2& a, const Jet2& b) {
    return each(a, b, [](const auto& x, const auto& y) { return x - y; });
  }
  DSNS_INLINE friend Jet2 operator*(const Jet2& a, const Jet2& b) {
    Jet2 r;
    r.f = a.f * b.f;
    if constexpr (vectors) {
      r.g.v = a.f * b.g.v + b.f * a.g.v;
      r.h.v = a.f * b.h.v + b.f * a.h.v + of_row(a) * of_column(b) + of_column(a) * of_row(b);
    } else {
      for (std::size_t i = 0, m = 0; i < N; ++i) {
        r.g[i] = a.f * b.g[i] + b.f * a.g[i];
        for (std::size_t j = i; j < N; ++j, ++m)
          r.h[m] = a.f * b.h[m] + b.f * a.h[m] + a.g[i] * b.g[j] + a.g[j] * b.g[i];
      }
    }
    return r;
  }
  DSNS_INLINE friend Jet2 operator/(const Jet2& a, const Jet2& b) {
    Jet2 r;
    const T inverse = 1 / b.f;
    r.f = a.f / b.f;
    if constexpr (vectors) {  // from a = r b
      r.g.v = (a.g.v - r.f * b.g.v) * inverse;
      r.h.v = (a.h.v - r.f * b.h.v - of_row(r) * of_column(b) - of_column(r) * of_row(b)) * inverse;
    } else {
      for (std::size_t i = 0; i < N; ++i) r.g[i] = (a.g[i] - r.f * b.g[i]) * inverse;
      for (std::size_t i = 0, m = 0; i < N; ++i)
        for (std::size_t j = i; j < N; ++j, ++m)
          r.h[m] = (a.h[m] - r.f * b.h[m] - r.g[i] * b.g[j] - r.g[j] * b.g[i]) * inverse;
    }
    return r;
  }

  template <PassiveFor<Jet2> S>
  DSNS_INLINE friend Jet2 operator+(const Jet2& a, const S& s) {
    return Jet2(a.f + detail::constant<Jet2>(s), a.g, a.h);
  }
  template <PassiveFor<Jet2> S>
  DSNS_INLINE friend Jet2 operator+(const S& s, const Jet2& a) {
    return a + s;
  }
  template <PassiveFor<Jet2> S>
  DSNS_INLINE friend Jet2 operator-(const Jet2& a, const S& s) {
    return Jet2(a.f - detail::constant<Jet2>(s), a.g, a.h);
  }
  template <PassiveFor<Jet2> S>
  DSNS_INLINE friend Jet2 operator-(const S& s, const Jet2& a) {
    Jet2 r = -a;
    r.f = detail::constant<Jet2>(s) - a.f;
    return r;
  }
  template <PassiveFor<Jet2> S>
  DSNS_INLINE friend Jet2 operator*(const Jet2& a, const S& s) {
    const auto& c = detail::constant<Jet2>(s);
    return each(a, [&c](const auto& x) { return x * c; });
  }
  template <PassiveFor<Jet2> S>
  DSNS_INLINE friend Jet2 operator*(const S& s, const Jet2& a) {
    return a * s;
  }
  template <PassiveFor<Jet2> S>
  DSNS_INLINE friend Jet2 operator/(const Jet2& a, const S& s) {
    const auto& c = detail::constant<Jet2>(s);
    return each(a, [&c](const auto& x) { return x / c; });
  }
  template <PassiveFor<Jet2> S>
  DSNS_INLINE friend Jet2 operator/(const S& s, const Jet2& a) {
    const T q = detail::constant<Jet2>(s) / a.f, d = -q / a.f;
    return chain(a, q, d, [&] { return -2 * d / a.f; });
  }

  /// By value, so that a temporary's entries are added as the temporaries they are (see Var).
  DSNS_INLINE Jet2& operator+=(Jet2 b) {
    f += std::move(b.f);
    g += std::move(b.g);
    h += std::move(b.h);
    return *this;
  }
  DSNS_INLINE Jet2& operator-=(Jet2 b) {
    f -= std::move(b.f);
    g -= std::move(b.g);
    h -= std::move(b.h);
    return *this;
  }
  DSNS_INLINE Jet2& operator*=(const Jet2& b) { return *this = *this * b; }
  DSNS_INLINE Jet2& operator/=(const Jet2& b) { return *this = *this / b; }

  /// Comparisons see values only.
  friend detail::Equality<T> operator==(const Jet2& a, const Jet2& b) { return a.f == b.f; }
  friend auto operator<=>(const Jet2& a, const Jet2& b) { return a.f <=> b.f; }
  template <PassiveFor<Jet2> S>
  friend detail::Equality<T> operator==(const Jet2& a, const S& s) {
    return a.f == detail::constant<Jet2>(s);
  }
  template <PassiveFor<Jet2> S>
  friend auto operator<=>(const Jet2& a, const S& s) {
    return a.f <=> detail::constant<Jet2>(s);
  }

 private:
  static constexpr bool vectors = N == 2 && Tangents<T, N>::is_vector && Tangents<T, packed>::is_vector;
  DSNS_INLINE static auto of_row(const Jet2& x) { return detail::of_row(x.g).v; }
  DSNS_INLINE static auto of_column(const Jet2& x) { return detail::of_column(x.g).v; }

  template <class Op>
  DSNS_INLINE static Jet2 each(const Jet2& a, const Op& op) {
    return Jet2(op(a.f), Tangents<T, N>::each(op, a.g), Tangents<T, packed>::each(op, a.h));
  }
  template <class Op>
  DSNS_INLINE static Jet2 each(const Jet2& a, const Jet2& b, const Op& op) {
    return Jet2(op(a.f, b.f), Tangents<T, N>::each(op, a.g, b.g), Tangents<T, packed>::each(op, a.h, b.h));
  }
};

template <class T, int N>
inline constexpr bool is_differentiable<Jet2<T, N>> = true;

}  // namespace dsns
