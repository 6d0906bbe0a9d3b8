#pragma once
/// Products of the long, thin matrices that tiles of points through a network are. Eigen's products are made for large
/// squares and copy both factors first; here the left factor alone is copied, in panels that stay in the first cache, and
/// a block of the result is summed in registers.
#include <dsns/autodiff/scalar.hpp>
#include <dsns/autodiff/tangents.hpp>

#include <Eigen/Core>

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstring>
#include <type_traits>
#include <utility>

namespace dsns {

namespace detail {

/// Entry (i, j) at data[i rows + j cols].
template <class T>
struct StridedView {
  const T* data;
  std::ptrdiff_t rows, cols;
};

/// What fits the registers: blocks of `vectors` x `columns` sums, at most `depth` terms at a time.
template <class T>
struct ProductBlock {
  static constexpr int lanes = int(vector_bytes / sizeof(T));
  static constexpr int vectors = vector_bytes == 64 ? 4 : 2;  // of 32 or 16 registers, the sums take 24 or 12
  static constexpr int columns = 6;
  static constexpr int rows = vectors * lanes;
  static constexpr int depth = 256;
  static constexpr int gathered_columns = columns * int(64 / sizeof(T));
  typedef T Vector __attribute__((vector_size(std::max(vector_bytes, std::size_t(16)))));
};

template <class V, class T>
DSNS_INLINE V load_vector(const T* from) {
  V v;
  std::memcpy(&v, from, sizeof(v));
  return v;
}

/// The product of a panel, R vectors of rows and `depth` columns one after the other, and N columns; `rows` of it are
/// written or added to c, columns `stride` apart.
template <class T, int R, int N, bool add>
void multiply_block(std::ptrdiff_t depth, const T* panel, StridedView<T> b, T* c, std::ptrdiff_t stride,
                    std::ptrdiff_t rows) {
  using Block = ProductBlock<T>;
  using V = typename Block::Vector;
  V sums[std::size_t(R * N)] = {};
  const auto all = []<std::size_t... I>(std::index_sequence<I...>, const auto& body) DSNS_INLINE_LAMBDA {
    (body(std::integral_constant<std::size_t, I>{}), ...);
  };
  constexpr auto entries = std::make_index_sequence<std::size_t(R * N)>{};
  constexpr auto vectors = std::make_index_sequence<std::size_t(R)>{};
  for (std::ptrdiff_t k = 0; k < depth; ++k, panel += R * Block::lanes, b.data += b.rows) {
    V a[std::size_t(R)];
    all(vectors, [&](auto i) DSNS_INLINE_LAMBDA { a[i] = load_vector<V>(panel + i * Block::lanes); });
    all(entries, [&](auto i) DSNS_INLINE_LAMBDA { sums[i] += a[i % R] * b.data[std::ptrdiff_t(i / R) * b.cols]; });
  }
  if (rows == R * Block::lanes) {
    all(entries, [&](auto i) DSNS_INLINE_LAMBDA {
      T* const to = c + std::ptrdiff_t(i / R) * stride + std::ptrdiff_t(i % R) * Block::lanes;
      if constexpr (add) sums[i] += load_vector<V>(to);
      std::memcpy(to, &sums[i], sizeof(V));
    });
    return;
  }
  T whole[R * N * Block::lanes];
  std::memcpy(whole, sums, sizeof(whole));
  for (int j = 0; j < N; ++j)
    for (std::ptrdiff_t i = 0; i < rows; ++i) {
      const T sum = whole[j * R * Block::lanes + i];
      c[j * stride + i] = add ? c[j * stride + i] + sum : sum;
    }
}

/// The panel of a that multiply_block wants, zeros below its last row.
template <class T, int R>
void pack_panel(const StridedView<T>& a, std::ptrdiff_t rows, std::ptrdiff_t depth, T* panel) {
  constexpr std::ptrdiff_t height = R * ProductBlock<T>::lanes;
  if (rows < height) std::fill_n(panel, height * depth, T(0));
  if (a.rows == 1) {
    for (std::ptrdiff_t k = 0; k < depth; ++k) std::copy_n(a.data + k * a.cols, rows, panel + k * height);
  } else {
    // In pieces that are read along lines of the cache, few enough not to drive one another out.
    constexpr std::ptrdiff_t lines = 8, length = 16;
    for (std::ptrdiff_t i = 0; i < rows; i += lines)
      for (std::ptrdiff_t first = 0; first < depth; first += length)
        for (std::ptrdiff_t k = first; k < std::min(first + length, depth); ++k)
          for (std::ptrdiff_t r = i; r < std::min(i + lines, rows); ++r)
            panel[k * height + r] = a.data[r * a.rows + k * a.cols];
  }
}

/// One panel of a times n columns of b.
template <class T, int R, bool add>
void multiply_panel(const StridedView<T>& a, const StridedView<T>& b, std::ptrdiff_t rows, std::ptrdiff_t depth,
                    std::ptrdiff_t n, std::ptrdiff_t group_stride, T* c, std::ptrdiff_t stride) {
  using Block = ProductBlock<T>;
  alignas(64) T panel[Block::rows * Block::depth];
  pack_panel<T, R>(a, rows, depth, panel);
  std::ptrdiff_t j = 0;
  for (; j + Block::columns <= n; j += Block::columns)
    multiply_block<T, R, Block::columns, add>(
        depth, panel, {b.data + j / Block::columns * group_stride, b.rows, b.cols}, c + j * stride, stride, rows);
  for (; j < n; ++j)
    multiply_block<T, R, 1, add>(
        depth, panel, {b.data + j / Block::columns * group_stride + j % Block::columns * b.cols, b.rows, b.cols},
        c + j * stride, stride, rows);
}

template <class T, bool add>
void multiply_depth(const StridedView<T>& a, StridedView<T> b, std::ptrdiff_t m, std::ptrdiff_t depth, std::ptrdiff_t n,
                    T* c, std::ptrdiff_t stride) {
  using Block = ProductBlock<T>;
  // Rows of b far apart fall on the same few lines of the cache: their entries are gathered first.
  const bool far_apart = b.cols == 1 && b.rows >= 512;
  alignas(64) T gathered[Block::gathered_columns * Block::depth];
  const std::ptrdiff_t width = far_apart ? Block::gathered_columns : n;
  for (std::ptrdiff_t first = 0; first < n; first += width) {
    const std::ptrdiff_t columns = std::min(width, n - first);
    StridedView<T> part{b.data + first * b.cols, b.rows, b.cols};
    std::ptrdiff_t group_stride = Block::columns * b.cols;
    if (far_apart) {
      for (std::ptrdiff_t j = 0; j < columns; j += Block::columns)
        for (std::ptrdiff_t k = 0; k < depth; ++k)
          std::copy_n(part.data + k * b.rows + j, std::min<std::ptrdiff_t>(Block::columns, columns - j),
                      gathered + (j * depth + k * Block::columns));
      part = {gathered, Block::columns, 1};
      group_stride = depth * Block::columns;
    }
    for (std::ptrdiff_t i = 0; i < m; i += Block::rows) {
      const std::ptrdiff_t rows = std::min<std::ptrdiff_t>(Block::rows, m - i);
      const auto panel = [&]<int R>(std::integral_constant<int, R>) {
        multiply_panel<T, R, add>({a.data + i * a.rows, a.rows, a.cols}, part, rows, depth, columns, group_stride,
                                  c + first * stride + i, stride);
      };
      if constexpr (Block::vectors == 4) {
        if (rows > 3 * Block::lanes) {
          panel(std::integral_constant<int, 4>{});
          continue;
        }
        if (rows > 2 * Block::lanes) {
          panel(std::integral_constant<int, 3>{});
          continue;
        }
      }
      if (rows > Block::lanes)
        panel(std::integral_constant<int, 2>{});
      else
        panel(std::integral_constant<int, 1>{});
    }
  }
}

/// c = a b, or c += a b, for c of m x n and `depth` terms a sum.
template <class T, bool add>
void multiply_strided(const StridedView<T>& a, const StridedView<T>& b, std::ptrdiff_t m, std::ptrdiff_t depth,
                      std::ptrdiff_t n, T* c, std::ptrdiff_t stride) {
  constexpr std::ptrdiff_t step = ProductBlock<T>::depth;
  for (std::ptrdiff_t k = 0; k < depth; k += step) {
    const StridedView<T> left{a.data + k * a.cols, a.rows, a.cols}, right{b.data + k * b.rows, b.rows, b.cols};
    const std::ptrdiff_t terms = std::min(step, depth - k);
    if (add || k > 0)
      multiply_depth<T, true>(left, right, m, terms, n, c, stride);
    else
      multiply_depth<T, false>(left, right, m, terms, n, c, stride);
  }
}

template <class M>
StridedView<typename M::Scalar> strided(const M& m) {
  return M::IsRowMajor ? StridedView<typename M::Scalar>{m.data(), m.outerStride(), m.innerStride()}
                       : StridedView<typename M::Scalar>{m.data(), m.innerStride(), m.outerStride()};
}

/// The same matrix as one of two types, for which Eigen's product is compiled once.
template <class M>
auto plain_view(M& m) {
  using T = std::remove_const_t<std::remove_pointer_t<decltype(m.data())>>;
  using Plain = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic,
                              std::remove_const_t<M>::IsRowMajor ? Eigen::RowMajor : Eigen::ColMajor>;
  using Entries = std::conditional_t<std::is_const_v<M>, const Plain, Plain>;
  return Eigen::Map<Entries, 0, Eigen::OuterStride<>>(m.data(), m.rows(), m.cols(),
                                                      Eigen::OuterStride<>(m.outerStride()));
}

template <class T>
inline constexpr bool has_vector_products = (std::is_same_v<T, float> || std::is_same_v<T, double>)&&vector_bytes >= 32;

template <bool add, class C, class A, class B>
void multiply(C&& c, const A& a, const B& b) {
  multiply_strided<typename A::Scalar, add>(strided(a), strided(b), a.rows(), a.cols(), b.cols(), c.data(),
                                            c.outerStride());
}

}  // namespace detail

/// c = a b, for matrices in memory or transposes of such; c, whose columns are contiguous, has that shape already and
/// overlaps neither.
/// accuracy equal to Eigen's product to rounding [autodiff/products_test]
template <class C, class A, class B>
void set_product(C&& c, const A& a, const B& b) {
  assert(c.rows() == a.rows() && c.cols() == b.cols() && a.cols() == b.rows());
  if constexpr (detail::has_vector_products<typename A::Scalar>) {
    if (a.cols() == 0)
      c.setZero();
    else
      detail::multiply<false>(c, a, b);
  } else if constexpr (std::is_floating_point_v<typename A::Scalar>) {
    detail::plain_view(c).noalias() = detail::plain_view(a) * detail::plain_view(b);
  } else {
    c.noalias() = a * b;
  }
}

/// c += a b, likewise.
template <class C, class A, class B>
void add_product(C&& c, const A& a, const B& b) {
  assert(c.rows() == a.rows() && c.cols() == b.cols() && a.cols() == b.rows());
  if constexpr (detail::has_vector_products<typename A::Scalar>)
    detail::multiply<true>(c, a, b);
  else if constexpr (std::is_floating_point_v<typename A::Scalar>)
    detail::plain_view(c).noalias() += detail::plain_view(a) * detail::plain_view(b);
  else
    c.noalias() += a * b;
}

}  // namespace dsns
