#pragma once
/// Harmonics at as many points side by side as a vector register holds: the loops beneath sphere/harmonics.hpp.
/// With w = x + iy, a = e1.x + i e1.y, alpha = e1.z and b, beta likewise of e2, the harmonics of order m are Re and Im of
///   Y   = P w^m
///   Yu  = P' alpha w^m + P m a w^(m-1)                                                         in the chart of s, e1, e2
///   Yuv = P'' alpha beta w^m + P' m (alpha b + beta a) w^(m-1) + P m (m - 1) a b w^(m-2)
///   Yuu = likewise with a for b, less P' z w^m + P m w^m, as s_uu = -s;   Yvv = -l(l + 1) Y - Yuu.
/// All but P, P', P'' are the same for every degree and wait in registers while the degree runs.
#include <dsns/autodiff/batch.hpp>
#include <dsns/sphere/legendre.hpp>

#include <algorithm>
#include <array>

namespace dsns::detail {

/// A complex number a lane.
template <class B>
struct Plane {
  B re, im;
  DSNS_INLINE friend Plane operator+(const Plane& a, const Plane& b) { return {a.re + b.re, a.im + b.im}; }
  DSNS_INLINE friend Plane operator-(const Plane& a, const Plane& b) { return {a.re - b.re, a.im - b.im}; }
  DSNS_INLINE friend Plane operator*(const B& a, const Plane& b) { return {a * b.re, a * b.im}; }
  DSNS_INLINE friend Plane operator*(const Plane& a, const Plane& b) {
    return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
  }
};

/// Columns of n points with their frames; values alone ask for s only.
struct ChartColumns {
  const Mat3X &s, &e1, &e2;
};

/// One coordinate of the points from `first` on, the last one repeated where they run out.
template <class B>
B lanes(const Mat3X& x, Index row, Index first) {
  using S = std::remove_cvref_t<decltype(B()[0])>;
  std::array<S, std::size_t(B::lanes)> values;
  for (Index i = 0; i < B::lanes; ++i) values[std::size_t(i)] = S(x(row, std::min(first + i, x.cols() - 1)));
  return B::load(values.data());
}

/// What multiplies P, P' and P'' in a second derivative.
template <class B>
struct SecondFactors {
  Plane<B> p, dp, ddp;
};
/// The plane's factors of order m: y multiplies P; u[0], v[0] multiply P and u[1], v[1] multiply P'.
template <int Order, class B>
struct PlaneFactors {
  Plane<B> y;
  std::array<Plane<B>, 2> u, v;
  SecondFactors<B> uu, uv, vv;
};

/// The lanes' points on their way through the orders m = 0, 1, ...
template <int Order, class B>
class LanePoints {
 public:
  LanePoints(const ChartColumns& c, Index first)
      : z(lanes<B>(c.s, 2, first)), w_{lanes<B>(c.s, 0, first), lanes<B>(c.s, 1, first)}, power_{B(1), B(0)} {
    if constexpr (Order > 0) {
      a_ = {lanes<B>(c.e1, 0, first), lanes<B>(c.e1, 1, first)};
      b_ = {lanes<B>(c.e2, 0, first), lanes<B>(c.e2, 1, first)};
      alpha_ = lanes<B>(c.e1, 2, first);
      beta_ = lanes<B>(c.e2, 2, first);
      before_ = before_that_ = {B(0), B(0)};
    }
  }

  /// From order m - 1 to m.
  DSNS_INLINE void advance() {
    before_that_ = before_;
    before_ = power_;
    power_ = w_ * power_;
  }

  DSNS_INLINE PlaneFactors<Order, B> factors(int m) const {
    PlaneFactors<Order, B> out;
    out.y = power_;
    if constexpr (Order > 0) {
      const Plane<B> slope = B(m) * before_;
      out.u = {a_ * slope, alpha_ * power_};
      out.v = {b_ * slope, beta_ * power_};
      if constexpr (Order > 1) {
        const Plane<B> bend = B(double(m) * (m - 1)) * before_that_, fall = z * power_, shrink = B(m) * power_;
        const B two = B(2);
        out.uu = {a_ * (a_ * bend) - shrink, (two * alpha_) * out.u[0] - fall, (alpha_ * alpha_) * power_};
        out.uv = {a_ * (b_ * bend), alpha_ * out.v[0] + beta_ * out.u[0], (alpha_ * beta_) * power_};
        out.vv = {b_ * (b_ * bend) - shrink, (two * beta_) * out.v[0] - fall, (beta_ * beta_) * power_};
      }
    }
    return out;
  }

  B z;

 private:
  Plane<B> w_, power_, before_, before_that_, a_, b_;
  B alpha_, beta_;
};

/// Calls visit(l, P_lm, P'_lm, P''_lm) for l = m, m + 1, ... up to the degree; derivatives above Order are zero.
template <int Order, class B, class S, class Visit>
DSNS_INLINE void walk_degrees(const LegendreTable<S>& table, int m, const B& z, const Visit& visit) {
  const LegendreStep<S>*p_step = table.column(m) + 1, *q_step = table.column(m + 1), *r_step = table.column(m + 2) - 1;
  const auto next = [&z](const LegendreStep<S>& step, B& value, B& below) DSNS_INLINE_LAMBDA {
    const B above = (B(step.a) * z) * value - B(step.b) * below;
    below = value;
    value = above;
  };
  B p(-p_step->b), p_below(0), q(0), q_below(1), r(1), r_below(0);
  for (int l = m;; ++l) {
    visit(l, p, Order > 0 ? B(p_step->first) * q : B(0), Order > 1 ? B(p_step->second) * r : B(0));
    if (l == table.degree()) break;
    next(*++p_step, p, p_below);
    if constexpr (Order > 0) next(*++q_step, q, q_below);
    if constexpr (Order > 1) next(*++r_step, r, r_below);
  }
}

/// The entries of an n x count matrix, of which lanes of one column are written at a time.
template <class M>
struct BasisEntries {
  typename M::Scalar* data;
  Index rows, columns;
  explicit BasisEntries(M& m) : data(m.data()), rows(m.rows()), columns(m.cols()) {}

  template <class B>
  DSNS_INLINE void store(Index row, Index column, const B& x) const {
    if constexpr (M::IsRowMajor)
      for (int i = 0; i < B::lanes; ++i) data[(row + i) * columns + column] = x[i];
    else
      x.store(data + column * rows + row);
  }
};

/// y, yu, yv, yuu, yuv, yvv as far as Order goes.
template <int Order, class M>
using BasisMatrices = std::array<M, Order == 0   ? 1
                                    : Order == 1 ? 3
                                                 : 6>;

/// The basis at n points, in the memory of `out` where it fits.
template <int Order, class M>
BasisMatrices<Order, M> harmonic_basis(const ChartColumns& c, int degree, BasisMatrices<Order, M> out) {
  using S = typename M::Scalar;
  using B = Batch<S>;
  // Points that go through an order together, so that a column is written in runs of whole cache lines
  constexpr std::size_t tile = M::IsRowMajor ? 1 : std::max<std::size_t>(32 / std::size_t(B::lanes), 1);
  const LegendreTable<S>& table = legendre_table<S>(degree);
  const Index n = c.s.cols(), rows = std::max(n, Index(B::lanes)), count = Index(degree + 1) * (degree + 1);
  for (M& m : out) m.resize(rows, count);
  const auto entries = [&]<std::size_t... K>(std::index_sequence<K...>) {
    return std::array{BasisEntries<M>(out[K])...};
  }
  (std::make_index_sequence<std::tuple_size_v<BasisMatrices<Order, M>>>());

  std::vector<Index> first;  // the last register begins where it ends with the last point
  for (Index i = 0; i < n; i += B::lanes) first.push_back(std::min(i, rows - B::lanes));
  for (std::size_t begin = 0; begin < first.size(); begin += tile) {
    const std::size_t end = std::min(begin + tile, first.size());
    std::vector<LanePoints<Order, B>> points;
    for (std::size_t t = begin; t < end; ++t) points.emplace_back(c, first[t]);
    for (int m = 0; m <= degree; ++m)
      for (std::size_t t = begin; t < end; ++t) {
        auto& at = points[t - begin];
        if (m > 0) at.advance();
        const PlaneFactors<Order, B> factors = at.factors(m);
        const Index row = first[t];
        walk_degrees<Order>(table, m, at.z, [&](int l, const B& p, const B& dp, const B& ddp) DSNS_INLINE_LAMBDA {
          const auto write = [&](Index k, auto part) DSNS_INLINE_LAMBDA {
            const B y = p * part(factors.y);
            entries[0].store(row, k, y);
            if constexpr (Order > 0) {
              entries[1].store(row, k, p * part(factors.u[0]) + dp * part(factors.u[1]));
              entries[2].store(row, k, p * part(factors.v[0]) + dp * part(factors.v[1]));
            }
            if constexpr (Order > 1) {
              const auto second = [&](const SecondFactors<B>& f) DSNS_INLINE_LAMBDA {
                return p * part(f.p) + dp * part(f.dp) + ddp * part(f.ddp);
              };
              const B yuu = second(factors.uu);
              entries[3].store(row, k, yuu);
              entries[4].store(row, k, second(factors.uv));
              entries[5].store(row, k, B(-double(l) * (l + 1)) * y - yuu);
            }
          };
          const Index middle = Index(l) * l + l;
          write(middle + m, [](const Plane<B>& x) DSNS_INLINE_LAMBDA { return x.re; });
          if (m > 0) write(middle - m, [](const Plane<B>& x) DSNS_INLINE_LAMBDA { return x.im; });
        });
      }
  }
  if (rows > n)
    for (M& m : out) m = M(m.topRows(n));
  return out;
}

/// f, fu, fv, fuu, fuv, fvv as far as Order goes of f = sum over k of c_k Y_k, each C x n, without the basis in memory:
/// the sum over the degrees of one order meets the plane's factors once.
template <int Order, int C>
auto harmonic_sums(const Eigen::Matrix<double, Eigen::Dynamic, C>& coefficients, const ChartColumns& c, int degree) {
  using B = Batch<double>;
  constexpr std::size_t parts = Order == 0 ? 1 : Order == 1 ? 3 : 6;
  const LegendreTable<double>& table = legendre_table<double>(degree);
  const Index n = c.s.cols(), count = coefficients.rows();
  std::array<Eigen::Matrix<double, C, Eigen::Dynamic>, parts> out;
  for (auto& m : out) m.resize(C, n);
  for (Index first = 0; first < n; first += B::lanes) {
    LanePoints<Order, B> at(c, first);
    std::array<std::array<B, parts>, std::size_t(C)> total;
    for (auto& t : total) t.fill(B(0));
    for (int m = 0; m <= degree; ++m) {
      if (m > 0) at.advance();
      // Over the degrees, of P, P', P'' against the coefficients of the cosines and of the sines
      std::array<std::array<Plane<B>, std::size_t(Order + 1)>, std::size_t(C)> sum;
      for (auto& s : sum) s.fill({B(0), B(0)});
      walk_degrees<Order>(table, m, at.z, [&](int l, const B& p, const B& dp, const B& ddp) DSNS_INLINE_LAMBDA {
        const double* middle = coefficients.data() + Index(l) * l + l;
        for (std::size_t k = 0; k < std::size_t(C); ++k, middle += count) {
          const B re(middle[m]), im(middle[-m]);  // at m = 0 the plane's factors have no imaginary part
          sum[k][0] = sum[k][0] + Plane<B>{re * p, im * p};
          if constexpr (Order > 0) sum[k][1] = sum[k][1] + Plane<B>{re * dp, im * dp};
          if constexpr (Order > 1) sum[k][2] = sum[k][2] + Plane<B>{re * ddp, im * ddp};
        }
      });
      const PlaneFactors<Order, B> factors = at.factors(m);
      const auto dot = [](const Plane<B>& a, const Plane<B>& b)
                           DSNS_INLINE_LAMBDA { return a.re * b.re + a.im * b.im; };
      for (std::size_t k = 0; k < std::size_t(C); ++k) {
        total[k][0] += dot(sum[k][0], factors.y);
        if constexpr (Order > 0) {
          total[k][1] += dot(sum[k][0], factors.u[0]) + dot(sum[k][1], factors.u[1]);
          total[k][2] += dot(sum[k][0], factors.v[0]) + dot(sum[k][1], factors.v[1]);
        }
        if constexpr (Order > 1) {
          const auto second = [&](const SecondFactors<B>& f) DSNS_INLINE_LAMBDA {
            return dot(sum[k][0], f.p) + dot(sum[k][1], f.dp) + dot(sum[k][2], f.ddp);
          };
          total[k][3] += second(factors.uu);
          total[k][4] += second(factors.uv);
          total[k][5] += second(factors.vv);
        }
      }
    }
    for (std::size_t k = 0; k < std::size_t(C); ++k)
      for (std::size_t part = 0; part < parts; ++part)
        for (int i = 0; i < std::min<Index>(B::lanes, n - first); ++i)
          out[part](Index(k), first + i) = total[k][part][i];
  }
  return out;
}

}  // namespace dsns::detail
