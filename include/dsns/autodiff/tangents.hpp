#pragma once
/// The N partial derivatives of a Dual: an array, kept in one vector register where N numbers fit.
#include <dsns/autodiff/scalar.hpp>

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <type_traits>
#include <utility>

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

/// An array that is copied entry by entry: g++ copies others in pieces that do not match the entries, and stalls.
template <class T, int N>
struct Entries {
  T entries[std::size_t(N)];

  Entries() = default;
  template <std::same_as<T>... X>
  requires(sizeof...(X) == N) DSNS_INLINE Entries(const X&... x) : entries{x...} {}
  DSNS_INLINE Entries(const Entries& x) : Entries(x, every) {}
  DSNS_INLINE Entries(Entries&& x) : Entries(std::move(x), every) {}
  DSNS_INLINE Entries& operator=(const Entries& x) {
    assign(x, every);
    return *this;
  }
  DSNS_INLINE Entries& operator=(Entries&& x) {
    assign(std::move(x), every);
    return *this;
  }
  ~Entries() = default;

  DSNS_INLINE const T& operator[](std::size_t i) const { return entries[i]; }
  DSNS_INLINE T& operator[](std::size_t i) { return entries[i]; }
  const T* begin() const { return entries; }
  const T* end() const { return entries + N; }
  T* begin() { return entries; }
  T* end() { return entries + N; }
  static constexpr std::size_t size() { return N; }
  operator std::array<T, std::size_t(N)>() const {
    std::array<T, std::size_t(N)> x;
    std::copy(begin(), end(), x.begin());
    return x;
  }

 private:
  static constexpr auto every = std::make_index_sequence<std::size_t(N)>{};
  template <std::size_t... i>
  DSNS_INLINE Entries(const Entries& x, std::index_sequence<i...>) : entries{x.entries[i]...} {}
  template <std::size_t... i>
  DSNS_INLINE Entries(Entries&& x, std::index_sequence<i...>) : entries{std::move(x.entries[i])...} {}
  template <std::size_t... i>
  DSNS_INLINE void assign(const Entries& x, std::index_sequence<i...>) {
    ((entries[i] = x.entries[i]), ...);
  }
  template <std::size_t... i>
  DSNS_INLINE void assign(Entries&& x, std::index_sequence<i...>) {
    ((entries[i] = std::move(x.entries[i])), ...);
  }
};

template <class T, int N>
using TangentArray = std::conditional_t<std::is_trivially_copyable_v<T> && std::is_arithmetic_v<Passive<T>>,
                                        std::array<T, std::size_t(N)>, Entries<T, N>>;

}  // namespace detail

/// Left uninitialised by the default constructor, as numbers are.
template <class T, int N>
struct Tangents : detail::TangentArray<T, N> {
  static constexpr bool is_vector = false;

  Tangents() = default;
  Tangents(const std::array<T, std::size_t(N)>& x) { std::copy(x.begin(), x.end(), this->begin()); }
  template <std::convertible_to<T>... X>
  requires(sizeof...(X) == N) Tangents(const X&... x) : Base{static_cast<T>(x)...} {}
  DSNS_INLINE static Tangents zero() {
    Tangents r;
    visit([&](std::size_t i) DSNS_INLINE_LAMBDA { r[i] = T(0); });
    return r;
  }
  DSNS_INLINE static Tangents unit(int k) {
    Tangents r;
    visit([&](std::size_t i) DSNS_INLINE_LAMBDA { r[i] = T(i == std::size_t(k) ? 1 : 0); });
    return r;
  }

  /// op(x ...), direction by direction.
  template <class Op, class... X>
  DSNS_INLINE static Tangents each(const Op& op, const X&... x) {
    Tangents r;
    visit([&](std::size_t i) DSNS_INLINE_LAMBDA { r[i] = op(x[i]...); });
    return r;
  }
  DSNS_INLINE Tangents& operator+=(Tangents&& x) {
    visit([&](std::size_t i) DSNS_INLINE_LAMBDA { (*this)[i] += std::move(x[i]); });
    return *this;
  }
  DSNS_INLINE Tangents& operator-=(Tangents&& x) {
    visit([&](std::size_t i) DSNS_INLINE_LAMBDA { (*this)[i] -= std::move(x[i]); });
    return *this;
  }

 private:
  using Base = detail::TangentArray<T, N>;

  /// Few entries without a loop, which would keep them from registers.
  template <class Visit>
  DSNS_INLINE static void visit(const Visit& f) {
    if constexpr (N <= 8) [&]<std::size_t... i>(std::index_sequence<i...>) DSNS_INLINE_LAMBDA {
        (f(i), ...);
      }
    (std::make_index_sequence<std::size_t(N)>{});
    else for (std::size_t i = 0; i < N; ++i) f(i);
  }
};

#if defined(__GNUC__)
template <class T, int N>
requires detail::fits_vector<T, N>
struct Tangents<T, N> {
  static constexpr bool is_vector = true;
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

  template <std::convertible_to<T>... X>
  requires(sizeof...(X) == N) DSNS_INLINE Tangents(const X&... x) : v{static_cast<T>(x)...} {}

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

namespace detail {

/// For the upper triangle of a 2 x 2 matrix, row by row: x of the row, and of the column.
template <class T>
DSNS_INLINE auto of_row(const Tangents<T, 2>& x) {
  return Tangents<T, 3>(__builtin_shufflevector(x.v, x.v, 0, 0, 1, 1));
}
template <class T>
DSNS_INLINE auto of_column(const Tangents<T, 2>& x) {
  return Tangents<T, 3>(__builtin_shufflevector(x.v, x.v, 0, 1, 1, 1));
}

}  // namespace detail
#endif

}  // namespace dsns
