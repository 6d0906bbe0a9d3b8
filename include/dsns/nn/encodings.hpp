#pragma once
/// What the network sees of a point s of the sphere and a time t: functions of them that span many scales, so that the
/// network need not make fine detail out of plain coordinates. Space and time are encoded apart, one above the other.
#include <dsns/autodiff/jet_layout.hpp>
#include <dsns/core/types.hpp>
#include <dsns/sphere/harmonics.hpp>
#include <dsns/surface/scalar_jets.hpp>

#include <cmath>
#include <type_traits>

namespace dsns {

/// Space: real spherical harmonics of degree l = 1 to `harmonic_degree` (0: none), root mean square l^-harmonic_decay,
/// and/or sin, cos(space_base 2^k x) of each coordinate, k < space_octaves. Decay trades detail for smoothness: with 0
/// positions of limbed bodies are fitted best, with 2 curvatures of smooth bodies are some hundred times better.
/// Time: sin, cos(pi k t), k = 1 .. time_frequencies, and/or sin, cos(time_base 2^k t), k < time_octaves.
struct SurfaceEncoding {
  int harmonic_degree = 10;
  double harmonic_decay = 0.5;
  int space_octaves = 0;
  double space_base = 0.1;
  int time_frequencies = 8;
  int time_octaves = 0;
  double time_base = 0.1;

  Index space_features() const {
    return (harmonic_degree > 0 ? harmonic_count(harmonic_degree) - 1 : 0) + 6 * Index(space_octaves);
  }
  Index time_features() const { return 2 * (Index(time_frequencies) + time_octaves); }
  Index features() const { return space_features() + time_features(); }

  /// T any scalar: derivatives ride along.
  template <class T>
  Eigen::VectorX<T> space(const Vec3<T>& s) const {
    Eigen::VectorX<T> out(space_features());
    Index row = 0;
    if (harmonic_degree > 0) {
      row = harmonic_count(harmonic_degree) - 1;
      out.head(row) = harmonics<T>(s, harmonic_degree).tail(row);
      for (Index k = 0; k < row; ++k) out[k] *= harmonic_scale(k);
    }
    append_space_waves(out, row, s);
    return out;
  }
  template <class T>
  Eigen::VectorX<T> time(const T& t) const {
    Eigen::VectorX<T> out(time_features());
    Index row = 0;
    for (int k = 1; k <= time_frequencies; ++k) append_waves(out, row, T(pi * k * t));
    for (int k = 0; k < time_octaves; ++k) append_waves(out, row, T(std::ldexp(time_base, k) * t));
    return out;
  }

  /// Writes the features of points first .. first + n - 1 at time t to x, features x (n blocks), as the layout says.
  template <class T>
  void fill(const ChartBatch& charts, Index first, Index n, double t, const JetLayout& layout,
            Eigen::MatrixX<T>& x) const {
    x.setZero();
    const bool framed = layout.space_directions() > 0;
    const ChartBatch here{charts.s.middleCols(first, n), framed ? charts.e1.middleCols(first, n) : Mat3X(),
                          framed ? charts.e2.middleCols(first, n) : Mat3X()};
    if (harmonic_degree > 0) fill_harmonics(here, layout, x);
    if (space_octaves > 0) {
      if (layout.bends())
        fill_waves(here, x, [&](Index i) { return detail::chart_jet(here, i); });
      else if (framed)
        fill_waves(here, x, [&](Index i) { return detail::chart_dual(here, i); });
      else
        fill_waves(here, x, [&](Index i) { return Vec3d(here.s.col(i)); });
    }
    const auto moving = time(detail::TimeDual::variable(t, 0));
    const Index rows = space_features();
    for (Index k = 0; k < moving.size(); ++k) {
      x.row(rows + k).head(n).setConstant(T(moving[k].f));
      if (layout.time >= 0) x.row(rows + k).segment((1 + layout.time) * n, n).setConstant(T(moving[k].g[0]));
    }
  }

 private:
  template <class T>
  void fill_harmonics(const ChartBatch& here, const JetLayout& layout, Eigen::MatrixX<T>& x) const {
    using M =
        Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;  // whose transpose has columns of points
    const Index n = here.size(), count = harmonic_count(harmonic_degree) - 1;
    Eigen::VectorX<T> scale(count);
    for (Index l = 1; l <= harmonic_degree; ++l)
      scale.segment(l * l - 1, 2 * l + 1).setConstant(T(harmonic_scale(l * l - 1)));
    const auto write = [&](Index block, const M& y) {
      x.block(0, block * n, count, n) = scale.asDiagonal() * y.rightCols(count).transpose();
    };
    if (layout.bends()) {
      const auto h = harmonic_jets<M>(here, harmonic_degree);
      const M* const blocks[] = {&h.y, &h.yu, &h.yv, &h.yuu, &h.yuv, &h.yvv};
      for (Index b = 0; b < 6; ++b) write(b, *blocks[b]);
    } else if (layout.space_directions() > 0) {
      const auto h = harmonic_tangents<M>(here, harmonic_degree);
      write(0, h.y);
      write(1, h.yu);
      write(2, h.yv);
    } else {
      write(0, harmonics<M>(here.s, harmonic_degree));
    }
  }
  template <class T, class Chart>
  void fill_waves(const ChartBatch& here, Eigen::MatrixX<T>& x, const Chart& chart) const {
    const Index n = here.size(), rows = 6 * Index(space_octaves), begin = space_features() - rows;
    for (Index i = 0; i < n; ++i) {
      const auto s = chart(i);
      using X = std::decay_t<decltype(s[0])>;
      Eigen::VectorX<X> waves(rows);
      append_space_waves(waves, 0, s);
      for (Index k = 0; k < rows; ++k) {
        if constexpr (std::is_same_v<X, double>) {
          x(begin + k, i) = T(waves[k]);
        } else {
          x(begin + k, i) = T(waves[k].f);
          for (Index d = 0; d < 2; ++d) x(begin + k, (1 + d) * n + i) = T(waves[k].g[std::size_t(d)]);
          if constexpr (requires { waves[k].h; })
            for (Index d = 0; d < 3; ++d) x(begin + k, (3 + d) * n + i) = T(waves[k].h[std::size_t(d)]);
        }
      }
    }
  }

  double harmonic_scale(Index k) const {
    const double degree = std::floor(std::sqrt(double(k + 1)));
    return std::sqrt(4 * pi) * std::pow(degree, -harmonic_decay);
  }
  template <class T>
  void append_space_waves(Eigen::VectorX<T>& out, Index row, const Vec3<T>& s) const {
    for (int k = 0; k < space_octaves; ++k)
      for (const T& x : s) append_waves(out, row, T(std::ldexp(space_base, k) * x));
  }
  template <class T>
  static void append_waves(Eigen::VectorX<T>& out, Index& row, const T& angle) {
    using std::cos, std::sin;
    out[row++] = sin(angle);
    out[row++] = cos(angle);
  }
};

/// The harmonic embedding of the D-SNS paper: sin, cos(0.1 2^k x), k = 0 .. 9, of x, y, z and t; 80 features.
inline SurfaceEncoding paper_encoding() {
  SurfaceEncoding e;
  e.harmonic_degree = 0;
  e.space_octaves = e.time_octaves = 10;
  e.time_frequencies = 0;
  return e;
}

}  // namespace dsns
