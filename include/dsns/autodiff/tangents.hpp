#pragma once
/// The N partial derivatives of a Dual: an array, kept in one vector register where N numbers fit.
#include <dsns/autodiff/scalar.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <type_traits>

namespace dsns {

namespace detail {

#if defined(__AVX512F__)
inline constexpr std::size_t vector_bytes = 64;
#elif defined(__AVX__)
inline constexpr std::size_t vector_bytes = 32;
#elif defined(__GNUC__)
inline constexpr std::size_t vector_bytes = 16;
#else
inline constexpr std::size_t vector_bytes = 0;
#endif

/// The next power of two.
constexpr std::size_t vector_length(int n) {
  std::size_t length = 1;
  while (length < std::size_t(n)) length *= 2;
  return length;
}
template <class T, int N>
inline constexpr bool fits_vector = (std::is_same_v<T, float> || std::is_same_v<T, double>)&&N > 1 &&
                                    vector_length(N) * sizeof(T) >= 16 && vector_length(N) * sizeof(T) <= vector_bytes;

}  // namespace detail

/// Left uninitialised by the default constructor, as numbers are.
template <class T, int N>
struct Tangents : std::array<T, std::size_t(N)> {
  Tangents() = default;
  Tangents(const std::array<T, std::size_t(N)>& x) : std::array<T, std::size_t(N)>(x) {}
  static Tangents zero() {
    Tangents r;
    r.fill(T(0));
    return r;
  }
  static Tangents unit(int k) {
    Tangents r = zero();
    r[std::size_t(k)] = T(1);
    return r;
  }

  /// op(x ...), direction by direction.
  template <class Op, class... X>
  DSNS_INLINE static Tangents each(const Op& op, const X&... x) {
    Tangents r;
    for (std::size_t i = 0; i < N; ++i) r[i] = op(x[i]...);
    return r;
  }
  DSNS_INLINE Tangents& operator+=(Tangents&& x) {
    for (std::size_t i = 0; i < N; ++i) (*this)[i] += std::move(x[i]);
    return *this;
  }
  DSNS_INLINE Tangents& operator-=(Tangents&& x) {
    for (std::size_t i = 0; i < N; ++i) (*this)[i] -= std::move(x[i]);
    return *this;
  }
};

#if defined(__GNUC__)
template <class T, int N>
requires detail::fits_vector<T, N>
struct Tangents<T, N> {
  static constexpr std::size_t length = detail::vector_length(N);
  typedef T Vector __attribute__((vector_size(length * sizeof(T))));

  Vector v;  // the entries behind the N-th are 0, or meaningless after an overflow

  Tangents() = default;
  DSNS_INLINE explicit Tangents(const Vector& x) : v(x) {}
  DSNS_INLINE Tangents(const std::array<T, std::size_t(N)>& x) : v{} {
    for (std::size_t i = 0; i < N; ++i) v[i] = x[i];
  }
  DSNS_INLINE static Tangents zero() { return Tangents(Vector{}); }
  DSNS_INLINE static Tangents unit(int k) {
    Vector r{};
    for (std::size_t i = 0; i < N; ++i) r[i] = i == std::size_t(k) ? T(1) : T(0);
    return Tangents(r);
  }

  static constexpr std::size_t size() { return N; }
  DSNS_INLINE T operator[](std::size_t i) const { return v[i]; }
  T& operator[](std::size_t i) { return begin()[i]; }
  const T* begin() const { return reinterpret_cast<const T*>(&v); }
  const T* end() const { return begin() + N; }
  T* begin() { return reinterpret_cast<T*>(&v); }
  T* end() { return begin() + N; }
  DSNS_INLINE operator std::array<T, std::size_t(N)>() const {
    std::array<T, std::size_t(N)> x;
    for (std::size_t i = 0; i < N; ++i) x[i] = v[i];
    return x;
  }

  template <class Op, class... X>
  DSNS_INLINE static Tangents each(const Op& op, const X&... x) {
    return Tangents(Vector(op(x.v...)));
  }
  DSNS_INLINE Tangents& operator+=(const Tangents& x) {
    v += x.v;
    return *this;
  }
  DSNS_INLINE Tangents& operator-=(const Tangents& x) {
    v -= x.v;
    return *this;
  }
};
#endif

}  // namespace dsns
