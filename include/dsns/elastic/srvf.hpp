#pragma once
/// Curves in R^K and their square-root velocity functions q = a' / sqrt|a'|. A warp acts as (q * zeta)(t) =
/// sqrt(zeta'(t)) q(zeta(t)), which keeps the L2 norm; |q|^2 integrates to the length.
/// source   Srivastava, Klassen, Joshi, Jermyn 2011
#include <dsns/core/spline.hpp>
#include <dsns/elastic/time_warp.hpp>

namespace dsns {

/// A curve given by its start and by exact velocities at equidistant times; between them the velocity is a cubic spline.
class Curve {
 public:
  /// start K, velocities K x (n >= 2) at t = 0, 1/(n-1), ..., 1; both in length units (per clip).
  Curve(Eigen::VectorXd start, Eigen::MatrixXd velocities)
      : start_(std::move(start)), velocities_(std::move(velocities)), spline_(std::max<Index>(velocities_.cols(), 1)) {
    require(velocities_.cols() >= 2 && velocities_.rows() == start_.size(), "Curve: ", velocities_.rows(), " x ",
            velocities_.cols(), " velocities for a start of ", start_.size(), " coordinates, give K x n with n >= 2");
  }

  const Eigen::VectorXd& start() const { return start_; }
  Index dimension() const { return start_.size(); }

  /// a'(t), K.
  Eigen::VectorXd velocity(double t) const { return velocities_ * spline_.weights(t); }
  /// a''(t), K.
  Eigen::VectorXd acceleration(double t) const { return velocities_ * spline_.derivative_weights(t); }

 private:
  Eigen::VectorXd start_;
  Eigen::MatrixXd velocities_;
  CubicSpline spline_;
};

/// Equidistant times from 0 to 1 with the weights of the trapezoidal rule: the one grid of all integrals over time.
struct TimeGrid {
  Eigen::VectorXd times, weights;
};

inline TimeGrid time_grid(Index intervals = TimeWarp::default_intervals) {
  TimeGrid grid{Eigen::VectorXd::LinSpaced(intervals + 1, 0, 1),
                Eigen::VectorXd::Constant(intervals + 1, 1 / double(intervals))};
  grid.weights[0] = grid.weights[intervals] = 0.5 / double(intervals);
  return grid;
}

/// Added to |a'|^2 so that a resting curve has q = 0 without a division by zero.
inline constexpr double resting_speed_squared = 1e-20;

/// q of velocities, K x n.
inline Eigen::MatrixXd srvf(const Eigen::MatrixXd& velocities) {
  const Eigen::RowVectorXd speed = (velocities.colwise().squaredNorm().array() + resting_speed_squared).sqrt();
  return velocities * speed.cwiseSqrt().cwiseInverse().asDiagonal();
}

/// q of a curve on the grid, warped: sqrt(zeta') q(zeta(t)), K x n.
inline Eigen::MatrixXd warped_srvf(const Curve& curve, const TimeWarp& warp, const TimeGrid& grid) {
  Eigen::MatrixXd velocities(curve.dimension(), grid.times.size());
  Eigen::VectorXd root(grid.times.size());
  for (Index k = 0; k < grid.times.size(); ++k) {
    velocities.col(k) = curve.velocity(warp(grid.times[k]));
    root[k] = std::sqrt(std::max(warp.slope(grid.times[k]), 0.0));
  }
  return srvf(velocities) * root.asDiagonal();
}

/// Squared L2 norm of a field over time, K x n on the grid.
inline double squared_norm(const Eigen::MatrixXd& q, const TimeGrid& grid) {
  return q.colwise().squaredNorm() * grid.weights;
}

/// The curve with SRVF q on the grid: velocity q |q|.
inline Curve curve_of_srvf(Eigen::VectorXd start, const Eigen::MatrixXd& q) {
  return {std::move(start), q * q.colwise().norm().asDiagonal()};
}

/// Points of the curve with SRVF q on the grid: start + integral of q |q|, K x n.
inline Eigen::MatrixXd integrate_srvf(const Eigen::VectorXd& start, const Eigen::MatrixXd& q, const TimeGrid& grid) {
  const Eigen::MatrixXd velocity = q * q.colwise().norm().asDiagonal();
  Eigen::MatrixXd points(q.rows(), q.cols());
  points.col(0) = start;
  for (Index k = 1; k < q.cols(); ++k)
    points.col(k) =
        points.col(k - 1) + (grid.times[k] - grid.times[k - 1]) / 2 * (velocity.col(k - 1) + velocity.col(k));
  return points;
}

}  // namespace dsns
