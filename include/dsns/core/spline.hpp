#pragma once
/// Interpolating cubic splines through equidistant knots, as weights of the knots: x(t) = sum_k w_k(t) x_k for data of
/// any kind, with w' and w'' the weights of the derivatives.
#include <dsns/core/errors.hpp>
#include <dsns/core/types.hpp>

#include <algorithm>
#include <cmath>

namespace dsns {

/// Not-a-knot cubic spline with `knots` equidistant knots on [0, 1]: twice continuously differentiable, fourth order,
/// exact for cubics. Three knots give the parabola, two the line, one the constant. Outside, the end pieces continue.
/// accuracy 1e-13 on cubics [core/spline_test]
/// source   de Boor, A Practical Guide to Splines, chapter IV; second derivatives at the knots as unknowns
class UniformSpline {
 public:
  /// throws   InvalidArgument unless knots >= 1
  explicit UniformSpline(Index knots) : knots_(knots) {
    require(knots >= 1, "UniformSpline: ", knots, " knots, give at least 1");
    curvature_ = Eigen::MatrixXd::Zero(knots, knots);
    if (knots == 3) curvature_.rowwise() = second_difference(1);
    if (knots >= 4) solve();
  }

  Index knots() const { return knots_; }

  /// The weights of the knots at t: `knots` values that sum to 1. Here and below:
  /// throws   InvalidArgument unless t is finite
  Eigen::VectorXd weights(double t) const {
    const auto [left, x] = piece(t);
    const double y = 1 - x;
    return combine(left, y, x, (y * y * y - y) / 6 * h() * h(), (x * x * x - x) / 6 * h() * h());
  }
  /// Weights of the first derivative by t.
  Eigen::VectorXd derivative_weights(double t) const {
    const auto [left, x] = piece(t);
    const double y = 1 - x;
    return combine(left, -1 / h(), 1 / h(), (1 - 3 * y * y) / 6 * h(), (3 * x * x - 1) / 6 * h());
  }
  /// Weights of the second derivative by t.
  Eigen::VectorXd second_derivative_weights(double t) const {
    const auto [left, x] = piece(t);
    return combine(left, 0, 0, 1 - x, x);
  }

 private:
  struct Piece {
    Index left;
    double x;  // 0 at the left knot, 1 at the next
  };

  double h() const { return knots_ > 1 ? 1 / double(knots_ - 1) : 1; }

  Piece piece(double t) const {
    require(std::isfinite(t), "UniformSpline: t is ", t, ", give a finite time");
    const double u = t / h(), last = double(std::max<Index>(knots_ - 2, 0));
    const double left = std::clamp(std::floor(u), 0.0, last);
    return {static_cast<Index>(left), u - left};
  }

  /// value_left x_k + value_right x_(k+1) + curvature_left x''_k + curvature_right x''_(k+1), as weights of all x.
  Eigen::VectorXd combine(Index left, double value_left, double value_right, double curvature_left,
                          double curvature_right) const {
    if (knots_ == 1) return Eigen::VectorXd::Constant(1, value_left + value_right);
    Eigen::VectorXd w =
        (curvature_left * curvature_.row(left) + curvature_right * curvature_.row(left + 1)).transpose();
    w[left] += value_left;
    w[left + 1] += value_right;
    return w;
  }

  Eigen::RowVectorXd second_difference(Index k) const {
    Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(knots_);
    row.segment<3>(k - 1) << 1, -2, 1;
    return row / (h() * h());
  }

  /// Inside: m_(k-1) + 4 m_k + m_(k+1) = 6 d_k, with m the second derivatives and d the second differences. Not-a-knot,
  /// m_0 = 2 m_1 - m_2, turns the first and the last of these into m_1 = d_1: what is left is one elimination.
  void solve() {
    const Index n = knots_;
    curvature_.row(1) = second_difference(1);
    curvature_.row(n - 2) = second_difference(n - 2);
    Eigen::VectorXd ratio = Eigen::VectorXd::Zero(n);
    for (Index k = 2; k <= n - 3; ++k) {
      const double pivot = 4 - ratio[k - 1];
      ratio[k] = 1 / pivot;
      curvature_.row(k) = (6 * second_difference(k) - curvature_.row(k - 1)) / pivot;
    }
    for (Index k = n - 3; k >= 2; --k) curvature_.row(k) -= ratio[k] * curvature_.row(k + 1);
    curvature_.row(0) = 2 * curvature_.row(1) - curvature_.row(2);
    curvature_.row(n - 1) = 2 * curvature_.row(n - 2) - curvature_.row(n - 3);
  }

  Index knots_;
  Eigen::MatrixXd curvature_;  // row k: the weights of the second derivative at knot k
};

}  // namespace dsns
