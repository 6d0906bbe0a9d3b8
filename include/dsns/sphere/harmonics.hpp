#pragma once
/// Real orthonormal spherical harmonics as polynomials in (x, y, z): no pole is special.
///   Y_lm = P_l|m|(z) Re (x + iy)^m  for m >= 0,   P_l|m|(z) Im (x + iy)^|m|  for m < 0,   index l^2 + l + m,
/// where P carries the normalisation and the factor sqrt(2) of m != 0.
///
///   const HarmonicJets h = harmonic_jets(charts_at(s), 30);      // n x 961 each: y, yu, yv, yuu, yuv, yvv
///   const Vec3d gradient = h.yu(i, k) * c.e1.col(i) + h.yv(i, k) * c.e2.col(i);
///   const auto f = harmonic_sum_jets<3>(coefficients, charts);   // 3 x n each, without the basis in memory
///
/// Derivatives in the chart of a point are the gradient's components in its frame and the covariant Hessian's.
#include <dsns/core/errors.hpp>
#include <dsns/sphere/charts.hpp>
#include <dsns/sphere/harmonic_lanes.hpp>
#include <dsns/sphere/quadrature.hpp>

namespace dsns {

/// Number of harmonics of degree 0 to `degree`.
constexpr Index harmonic_count(int degree) { return Index(degree + 1) * (degree + 1); }

/// The degree whose harmonics number `count`.
/// throws   InvalidArgument unless `count` is the square of a whole number from 1 on
inline int harmonic_degree(Index count) {
  const int degree = static_cast<int>(std::lround(std::sqrt(double(count)))) - 1;
  require(degree >= 0 && harmonic_count(degree) == count, "harmonics: ", count,
          " coefficients a coordinate, give the square of a whole number");
  return degree;
}

/// Degree l of each index, length (degree + 1)^2.
inline Eigen::ArrayXd harmonic_degrees(int degree) {
  Eigen::ArrayXd l(harmonic_count(degree));
  for (int d = 0; d <= degree; ++d) l.segment(Index(d) * d, 2 * d + 1).setConstant(d);
  return l;
}

/// All harmonics up to `degree` at one unit point; T any scalar, so derivatives may ride along.
template <class T>
Eigen::Matrix<T, Eigen::Dynamic, 1> harmonics(const Vec3<T>& s, int degree) {
  detail::LegendreFactors<T> legendre(degree);
  detail::PlanePowers<T> powers(degree);
  legendre.evaluate(s.z());
  powers.evaluate(s.x(), s.y());
  Eigen::Matrix<T, Eigen::Dynamic, 1> y(harmonic_count(degree));
  for (int l = 0; l <= degree; ++l) {
    const Index middle = Index(l) * l + l;
    y[middle] = legendre.at(l, 0);
    for (int m = 1; m <= l; ++m) {
      y[middle + m] = legendre.at(l, m) * powers.re[std::size_t(m)];
      y[middle - m] = legendre.at(l, m) * powers.im[std::size_t(m)];
    }
  }
  return y;
}

/// A matrix of n points by (degree + 1)^2 harmonics. Any scalar of machine numbers and any storage order will do: the
/// transpose of a row-major one is, without a copy, the matrix whose columns are points.
template <class M>
concept HarmonicMatrix = std::floating_point<typename M::Scalar> &&
                         M::RowsAtCompileTime == Eigen::Dynamic&& M::ColsAtCompileTime == Eigen::Dynamic;

/// Values and first derivatives in the charts; each n x (degree + 1)^2.
template <HarmonicMatrix M>
struct HarmonicTangentsOf {
  M y, yu, yv;
};
using HarmonicTangents = HarmonicTangentsOf<Eigen::MatrixXd>;

/// Values, first and second derivatives in the charts; each n x (degree + 1)^2.
template <HarmonicMatrix M>
struct HarmonicJetsOf {
  M y, yu, yv, yuu, yuv, yvv;
};
using HarmonicJets = HarmonicJetsOf<Eigen::MatrixXd>;

/// Values at the n unit columns of s: n x (degree + 1)^2. Here and below `storage` is an earlier result, moved in, whose
/// memory is used again: of many points, tiles of 16 to 64 with one storage take a twentieth of the time, as fresh memory costs
/// more than the harmonics.
/// accuracy at degree 128, at the poles and near them too: values 1e-11 and slopes 1e-9 against long double; orthonormal to
///          1e-12; the addition theorem with first and second derivatives to 1e-11 of its terms [sphere/harmonics_test].
///          What remains grows with l^2: it is the rounding of z, by which a point is a little off the sphere.
template <HarmonicMatrix M = Eigen::MatrixXd>
M harmonics(const Mat3X& s, int degree, M storage = {}) {
  require(degree >= 0, "harmonics: degree ", degree, ", give at least 0");
  return std::move(detail::harmonic_basis<0, M>({s, s, s}, degree, {std::move(storage)})[0]);
}

/// Values with first derivatives in n charts.
template <HarmonicMatrix M = Eigen::MatrixXd>
HarmonicTangentsOf<M> harmonic_tangents(const ChartBatch& c, int degree, HarmonicTangentsOf<M> storage = {}) {
  require(degree >= 0, "harmonic_tangents: degree ", degree, ", give at least 0");
  auto [y, yu, yv] = detail::harmonic_basis<1, M>({c.s, c.e1, c.e2}, degree,
                                                  {std::move(storage.y), std::move(storage.yu), std::move(storage.yv)});
  return {std::move(y), std::move(yu), std::move(yv)};
}

/// Values with first and second derivatives in n charts.
template <HarmonicMatrix M = Eigen::MatrixXd>
HarmonicJetsOf<M> harmonic_jets(const ChartBatch& c, int degree, HarmonicJetsOf<M> storage = {}) {
  require(degree >= 0, "harmonic_jets: degree ", degree, ", give at least 0");
  auto [y, yu, yv, yuu, yuv, yvv] =
      detail::harmonic_basis<2, M>({c.s, c.e1, c.e2}, degree,
                                   {std::move(storage.y), std::move(storage.yu), std::move(storage.yv),
                                    std::move(storage.yuu), std::move(storage.yuv), std::move(storage.yvv)});
  return {std::move(y), std::move(yu), std::move(yv), std::move(yuu), std::move(yuv), std::move(yvv)};
}

/// Coefficients of C functions, (degree + 1)^2 x C, and values of C functions at n points, C x n.
template <int C>
using HarmonicCoefficients = Eigen::Matrix<double, Eigen::Dynamic, C>;
template <int C>
using FunctionValues = Eigen::Matrix<double, C, Eigen::Dynamic>;

/// C functions with their first derivatives at n charts; each C x n.
template <int C>
struct FunctionTangents {
  FunctionValues<C> f, fu, fv;
};

/// C functions with their first and second derivatives at n charts; each C x n.
template <int C>
struct FunctionJets {
  FunctionValues<C> f, fu, fv, fuu, fuv, fvv;
};

/// sum over k of c_k Y_k at the n unit columns of s, for C functions at once: C x n.
/// throws   InvalidArgument unless the coefficients of a function number (degree + 1)^2; so do the next two
template <int C>
FunctionValues<C> harmonic_sum(const HarmonicCoefficients<C>& coefficients, const Mat3X& s) {
  return std::move(detail::harmonic_sums<0, C>(coefficients, {s, s, s}, harmonic_degree(coefficients.rows()))[0]);
}

/// The same with first derivatives in n charts.
template <int C>
FunctionTangents<C> harmonic_sum_tangents(const HarmonicCoefficients<C>& coefficients, const ChartBatch& c) {
  auto [f, fu, fv] = detail::harmonic_sums<1, C>(coefficients, {c.s, c.e1, c.e2}, harmonic_degree(coefficients.rows()));
  return {std::move(f), std::move(fu), std::move(fv)};
}

/// The same with first and second derivatives in n charts.
template <int C>
FunctionJets<C> harmonic_sum_jets(const HarmonicCoefficients<C>& coefficients, const ChartBatch& c) {
  auto [f, fu, fv, fuu, fuv, fvv] =
      detail::harmonic_sums<2, C>(coefficients, {c.s, c.e1, c.e2}, harmonic_degree(coefficients.rows()));
  return {std::move(f), std::move(fu), std::move(fv), std::move(fuu), std::move(fuv), std::move(fvv)};
}

/// The C functions' integrals against the harmonics up to `degree`: of functions that are band-limited to it, their
/// coefficients.
/// values   at the quadrature's nodes, C x n; exact while the functions' degree and `degree` add up to the quadrature's
template <int C>
HarmonicCoefficients<C> harmonic_coefficients(const FunctionValues<C>& values, const SphereQuadrature& q, int degree) {
  require(values.cols() == q.size(), "harmonic_coefficients: ", values.cols(), " values at ", q.size(), " nodes");
  HarmonicCoefficients<C> out = HarmonicCoefficients<C>::Zero(harmonic_count(degree), C);
  constexpr Index tile = 64;
  Eigen::MatrixXd y;
  for (Index first = 0; first < q.size(); first += tile) {
    const Index n = std::min(tile, q.size() - first);
    y = harmonics(q.points.middleCols(first, n), degree, std::move(y));
    out.noalias() +=
        y.transpose() * (values.middleCols(first, n) * q.weights.segment(first, n).asDiagonal()).transpose();
  }
  return out;
}

}  // namespace dsns
