#pragma once
/// Interpolating cubic splines as weights of the knots: x(t) = sum_k w_k(t) x_k for data of any kind, with w' and w'' the
/// weights of the derivatives.
#include <dsns/core/errors.hpp>
#include <dsns/core/types.hpp>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace dsns {

/// `count` times from 0 to 1; 0 alone for one.
inline std::vector<double> equidistant_times(Index count) {
  std::vector<double> times(static_cast<std::size_t>(std::max<Index>(count, 0)), 0.0);
  for (std::size_t k = 1; k < times.size(); ++k) times[k] = double(k) / double(times.size() - 1);
  return times;
}

/// Not-a-knot cubic spline: twice continuously differentiable, fourth order, exact for cubics. Three knots give the parabola,
/// two the line, one the constant. Outside, the end pieces continue.
/// accuracy 1e-13 on cubics, 1e-12 against a dense solution for uneven knots [core/spline_test]
/// source   de Boor, A Practical Guide to Splines, chapter IV; second derivatives at the knots as unknowns
class CubicSpline {
 public:
  /// knots    their times, increasing
  /// throws   InvalidArgument unless there is at least one and they increase
  explicit CubicSpline(std::vector<double> knots) : times_(std::move(knots)) {
    const Index n = this->knots();
    require(n >= 1, "CubicSpline: ", n, " knots, give at least 1");
    for (Index k = 0; k < n; ++k)
      require(std::isfinite(time(k)) && (k == 0 || time(k) > time(k - 1)), "CubicSpline: knot ", k, " is at ", time(k),
              ", give finite times that increase");
    curvature_ = Eigen::MatrixXd::Zero(n, n);
    if (n == 3) curvature_.rowwise() = second_difference(1) / (time(2) - time(0)) * 2;
    if (n >= 4) solve();
  }
  /// Equidistant knots on [0, 1].
  explicit CubicSpline(Index knots) : CubicSpline(equidistant_times(knots)) {}

  Index knots() const { return static_cast<Index>(times_.size()); }
  const std::vector<double>& times() const { return times_; }

  /// The weights of the knots at t: `knots` values that sum to 1. Here and below:
  /// throws   InvalidArgument unless t is finite
  Eigen::VectorXd weights(double t) const {
    const auto [left, h, x] = piece(t);
    const double y = 1 - x;
    return combine(left, y, x, (y * y * y - y) / 6 * h * h, (x * x * x - x) / 6 * h * h);
  }
  /// Weights of the first derivative by t.
  Eigen::VectorXd derivative_weights(double t) const {
    const auto [left, h, x] = piece(t);
    const double y = 1 - x;
    return combine(left, -1 / h, 1 / h, (1 - 3 * y * y) / 6 * h, (3 * x * x - 1) / 6 * h);
  }
  /// Weights of the second derivative by t.
  Eigen::VectorXd second_derivative_weights(double t) const {
    const auto [left, h, x] = piece(t);
    return combine(left, 0, 0, 1 - x, x);
  }

 private:
  struct Piece {
    Index left;
    double h;  // its length
    double x;  // 0 at the left knot, 1 at the next
  };

  double time(Index k) const { return times_[static_cast<std::size_t>(k)]; }
  double h(Index k) const { return time(k + 1) - time(k); }

  Piece piece(double t) const {
    require(std::isfinite(t), "CubicSpline: t is ", t, ", give a finite time");
    if (knots() == 1) return {0, 1, 0};
    const Index right = std::upper_bound(times_.begin(), times_.end(), t) - times_.begin();
    const Index left = std::clamp<Index>(right - 1, 0, knots() - 2);
    return {left, h(left), (t - time(left)) / h(left)};
  }

  /// value_left x_k + value_right x_(k+1) + curvature_left x''_k + curvature_right x''_(k+1), as weights of all x.
  Eigen::VectorXd combine(Index left, double value_left, double value_right, double curvature_left,
                          double curvature_right) const {
    if (knots() == 1) return Eigen::VectorXd::Constant(1, value_left + value_right);
    Eigen::VectorXd w =
        (curvature_left * curvature_.row(left) + curvature_right * curvature_.row(left + 1)).transpose();
    w[left] += value_left;
    w[left + 1] += value_right;
    return w;
  }

  /// How much the slope rises at knot k.
  Eigen::RowVectorXd second_difference(Index k) const {
    Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(knots());
    row.segment<3>(k - 1) << 1 / h(k - 1), -1 / h(k - 1) - 1 / h(k), 1 / h(k);
    return row;
  }

  /// Inside: h_(k-1) m_(k-1) + 2 (h_(k-1) + h_k) m_k + h_k m_(k+1) = 6 d_k, with m the second derivatives and d the rises of
  /// the slope. Not-a-knot, m_0 = m_1 + r (m_1 - m_2) with r = h_0 / h_1 and likewise at the end, takes m_0 and m_(n-1) out:
  /// what is left is tridiagonal and diagonally dominant, one elimination.
  void solve() {
    const Index n = knots(), last = n - 2;
    const double first_ratio = h(0) / h(1), last_ratio = h(last) / h(last - 1);
    Eigen::VectorXd above = Eigen::VectorXd::Zero(n);
    for (Index k = 1; k <= last; ++k) {
      double below = h(k - 1), pivot = 2 * (h(k - 1) + h(k)), next = h(k);
      if (k == 1) pivot += h(0) * (1 + first_ratio), next -= h(0) * first_ratio, below = 0;
      if (k == last) pivot += h(last) * (1 + last_ratio), below -= h(last) * last_ratio, next = 0;
      pivot -= below * above[k - 1];
      above[k] = next / pivot;
      curvature_.row(k) = (6 * second_difference(k) - below * curvature_.row(k - 1)) / pivot;
    }
    for (Index k = last - 1; k >= 1; --k) curvature_.row(k) -= above[k] * curvature_.row(k + 1);
    curvature_.row(0) = (1 + first_ratio) * curvature_.row(1) - first_ratio * curvature_.row(2);
    curvature_.row(n - 1) = (1 + last_ratio) * curvature_.row(last) - last_ratio * curvature_.row(last - 1);
  }

  std::vector<double> times_;
  Eigen::MatrixXd curvature_;  // row k: the weights of the second derivative at knot k
};

}  // namespace dsns
