#pragma once
/// Functions on a surface as sums of spherical harmonics, and the Laplace-Beltrami operator among them: no mesh.
///   M_ij = integral of Y_i Y_j dA,    S_ij = integral of <grad Y_i, grad Y_j> dA,
/// both over the surface and with its metric. With n = f_u x f_v and E, F, G in the charts, dA = |n| ds and
///   <grad a, grad b> dA = (a_u, a_v) K (b_u, b_v)^T ds,    K = |n|^-1 (G, -F; -F, E),
/// so that a conformal change of the metric leaves S as it is.
#include <dsns/core/parallel.hpp>
#include <dsns/sphere/harmonics.hpp>
#include <dsns/sphere/quadrature.hpp>
#include <dsns/surface/jets.hpp>

#include <cmath>
#include <utility>
#include <vector>

namespace dsns {

struct GalerkinOptions {
  int degree = 20;  ///< of the harmonics; (degree + 1)^2 unknowns
  int nodes = 0;    ///< latitudes of the quadrature, on each twice as many nodes; 0: 3/2 degree + 12
  int threads = 1;  ///< the result does not depend on their number
};

/// The quadrature on the sphere that the options ask for.
/// throws   InvalidArgument for a negative degree, or nodes so few that the harmonics are dependent on them
inline SphereQuadrature galerkin_nodes(const GalerkinOptions& options) {
  require(options.degree >= 0, "galerkin: degree is ", options.degree, ", give at least 0");
  require(options.nodes == 0 || options.nodes > options.degree, "galerkin: ", options.nodes, " nodes for degree ",
          options.degree, ", give at least ", options.degree + 1, " or 0 for the default");
  return sphere_quadrature(options.nodes > 0 ? options.nodes : 3 * options.degree / 2 + 12);
}

/// A function on the sphere, and so on every surface over it: sum_k c_k Y_k(s); T any scalar, so derivatives are exact.
struct HarmonicFunction {
  int degree = 0;
  Eigen::VectorXd coefficients;  ///< (degree + 1)^2

  template <class T>
  T operator()(const Vec3<T>& s) const {
    const auto y = harmonics<T>(s, degree);
    T sum(0.0);
    for (Index k = 0; k < y.size(); ++k) sum += coefficients[k] * y[k];
    return sum;
  }
  /// Values at the n unit columns of s.
  Eigen::VectorXd values(const Mat3X& s) const { return harmonics(s, degree) * coefficients; }
};

/// Mass and stiffness of a surface, symmetric, (degree + 1)^2 square each: length^2 and no unit.
struct GalerkinSystem {
  Eigen::MatrixXd mass, stiffness;
};

namespace detail {

/// The harmonics and their first derivatives in some charts, n x (degree + 1)^2 each, with the weights of a quadrature.
struct GalerkinTile {
  ChartBatch charts;
  Eigen::VectorXd weights;
  Eigen::MatrixXd y, yu, yv;
};

inline constexpr int galerkin_tile_size = 256;

inline int galerkin_tile_count(const SphereQuadrature& q) {
  return static_cast<int>((q.size() + galerkin_tile_size - 1) / galerkin_tile_size);
}

inline GalerkinTile galerkin_tile(const SphereQuadrature& q, int tile, int degree, int threads) {
  constexpr Index piece = 32;  // points whose harmonics are evaluated together
  const Index first = Index(tile) * galerkin_tile_size, n = std::min<Index>(galerkin_tile_size, q.size() - first);
  const Index count = harmonic_count(degree);
  GalerkinTile out{charts_at(q.points.middleCols(first, n)), q.weights.segment(first, n), Eigen::MatrixXd(n, count),
                   Eigen::MatrixXd(n, count), Eigen::MatrixXd(n, count)};
  parallel_for(static_cast<int>((n + piece - 1) / piece), threads, [&](int p) {
    const Index begin = p * piece, size = std::min(piece, n - begin);
    const HarmonicTangents h =
        harmonic_tangents({out.charts.s.middleCols(begin, size), out.charts.e1.middleCols(begin, size),
                           out.charts.e2.middleCols(begin, size)},
                          degree);
    out.y.middleRows(begin, size) = h.y;
    out.yu.middleRows(begin, size) = h.yu;
    out.yv.middleRows(begin, size) = h.yv;
  });
  return out;
}

/// |f_u x f_v| at the nodes.
/// throws   DegenerateSurface where it is not positive or not finite
inline Eigen::VectorXd area_densities(const SurfaceTangents& t) {
  Eigen::VectorXd density(t.size());
  for (Index i = 0; i < t.size(); ++i) {
    density[i] = Vec3d(t.fu.col(i)).cross(Vec3d(t.fv.col(i))).norm();
    require<DegenerateSurface>(density[i] > 0 && std::isfinite(density[i]), "galerkin: the area density is ",
                               density[i], " at node ", i, ", the surface is not immersed there");
  }
  return density;
}

/// Sums of R^T R for matrices R with the same columns, of which the lower blocks are kept.
class GramSum {
 public:
  explicit GramSum(Index size) : sum_(Eigen::MatrixXd::Zero(size, size)) {}

  /// Threads share the columns of the sum, not the rows of R: each entry is added up in one order whatever their
  /// number.
  void add(const Eigen::MatrixXd& rows, int threads) {
    constexpr Index width = 64;
    const Index size = sum_.cols();
    parallel_for(static_cast<int>((size + width - 1) / width), threads, [&](int block) {
      const Index begin = block * width, columns = std::min(width, size - begin), below = size - begin;
      sum_.block(begin, begin, below, columns).noalias() +=
          rows.rightCols(below).transpose() * rows.middleCols(begin, columns);
    });
  }
  Eigen::MatrixXd full() const { return sum_.selfadjointView<Eigen::Lower>(); }

 private:
  Eigen::MatrixXd sum_;
};

/// Square roots of the integrands: M and S are sums of R^T R over the rows R that these return.
inline Eigen::MatrixXd mass_rows(const GalerkinTile& tile, const Eigen::VectorXd& density) {
  return tile.weights.cwiseProduct(density).cwiseSqrt().asDiagonal() * tile.y;
}
/// K = C C^T with C = (sqrt(G/|n|), 0; -F/sqrt(G|n|), sqrt(|n|/G)), where EG - F^2 = |n|^2 leaves no difference to
/// cancel.
inline Eigen::MatrixXd stiffness_rows(const GalerkinTile& tile, const SurfaceTangents& t,
                                      const Eigen::VectorXd& density) {
  const Index n = tile.weights.size();
  const Eigen::ArrayXd G = t.fv.colwise().squaredNorm(), F = t.fu.cwiseProduct(t.fv).colwise().sum();
  const Eigen::ArrayXd w = tile.weights, d = density;
  Eigen::MatrixXd rows(2 * n, tile.y.cols());
  rows.topRows(n) = (w * G / d).sqrt().matrix().asDiagonal() * tile.yu;
  rows.topRows(n) -= (F * (w / (G * d)).sqrt()).matrix().asDiagonal() * tile.yv;
  rows.bottomRows(n) = (w * d / G).sqrt().matrix().asDiagonal() * tile.yv;
  return rows;
}

}  // namespace detail

/// Mass and stiffness of a surface in the harmonics up to a degree. On the unit sphere M = 1 and S = diag(l (l + 1)).
/// accuracy that of the quadrature: exact for the harmonics' products with a density of degree 2 nodes - 1 - 2 degree;
///          on the sphere 1e-12 [geometry/galerkin_test]
/// throws   InvalidArgument as galerkin_nodes, DegenerateSurface where the surface is not immersed at a node
template <Surface S>
GalerkinSystem galerkin_system(const S& surface, const GalerkinOptions& options) {
  const SphereQuadrature q = galerkin_nodes(options);
  const Index count = harmonic_count(options.degree);
  detail::GramSum mass(count), stiffness(count);
  for (int k = 0; k < detail::galerkin_tile_count(q); ++k) {
    const auto tile = detail::galerkin_tile(q, k, options.degree, options.threads);
    const SurfaceTangents t = tangents(surface, tile.charts);
    const Eigen::VectorXd density = detail::area_densities(t);
    mass.add(detail::mass_rows(tile, density), options.threads);
    stiffness.add(detail::stiffness_rows(tile, t, density), options.threads);
  }
  return {mass.full(), stiffness.full()};
}

}  // namespace dsns
