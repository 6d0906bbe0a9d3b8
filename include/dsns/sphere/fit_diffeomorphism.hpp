#pragma once
/// A smooth diffeomorphism fitted to pairs of points: what makes a piecewise-linear map fit for derivatives.
///
///   const DiffeomorphismFit fit = smoothed(gamma);       // gamma any SphereMap
///   fit.gamma; fit.error.rms; fit.min_jacobian;          // smooth; radians lost; > 0
///
/// Gauss-Newton: a rotation, then increments exp(v), each the damped least squares field that carries the points from where
/// the map has brought them so far towards their targets.
#include <dsns/sphere/sphere_map.hpp>

#include <Eigen/Cholesky>

namespace dsns {

struct DiffeomorphismFitOptions {
  std::vector<int> degrees{1, 2, 4, 8, 12, 16, 16, 16};  ///< of the increments, one each
  double damping = 1e-6;           ///< times (l(l + 1))^2: keeps fields smooth where pairs are few
  double min_step_jacobian = 0.3;  ///< of an increment
  double longest_step = 0.8;       ///< radians
};

struct DiffeomorphismFit {
  SphereDiffeomorphism gamma;
  AngularDistance error;    ///< at the pairs, radians
  std::vector<double> rms;  ///< after the rotation and after each increment, falling
  double min_jacobian = 0;  ///< by certify(), on a grid four times finer than the fields
};

namespace detail {

/// The field of one degree nearest to tangent vectors at n charts, 2 x n in their frames; weights sum to 4 pi.
inline SphereVectorField least_squares_field(const ChartBatch& c, const Eigen::Matrix2Xd& tangents,
                                             const Eigen::VectorXd& weights, int degree, double damping) {
  const Index count = harmonic_count(degree) - 1;
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(2 * count, 2 * count);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(2 * count);
  constexpr Index tile = 256;
  HarmonicTangents h;
  for (Index first = 0; first < c.size(); first += tile) {
    const Index n = std::min(tile, c.size() - first);
    h = harmonic_tangents({c.s.middleCols(first, n), c.e1.middleCols(first, n), c.e2.middleCols(first, n)}, degree,
                          std::move(h));
    const Eigen::VectorXd root = weights.segment(first, n).cwiseSqrt();
    const auto yu = h.yu.rightCols(count), yv = h.yv.rightCols(count);
    Eigen::MatrixXd rows(2 * n, 2 * count);
    rows << root.asDiagonal() * yu, -(root.asDiagonal() * yv), root.asDiagonal() * yv, root.asDiagonal() * yu;
    Eigen::VectorXd wanted(2 * n);
    wanted << root.cwiseProduct(tangents.row(0).segment(first, n).transpose()),
        root.cwiseProduct(tangents.row(1).segment(first, n).transpose());
    matrix.selfadjointView<Eigen::Lower>().rankUpdate(rows.transpose());
    right.noalias() += rows.transpose() * wanted;
  }
  const Eigen::ArrayXd l = harmonic_degrees(degree).tail(count), penalty = damping * (l * (l + 1)).square();
  matrix.diagonal().head(count).array() += penalty;
  matrix.diagonal().tail(count).array() += penalty;
  matrix.diagonal().array() += 1e-12 * matrix.trace() / double(matrix.rows());
  const Eigen::VectorXd x = matrix.selfadjointView<Eigen::Lower>().ldlt().solve(right);
  SphereVectorField v = SphereVectorField::zero(degree);
  v.a.tail(count) = x.head(count);
  v.b.tail(count) = x.tail(count);
  return v;
}

/// The logarithm: tangent vectors at the charts that lead to the columns of y, in the frames.
inline Eigen::Matrix2Xd tangents_towards(const ChartBatch& c, const Mat3X& y) {
  Eigen::Matrix2Xd out(2, c.size());
  for (Index i = 0; i < c.size(); ++i) {
    const Eigen::Vector2d across(c.e1.col(i).dot(y.col(i)), c.e2.col(i).dot(y.col(i)));
    out.col(i) = angle_between(c.s.col(i), y.col(i)) * across.stableNormalized();
  }
  return out;
}

/// v made short enough that exp(v) is a diffeomorphism with room to spare, on a grid four times finer than v.
inline SphereVectorField safe_increment(SphereVectorField v, const DiffeomorphismFitOptions& options) {
  const ChartBatch grid = charts_at(sphere_quadrature(4 * std::max(v.degree, 4)).points);
  for (int halving = 0; halving < 6; ++halving) {
    const SphereDisplacement moved = displace(v, grid);
    if (moved.J.minCoeff() >= options.min_step_jacobian && moved.longest_step <= options.longest_step) return v;
    v.a /= 2;
    v.b /= 2;
  }
  return SphereVectorField::zero(v.degree);
}

}  // namespace detail

/// The smooth map that sends the columns of s near those of y, in the weighted mean square.
/// weights  of the pairs, any common factor
/// accuracy finds a warp of degree 4 and 10 degrees again to 0.02 degrees rms with fields of degree 10 [sphere/fit_diffeomorphism_test]
/// throws   InvalidArgument where sizes differ, there are no weights, or vectors are not of unit length
inline DiffeomorphismFit fit_diffeomorphism(const Mat3X& s, const Mat3X& y, const Eigen::VectorXd& weights,
                                            const DiffeomorphismFitOptions& options = {}) {
  require(s.cols() == y.cols() && s.cols() == weights.size(), "fit_diffeomorphism: ", s.cols(), " points, ", y.cols(),
          " targets, ", weights.size(), " weights");
  require(weights.size() > 0 && weights.minCoeff() >= 0 && weights.sum() > 0,
          "fit_diffeomorphism: give weights, none negative and not all zero");
  for (Index i = 0; i < y.cols(); ++i)
    require(std::abs(y.col(i).norm() - 1) < 1e-9, "fit_diffeomorphism: target ", i, " has length ", y.col(i).norm(),
            ", give unit vectors");
  const Eigen::VectorXd w = weights * (4 * pi / weights.sum());
  DiffeomorphismFit fit;
  fit.gamma = SphereDiffeomorphism(nearest_rotation(y * w.asDiagonal() * s.transpose()));
  ChartBatch here = charts_at(fit.gamma(s));
  fit.error = angular_distance(here.s, y, w);
  fit.rms.push_back(fit.error.rms);
  for (const int degree : options.degrees) {
    const SphereVectorField v = detail::safe_increment(
        detail::least_squares_field(here, detail::tangents_towards(here, y), w, degree, options.damping), options);
    const Mat3X moved = displace(v, here).y;
    const AngularDistance error = angular_distance(moved, y, w);
    if (!(error.rms < fit.error.rms)) continue;
    fit.gamma.append(v);
    fit.error = error;
    fit.rms.push_back(error.rms);
    here = charts_at(moved);
  }
  fit.min_jacobian = certify(fit.gamma).min_jacobian;
  require<Error>(fit.min_jacobian > 0,
                 "fit_diffeomorphism: the composition of the increments folds, its Jacobian falls to ",
                 fit.min_jacobian, ": give more damping or lower degrees");
  return fit;
}

/// A smooth map near any other, fitted at the nodes of a quadrature and at those points that the map sends to such nodes, so that
/// both what it compresses and what it stretches is seen. A map between two bodies with Jacobians from 0.02 on loses 3 degrees
/// rms with fields of degree 16, most of it where the target's sphere is stretched, and half as much with degree 24 after 20.
template <SphereMap G>
DiffeomorphismFit smoothed(const G& gamma, const DiffeomorphismFitOptions& options = {}) {
  int degree = 8;
  for (const int d : options.degrees) degree = std::max(degree, d);
  const SphereQuadrature q = sphere_quadrature(3 * degree / 2);
  Mat3X s(3, 2 * q.size()), y(3, 2 * q.size());
  s << q.points, gamma.inverse(q.points);
  y << gamma(q.points), q.points;
  Eigen::VectorXd weights(2 * q.size());
  weights << q.weights, q.weights;
  return fit_diffeomorphism(s, y, weights, options);
}

}  // namespace dsns
