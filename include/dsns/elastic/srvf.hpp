#pragma once
/// Curves in R^K and their square-root velocity functions q = a' / sqrt|a'|. A warp acts as (q * zeta)(t) =
/// sqrt(zeta'(t)) q(zeta(t)), which keeps the L2 norm; |q|^2 integrates to the length.
/// source   Srivastava, Klassen, Joshi, Jermyn 2011
#include <dsns/core/spline.hpp>
#include <dsns/elastic/time_warp.hpp>

namespace dsns {

/// A curve given by its start and by exact velocities at times from 0 to 1; between them the velocity is a cubic spline.
class Curve {
 public:
  /// start K, velocities K x (n >= 2) at t = 0, 1/(n-1), ..., 1; both in length units (per clip).
  Curve(Eigen::VectorXd start, Eigen::MatrixXd velocities)
      : Curve(std::move(start), velocities, equidistant_times(velocities.cols())) {}
  /// times    of the velocities, increasing from 0 to 1, as irregular as they are
  Curve(Eigen::VectorXd start, Eigen::MatrixXd velocities, std::vector<double> times)
      : start_(std::move(start)), velocities_(std::move(velocities)), times_(std::move(times)) {
    require(velocities_.cols() >= 2 && velocities_.rows() == start_.size(), "Curve: ", velocities_.rows(), " x ",
            velocities_.cols(), " velocities for a start of ", start_.size(), " coordinates, give K x n with n >= 2");
    require(Index(times_.size()) == velocities_.cols() && times_.front() == 0 && times_.back() == 1,
            "Curve: ", times_.size(), " times for ", velocities_.cols(), " velocities, give as many, from 0 to 1");
    const CubicSpline spline(times_);
    bends_.resizeLike(velocities_);
    for (Index k = 0; k < velocities_.cols(); ++k)
      bends_.col(k) = velocities_ * spline.second_derivative_weights(times_[std::size_t(k)]);
    knots_.resizeLike(velocities_);
    knots_.col(0) = start_;
    for (Index k = 0; k + 1 < velocities_.cols(); ++k) {
      const double h = times_[std::size_t(k) + 1] - times_[std::size_t(k)];
      knots_.col(k + 1) = knots_.col(k) + h / 2 * (velocities_.col(k) + velocities_.col(k + 1)) -
                          h * h * h / 24 * (bends_.col(k) + bends_.col(k + 1));
    }
  }

  const Eigen::VectorXd& start() const { return start_; }
  Index dimension() const { return start_.size(); }

  /// a'(t), K.
  Eigen::VectorXd velocity(double t) const {
    const auto [k, h, x] = piece(t);
    const double y = 1 - x;
    return y * velocities_.col(k) + x * velocities_.col(k + 1) +
           h * h / 6 * ((y * y * y - y) * bends_.col(k) + (x * x * x - x) * bends_.col(k + 1));
  }
  /// a''(t), K.
  Eigen::VectorXd acceleration(double t) const {
    const auto [k, h, x] = piece(t);
    const double y = 1 - x;
    return (velocities_.col(k + 1) - velocities_.col(k)) / h +
           h / 6 * ((1 - 3 * y * y) * bends_.col(k) + (3 * x * x - 1) * bends_.col(k + 1));
  }
  /// a(t), K.
  Eigen::VectorXd operator()(double t) const {
    const auto [k, h, x] = piece(t);
    const double y = 1 - x, u = 1 - y * y, v = x * x;  // integrals from the left time of y, x, y^3 - y and x^3 - x
    return knots_.col(k) + h / 2 * (u * velocities_.col(k) + v * velocities_.col(k + 1)) -
           h * h * h / 24 * (u * u * bends_.col(k) + v * (2 - v) * bends_.col(k + 1));
  }
  Eigen::VectorXd end() const { return (*this)(1); }

 private:
  struct Piece {
    Index left;
    double h, x;  // its length; 0 at the left time, 1 at the next
  };
  Piece piece(double t) const {
    const Index n = velocities_.cols(), right = std::upper_bound(times_.begin(), times_.end(), t) - times_.begin();
    const Index left = std::clamp<Index>(right - 1, 0, n - 2);
    const double from = times_[std::size_t(left)], h = times_[std::size_t(left) + 1] - from;
    return {left, h, (t - from) / h};
  }

  Eigen::VectorXd start_;
  Eigen::MatrixXd velocities_, bends_;  // values and second derivatives of the spline, K x n
  Eigen::MatrixXd knots_;               // points
  std::vector<double> times_;
};

/// The cubic spline through points at times, K x n, as a curve: what is left where only samples of a motion are known.
/// times    increasing from 0 to 1, as irregular as they are
/// accuracy exact for cubics [elastic/srvf_test]
inline Curve curve_through(const Eigen::MatrixXd& points, const std::vector<double>& times) {
  require(points.cols() >= 2 && Index(times.size()) == points.cols(), "curve_through: ", points.cols(), " points at ",
          times.size(), " times, give at least two and as many times");
  constexpr int parts = 4;  // of an interval: a velocity, quadratic in each, is kept to a few thousandths of its bends
  const CubicSpline spline(times);
  std::vector<double> fine{times.front()};
  for (std::size_t k = 0; k + 1 < times.size(); ++k) {
    for (int p = 1; p < parts; ++p) fine.push_back(times[k] + (times[k + 1] - times[k]) * p / parts);
    fine.push_back(times[k + 1]);
  }
  Eigen::MatrixXd velocities(points.rows(), Index(fine.size()));
  for (std::size_t k = 0; k < fine.size(); ++k) velocities.col(Index(k)) = points * spline.derivative_weights(fine[k]);
  return {points.col(0), std::move(velocities), std::move(fine)};
}

/// a(zeta(t)), with exact velocities at equidistant times.
inline Curve warped(const Curve& curve, const TimeWarp& warp, Index intervals = 2 * TimeWarp::default_intervals) {
  Eigen::MatrixXd velocities(curve.dimension(), intervals + 1);
  for (Index k = 0; k <= intervals; ++k) {
    const double t = double(k) / double(intervals);
    velocities.col(k) = warp.slope(t) * curve.velocity(warp(t));
  }
  return {curve.start(), std::move(velocities)};
}

/// A stretch of time: t in [0, 1] is begin + length t, run around where that leaves [0, 1].
struct TimeWindow {
  double begin = 0, length = 1;

  double operator()(double t) const {
    const double x = begin + length * t;
    return x >= 0 && x <= 1 ? x : x - std::floor(x);
  }
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

/// q of a curve at a time, and its derivative by time.
struct SrvfRate {
  Eigen::VectorXd value, rate;
};

inline SrvfRate srvf_rate(const Curve& curve, double t) {
  const Eigen::VectorXd v = curve.velocity(t), a = curve.acceleration(t);
  const double speed = std::sqrt(v.squaredNorm() + resting_speed_squared);
  return {v / std::sqrt(speed), (a - v * (v.dot(a) / (2 * speed * speed))) / std::sqrt(speed)};
}

/// q of a curve on the grid, warped: sqrt(zeta') q(zeta(t)), K x n; with a window, of that stretch of the curve.
inline Eigen::MatrixXd warped_srvf(const Curve& curve, const TimeWarp& warp, const TimeGrid& grid,
                                   const TimeWindow& window = {}) {
  Eigen::MatrixXd velocities(curve.dimension(), grid.times.size());
  Eigen::VectorXd root(grid.times.size());
  for (Index k = 0; k < grid.times.size(); ++k) {
    velocities.col(k) = curve.velocity(window(warp(grid.times[k])));
    root[k] = std::sqrt(window.length * std::max(warp.slope(grid.times[k]), 0.0));
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
