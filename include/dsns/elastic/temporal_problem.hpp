#pragma once
/// The continuous part of registration in time: Gauss-Newton on zeta' = e^u / integral of e^u, u = sum c_k sqrt(2) cos(k pi t),
/// and on the window of the second curve where that is free.
#include <dsns/elastic/temporal_options.hpp>

#include <Eigen/Cholesky>

namespace dsns::detail {

/// sqrt(2) cos(k pi t) for k = 1 .. count in columns.
inline Eigen::MatrixXd cosines(const Eigen::VectorXd& times, int count) {
  Eigen::MatrixXd basis(times.size(), count);
  for (int k = 1; k <= count; ++k) basis.col(k - 1) = std::sqrt(2.0) * (k * pi * times.array()).cos();
  return basis;
}

/// Coefficients whose warp follows a piecewise linear one: least squares on the logarithm of its smoothed slopes.
inline Eigen::VectorXd log_slope_coefficients(const Eigen::VectorXd& warp, int count) {
  const Index n = warp.size() - 1;
  constexpr int reach = 12;
  constexpr double width = 4;  // intervals; the grid's slopes jump between fractions
  Eigen::VectorXd log_slope(n);
  const Eigen::VectorXd slope = (warp.tail(n) - warp.head(n)) * double(n);
  for (Index k = 0; k < n; ++k) {
    double sum = 0, weights = 0;
    for (int d = -reach; d <= reach; ++d) {
      Index i = k + d;
      if (i < 0) i = -i - 1;
      if (i >= n) i = 2 * n - 1 - i;
      if (i < 0 || i >= n) continue;
      const double w = std::exp(-0.5 * d * d / (width * width));
      sum += w * slope[i];
      weights += w;
    }
    log_slope[k] = std::log(std::clamp(sum / weights, 0.05, 20.0));
  }
  const Eigen::VectorXd middles = (Eigen::VectorXd::LinSpaced(n, 0, double(n - 1)).array() + 0.5) / double(n);
  Eigen::MatrixXd A(n, count + 1);
  A << Eigen::VectorXd::Ones(n), cosines(middles, count);
  Eigen::MatrixXd normal = A.transpose() * A;
  normal.diagonal().array() += 1e-4;
  return normal.ldlt().solve(A.transpose() * log_slope).tail(count);
}

enum class FreeWindow { none, length, begin };  ///< what of the second's window is an unknown

struct TemporalState {
  Eigen::VectorXd c;
  TimeWindow window = {};
};

/// Energy and linearisation of a warp and a window of the second curve.
class TemporalProblem {
 public:
  /// penalty  in the unit of the energy
  TemporalProblem(const Curve& first, const Curve& second, FreeWindow free, double penalty,
                  const TemporalOptions& options)
      : options_(&options),
        grid_(time_grid()),
        basis_(cosines(grid_.times, *std::max_element(options.cosines.begin(), options.cosines.end()))),
        target_(warped_srvf(first, {}, grid_)),
        second_(&second),
        free_(free),
        penalty_(penalty) {}

  TimeWarp warp(const TemporalState& x) const { return TimeWarp::from_log_slope(log_slope(x)); }
  /// Whether the slopes are within their limits; where they are far from them, there is no warp to ask.
  bool allowed(const TemporalState& x) const {
    const Eigen::VectorXd u = log_slope(x);
    if (!u.allFinite() || !(u.maxCoeff() - u.minCoeff() <= -2 * std::log(options_->min_slope))) return false;
    const TimeWarp zeta = warp(x);
    return zeta.slopes().minCoeff() >= options_->min_slope && zeta.slopes().maxCoeff() <= 1 / options_->min_slope;
  }
  double energy(const TimeWarp& zeta, const TimeWindow& window) const {
    return squared_norm(target_ - warped_srvf(*second_, zeta, grid_, window), grid_) +
           penalty_ * grid_.weights.dot((zeta.slopes().cwiseSqrt().array() - 1).square().matrix());
  }

  /// Levenberg-Marquardt, level by level; x is at least as good afterwards.
  /// returns  steps taken
  int refine(TemporalState& x, double norm) const {
    double energy_now = energy(warp(x), x.window), damping = 1e-4;
    int steps = 0;
    for (const int count : options_->cosines) {
      x.c.conservativeResizeLike(Eigen::VectorXd::Zero(count));
      const Eigen::VectorXd ridge = options_->ridge * norm * Eigen::VectorXd::LinSpaced(count, 1, count).array().pow(4);
      for (int step = 0; step < options_->steps_per_level; ++step) {
        NormalEquations system = linearise(x);
        system.right.head(count) -= ridge.cwiseProduct(x.c);
        const double penalised = energy_now + ridge.dot(x.c.cwiseAbs2());
        bool accepted = false;
        double gain = 0;
        for (int attempt = 0; attempt < 10 && !accepted; ++attempt) {
          Eigen::MatrixXd matrix = system.matrix;
          matrix.diagonal() += damping * system.matrix.diagonal();
          matrix.diagonal().head(count) += ridge;
          const TemporalState trial = moved(x, matrix.ldlt().solve(system.right));
          if (std::isfinite(trial.window.begin + trial.window.length) && allowed(trial)) {
            const double trial_energy = energy(warp(trial), trial.window);
            const double next = trial_energy + ridge.dot(trial.c.cwiseAbs2());
            if (next < penalised) {
              accepted = true;
              gain = (penalised - next) / penalised;
              x = trial;
              energy_now = trial_energy;
            }
          }
          damping = accepted ? std::max(damping / 5, 1e-10) : damping * 5;
        }
        if (!accepted) break;
        ++steps;
        if (gain < options_->tolerance || energy_now < 1e-14 * norm) break;
      }
    }
    return steps;
  }

 private:
  struct NormalEquations {
    Eigen::MatrixXd matrix;
    Eigen::VectorXd right;
  };

  Eigen::VectorXd log_slope(const TemporalState& x) const { return basis_.leftCols(x.c.size()) * x.c; }

  TemporalState moved(TemporalState x, const Eigen::VectorXd& step) const {
    const Index count = x.c.size();
    x.c += step.head(count);
    if (free_ == FreeWindow::begin) x.window.begin += step[count];
    if (free_ == FreeWindow::length)
      x.window.length =
          std::clamp(x.window.length * std::exp(std::clamp(step[count], -1.0, 1.0)), options_->min_share, 1.0);
    return x;
  }

  /// d(zeta) = P - zeta P(1) and d(log zeta') = phi - P(1) with P the integral of phi zeta'. The second's time is begin +
  /// length zeta: the last unknown is begin, or the logarithm of length.
  NormalEquations linearise(const TemporalState& x) const {
    const Index K = x.c.size(), n = grid_.times.size(), all = K + (free_ == FreeWindow::none ? 0 : 1);
    const TimeWarp zeta = warp(x);
    Eigen::MatrixXd integral = Eigen::MatrixXd::Zero(n, K);
    const Eigen::MatrixXd moving = zeta.slopes().asDiagonal() * basis_.leftCols(K);
    for (Index k = 1; k < n; ++k)
      integral.row(k) = integral.row(k - 1) + (moving.row(k - 1) + moving.row(k)) / (2 * double(n - 1));
    const Eigen::RowVectorXd total = integral.row(n - 1);
    NormalEquations system{Eigen::MatrixXd::Zero(all, all), Eigen::VectorXd::Zero(all)};
    Eigen::RowVectorXd d_time = Eigen::RowVectorXd::Zero(all),
                       d_root = d_time;  // of time; of half the log of its slope
    const double length = x.window.length;
    for (Index k = 0; k < n; ++k) {
      const double value = zeta.values()[k], t = x.window(value), pace = std::sqrt(zeta.slopes()[k]);
      const auto [field, rate] = srvf_rate(*second_, t);
      const Eigen::VectorXd q = pace * std::sqrt(length) * field, dq = pace * std::sqrt(length) * rate;
      d_time.head(K) = length * (integral.row(k) - value * total);
      d_root.head(K) = 0.5 * (basis_.row(k).head(K) - total);
      const double w = grid_.weights[k];
      if (penalty_ > 0) {
        const auto d = d_root.head(K);
        system.right.head(K) += w * penalty_ * pace * (1 - pace) * d.transpose();
        system.matrix.topLeftCorner(K, K) += w * penalty_ * pace * pace * d.transpose() * d;
      }
      if (free_ == FreeWindow::begin) d_time[K] = 1;
      if (free_ == FreeWindow::length) d_time[K] = length * value, d_root[K] = 0.5;
      const Eigen::VectorXd r = target_.col(k) - q;
      const double qdq = dq.dot(q);
      system.right += w * (d_time.transpose() * dq.dot(r) + d_root.transpose() * q.dot(r));
      system.matrix += w * (d_time.transpose() * (dq.squaredNorm() * d_time + qdq * d_root) +
                            d_root.transpose() * (qdq * d_time + q.squaredNorm() * d_root));
    }
    return system;
  }

  const TemporalOptions* options_;
  TimeGrid grid_;
  Eigen::MatrixXd basis_, target_;
  const Curve* second_;
  FreeWindow free_;
  double penalty_;
};

}  // namespace dsns::detail
