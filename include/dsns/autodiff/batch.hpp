#pragma once
/// L numbers that go through the same computation side by side, in vector registers. Stands wherever a number does:
/// Jet2<Batch<double>> differentiates at L points at once. Needs nothing but the standard library.
///
///   const auto u = Jet2<Batch<double>>::variable(Batch<double>::load(&angles[i]), 0);
///   sin(u).g[0].store(&slopes[i]);
///
/// Comparisons give a Mask, and select(mask, a, b) takes the place of a condition.
/// accuracy   of the standard functions; sin, cos, exp and log within 4 ulp where glibc's vector library serves them
#include <dsns/autodiff/scalar.hpp>
#include <dsns/autodiff/tangents.hpp>

#include <cmath>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <limits>

#if !defined(__GNUC__)
#error "dsns/autodiff/batch.hpp needs the vector types of GCC or Clang; include it for no other compiler"
#endif

namespace dsns {

/// As many as one register holds.
template <class T>
inline constexpr int native_lanes = int(detail::vector_bytes / sizeof(T));

template <std::floating_point T, int L = native_lanes<T>>
struct Batch;

/// A truth value a lane.
template <class T, int L>
struct Mask {
  using Lane = std::conditional_t<sizeof(T) == 4, std::int32_t, std::int64_t>;
  typedef Lane Vector __attribute__((vector_size(L * sizeof(Lane))));
  Vector m;  // 0 or -1

  bool operator[](int i) const { return m[i] != 0; }
  template <std::same_as<bool> B>
  explicit operator B() const {
    static_assert(sizeof(B) == 0,
                  "a batch is true in some lanes and false in others: use select(condition, a, b), any or all");
    return false;
  }
  friend Mask operator&&(const Mask& a, const Mask& b) { return {a.m & b.m}; }
  friend Mask operator||(const Mask& a, const Mask& b) { return {a.m | b.m}; }
  friend Mask operator!(const Mask& a) { return {~a.m}; }
  friend bool any(const Mask& a) {
    bool r = false;
    for (int i = 0; i < L; ++i) r = r || a[i];
    return r;
  }
  friend bool all(const Mask& a) { return !any(!a); }
};

/// Left uninitialised by the default constructor, as numbers are.
template <std::floating_point T, int L>
struct Batch {
  static_assert(L > 0 && (L & (L - 1)) == 0, "Batch: the number of lanes is a power of two");
  static constexpr int lanes = L;
  typedef T Vector __attribute__((vector_size(L * sizeof(T))));
  Vector v;

  Batch() = default;
  template <class S>
  requires std::is_arithmetic_v<S> DSNS_INLINE Batch(S s) : v(static_cast<T>(s) - Vector{}) {}
  DSNS_INLINE explicit Batch(const Vector& x) : v(x) {}
  static Batch load(const T* x) {
    Batch r;
    std::memcpy(&r.v, x, sizeof(r.v));
    return r;
  }
  void store(T* x) const { std::memcpy(x, &v, sizeof(v)); }
  T operator[](int i) const { return v[i]; }

  /// f lane by lane.
  template <class F, class... X>
  static Batch each(const F& f, const X&... x) {
    Batch r;
    for (int i = 0; i < L; ++i) r.v[i] = f(x[i]...);
    return r;
  }

  DSNS_INLINE friend Batch operator+(const Batch& a) { return a; }
  DSNS_INLINE friend Batch operator-(const Batch& a) { return Batch(Vector(-a.v)); }
  DSNS_INLINE friend Batch operator+(const Batch& a, const Batch& b) { return Batch(Vector(a.v + b.v)); }
  DSNS_INLINE friend Batch operator-(const Batch& a, const Batch& b) { return Batch(Vector(a.v - b.v)); }
  DSNS_INLINE friend Batch operator*(const Batch& a, const Batch& b) { return Batch(Vector(a.v * b.v)); }
  DSNS_INLINE friend Batch operator/(const Batch& a, const Batch& b) { return Batch(Vector(a.v / b.v)); }
  DSNS_INLINE Batch& operator+=(const Batch& b) { return *this = *this + b; }
  DSNS_INLINE Batch& operator-=(const Batch& b) { return *this = *this - b; }
  DSNS_INLINE Batch& operator*=(const Batch& b) { return *this = *this * b; }
  DSNS_INLINE Batch& operator/=(const Batch& b) { return *this = *this / b; }

  /// What <=> gives, so that scalars over batches compare as those over numbers do.
  struct Order {
    Batch a, b;
    using M = Mask<T, L>;
    friend M operator<(const Order& o, int) { return {typename M::Vector(o.a.v < o.b.v)}; }
    friend M operator>(const Order& o, int) { return {typename M::Vector(o.a.v > o.b.v)}; }
    friend M operator<=(const Order& o, int) { return {typename M::Vector(o.a.v <= o.b.v)}; }
    friend M operator>=(const Order& o, int) { return {typename M::Vector(o.a.v >= o.b.v)}; }
    friend M operator<(int, const Order& o) { return o > 0; }
    friend M operator>(int, const Order& o) { return o < 0; }
    friend M operator<=(int, const Order& o) { return o >= 0; }
    friend M operator>=(int, const Order& o) { return o <= 0; }
  };
  friend Order operator<=>(const Batch& a, const Batch& b) { return {a, b}; }
  friend Mask<T, L> operator==(const Batch& a, const Batch& b) { return {typename Mask<T, L>::Vector(a.v == b.v)}; }
};

template <class T, int L>
DSNS_INLINE Batch<T, L> select(const Mask<T, L>& m, const Batch<T, L>& a, const Batch<T, L>& b) {
  return Batch<T, L>(typename Batch<T, L>::Vector(m.m ? a.v : b.v));
}

namespace detail {

#if defined(__x86_64__) && defined(__GLIBC__) && defined(__AVX2__)
typedef double Vector4d __attribute__((vector_size(32)));
extern "C" {
[[gnu::const]] Vector4d _ZGVdN4v_sin(Vector4d);
[[gnu::const]] Vector4d _ZGVdN4v_cos(Vector4d);
[[gnu::const]] Vector4d _ZGVdN4v_exp(Vector4d);
[[gnu::const]] Vector4d _ZGVdN4v_log(Vector4d);
}
#if defined(__AVX512F__)
typedef double Vector8d __attribute__((vector_size(64)));
extern "C" {
[[gnu::const]] Vector8d _ZGVeN8v_sin(Vector8d);
[[gnu::const]] Vector8d _ZGVeN8v_cos(Vector8d);
[[gnu::const]] Vector8d _ZGVeN8v_exp(Vector8d);
[[gnu::const]] Vector8d _ZGVeN8v_log(Vector8d);
}
#define DSNS_VECTOR_FUNCTION(name)       \
  [](auto a) DSNS_INLINE_LAMBDA {        \
    if constexpr (sizeof(a) == 64)       \
      return detail::_ZGVeN8v_##name(a); \
    else                                 \
      return detail::_ZGVdN4v_##name(a); \
  }
inline constexpr int vector_function_lanes = 8;
#else
#define DSNS_VECTOR_FUNCTION(name) [](detail::Vector4d a) { return detail::_ZGVdN4v_##name(a); }
inline constexpr int vector_function_lanes = 4;
#endif
#else
#define DSNS_VECTOR_FUNCTION(name) 0
inline constexpr int vector_function_lanes = 0;
#endif

/// A function of glibc's vector library, as many lanes at a time as it takes, or `scalar` lane by lane.
template <class T, int L, class Vectors, class Scalar>
DSNS_INLINE Batch<T, L> by_vectors(const Batch<T, L>& x, [[maybe_unused]] const Vectors& vectors,
                                   const Scalar& scalar) {
  if constexpr (vector_function_lanes > 0 && std::is_same_v<T, double> && L % 4 == 0) {
    constexpr int step = L < vector_function_lanes ? L : vector_function_lanes;
    Batch<T, L> r;
    if constexpr (L == step) {
      r.v = vectors(x.v);
    } else {
      for (int i = 0; i < L; i += step) {
        auto part = Batch<T, step>::load(reinterpret_cast<const T*>(&x.v) + i);
        part.v = vectors(part.v);
        part.store(reinterpret_cast<T*>(&r.v) + i);
      }
    }
    return r;
  } else {
    return Batch<T, L>::each(scalar, x);
  }
}

}  // namespace detail

template <class T, int L>
DSNS_INLINE Batch<T, L> sin(const Batch<T, L>& x) {
  return detail::by_vectors(x, DSNS_VECTOR_FUNCTION(sin), [](T a) { return std::sin(a); });
}
template <class T, int L>
DSNS_INLINE Batch<T, L> cos(const Batch<T, L>& x) {
  return detail::by_vectors(x, DSNS_VECTOR_FUNCTION(cos), [](T a) { return std::cos(a); });
}
template <class T, int L>
DSNS_INLINE Batch<T, L> exp(const Batch<T, L>& x) {
  return detail::by_vectors(x, DSNS_VECTOR_FUNCTION(exp), [](T a) { return std::exp(a); });
}
template <class T, int L>
DSNS_INLINE Batch<T, L> log(const Batch<T, L>& x) {
  return detail::by_vectors(x, DSNS_VECTOR_FUNCTION(log), [](T a) { return std::log(a); });
}
#undef DSNS_VECTOR_FUNCTION

#define DSNS_LANE_BY_LANE(name)                                    \
  template <class T, int L>                                        \
  Batch<T, L> name(const Batch<T, L>& x) {                         \
    return Batch<T, L>::each([](T a) { return std::name(a); }, x); \
  }
DSNS_LANE_BY_LANE(sqrt)
DSNS_LANE_BY_LANE(cbrt)
DSNS_LANE_BY_LANE(expm1)
DSNS_LANE_BY_LANE(exp2)
DSNS_LANE_BY_LANE(log1p)
DSNS_LANE_BY_LANE(log2)
DSNS_LANE_BY_LANE(log10)
DSNS_LANE_BY_LANE(tan)
DSNS_LANE_BY_LANE(asin)
DSNS_LANE_BY_LANE(acos)
DSNS_LANE_BY_LANE(atan)
DSNS_LANE_BY_LANE(sinh)
DSNS_LANE_BY_LANE(cosh)
DSNS_LANE_BY_LANE(tanh)
DSNS_LANE_BY_LANE(asinh)
DSNS_LANE_BY_LANE(acosh)
DSNS_LANE_BY_LANE(atanh)
DSNS_LANE_BY_LANE(erf)
DSNS_LANE_BY_LANE(erfc)
DSNS_LANE_BY_LANE(floor)
DSNS_LANE_BY_LANE(ceil)
DSNS_LANE_BY_LANE(trunc)
DSNS_LANE_BY_LANE(round)
DSNS_LANE_BY_LANE(rint)
DSNS_LANE_BY_LANE(nearbyint)
#undef DSNS_LANE_BY_LANE

template <class T, int L>
Batch<T, L> abs(const Batch<T, L>& x) {
  return select(x < 0, -x, x);
}
#define DSNS_PAIR_BY_PAIR(name)                                               \
  template <class T, int L>                                                   \
  Batch<T, L> name(const Batch<T, L>& x, const Batch<T, L>& y) {              \
    return Batch<T, L>::each([](T a, T b) { return std::name(a, b); }, x, y); \
  }
DSNS_PAIR_BY_PAIR(pow)
DSNS_PAIR_BY_PAIR(hypot)
DSNS_PAIR_BY_PAIR(atan2)
DSNS_PAIR_BY_PAIR(copysign)
DSNS_PAIR_BY_PAIR(fmod)
DSNS_PAIR_BY_PAIR(remainder)
#undef DSNS_PAIR_BY_PAIR
template <class T, int L>
Batch<T, L> fma(const Batch<T, L>& x, const Batch<T, L>& y, const Batch<T, L>& z) {
  return Batch<T, L>::each([](T a, T b, T c) { return std::fma(a, b, c); }, x, y, z);
}
template <class T, int L>
Batch<T, L> sigmoid(const Batch<T, L>& x) {
  const Batch<T, L> e = exp(-abs(x));
  return select(x < 0, e, Batch<T, L>(1)) / (1 + e);
}
template <class T, int L>
Batch<T, L> softplus(const Batch<T, L>& x) {
  return select(x > 0, x, Batch<T, L>(0)) + log1p(exp(-abs(x)));
}
template <class T, int L>
Batch<T, L> silu(const Batch<T, L>& x) {
  return x * sigmoid(x);
}
template <class T, int L>
Batch<T, L> sqr(const Batch<T, L>& x) {
  return x * x;
}

}  // namespace dsns

template <class T, int L>
class std::numeric_limits<dsns::Batch<T, L>> : public std::numeric_limits<T> {};
