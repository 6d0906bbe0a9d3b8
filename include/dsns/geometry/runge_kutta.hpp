#pragma once
/// Ordinary differential equations of a few unknowns to near rounding: Fehlberg's embedded pair of orders 7 and 8 with steps
/// chosen by the error, continued with the result of order 8.
#include <dsns/core/errors.hpp>
#include <dsns/core/types.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace dsns {

struct RungeKuttaOptions {
  double tolerance = 1e-13;  ///< of each step: |error_k| <= tolerance (1 + |y_k|) for every unknown
  int max_steps = 10000;     ///< accepted and rejected
};

struct RungeKuttaSummary {
  int steps = 0;  ///< accepted
  int rejected = 0;
  bool converged = false;  ///< the end was reached within max_steps
};

namespace detail {

/// source   Fehlberg 1968, NASA TR R-287, table X
struct Fehlberg78 {
  static constexpr int stages = 13;
  static constexpr double a[stages][stages - 1] = {
      {},
      {2.0 / 27},
      {1.0 / 36, 1.0 / 12},
      {1.0 / 24, 0, 1.0 / 8},
      {5.0 / 12, 0, -25.0 / 16, 25.0 / 16},
      {1.0 / 20, 0, 0, 1.0 / 4, 1.0 / 5},
      {-25.0 / 108, 0, 0, 125.0 / 108, -65.0 / 27, 125.0 / 54},
      {31.0 / 300, 0, 0, 0, 61.0 / 225, -2.0 / 9, 13.0 / 900},
      {2, 0, 0, -53.0 / 6, 704.0 / 45, -107.0 / 9, 67.0 / 90, 3},
      {-91.0 / 108, 0, 0, 23.0 / 108, -976.0 / 135, 311.0 / 54, -19.0 / 60, 17.0 / 6, -1.0 / 12},
      {2383.0 / 4100, 0, 0, -341.0 / 164, 4496.0 / 1025, -301.0 / 82, 2133.0 / 4100, 45.0 / 82, 45.0 / 164, 18.0 / 41},
      {3.0 / 205, 0, 0, 0, 0, -6.0 / 41, -3.0 / 205, -3.0 / 41, 3.0 / 41, 6.0 / 41, 0},
      {-1777.0 / 4100, 0, 0, -341.0 / 164, 4496.0 / 1025, -289.0 / 82, 2193.0 / 4100, 51.0 / 82, 33.0 / 164, 12.0 / 41,
       0, 1}};
  /// Weights of order 8; those of order 7 differ by 41/840 (1, 1, -1, -1) in stages 0, 10, 11, 12.
  static constexpr double b[stages] = {0,        0,         0,         0, 0,          34.0 / 105, 9.0 / 35,
                                       9.0 / 35, 9.0 / 280, 9.0 / 280, 0, 41.0 / 840, 41.0 / 840};
  static constexpr double error = 41.0 / 840;
};

/// One trial step of length h from y: the state of order 8 and the difference to order 7.
template <int N>
struct TrialStep {
  Eigen::Matrix<double, N, 1> y, error;
};

template <int N, class Rate>
TrialStep<N> trial_step(const Rate& rate, const Eigen::Matrix<double, N, 1>& y, double h) {
  using State = Eigen::Matrix<double, N, 1>;
  using Table = Fehlberg78;
  std::array<State, Table::stages> k;
  State sum = State::Zero();
  for (std::size_t i = 0; i < Table::stages; ++i) {
    State at = y;
    for (std::size_t m = 0; m < i; ++m)
      if (Table::a[i][m] != 0) at += h * Table::a[i][m] * k[m];
    k[i] = rate(at);
    sum += Table::b[i] * k[i];
  }
  return {y + h * sum, h * Table::error * (k[0] + k[10] - k[11] - k[12])};
}

}  // namespace detail

/// Follows y' = rate(y), which does not depend on time, from time 0 through the increasing `times`, and calls
/// arrived(index, y) at each. After every step the state is replaced by keep(y), the projection on what is conserved.
/// accuracy 1e-12 over a turn of a circle; errors fall with the 8th power of the step [geometry/runge_kutta_test]
template <int N, class Rate, class Keep, class Arrived>
RungeKuttaSummary integrate_steps(const Rate& rate, const Keep& keep, Eigen::Matrix<double, N, 1> y,
                                  const Eigen::VectorXd& times, const RungeKuttaOptions& options,
                                  const Arrived& arrived) {
  RungeKuttaSummary summary;
  double t = 0, h = times.size() ? times[times.size() - 1] / 16 : 0;
  for (Index next = 0; next < times.size(); ++next) {
    while (t < times[next]) {
      if (summary.steps + summary.rejected >= options.max_steps) return summary;
      const bool last = h >= 0.999 * (times[next] - t);  // no splinter of a step before a wanted time
      const double step = last ? times[next] - t : h;
      const auto trial = detail::trial_step<N>(rate, y, step);
      const double error = (trial.error.array().abs() / (1 + y.array().abs())).maxCoeff() / options.tolerance;
      const bool accepted = error <= 1;
      const double factor = std::isfinite(error) ? std::clamp(0.9 * std::pow(error + 1e-30, -0.125), 0.2, 4.0) : 0.2;
      if (accepted) {
        y = keep(trial.y);
        t = last ? times[next] : t + step;
        ++summary.steps;
      } else {
        ++summary.rejected;
      }
      h = accepted && last ? std::max(h, step * factor) : step * factor;  // a step cut short says little of the next
    }
    arrived(next, y);
  }
  summary.converged = true;
  return summary;
}

}  // namespace dsns
