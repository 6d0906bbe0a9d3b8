#pragma once
/// Temporal registration: the warp zeta of [0, 1] that minimises |q1 - sqrt(zeta') q2(zeta)|^2. Dynamic programming on a grid
/// finds the right valley, Gauss-Newton on zeta' = e^u / integral of e^u, u = sum c_k sqrt(2) cos(k pi t), its bottom.
#include <dsns/elastic/srvf.hpp>

#include <Eigen/Cholesky>
#include <limits>
#include <numeric>
#include <string>

namespace dsns {

struct TemporalOptions {
  int grid = 200;                           ///< nodes of the dynamic programming
  int max_slope = 7;                        ///< its slopes are the fractions of coprime numbers up to this
  std::vector<int> cosines = {16, 24, 32};  ///< unknowns of the refinement, level by level
  int steps_per_level = 15;
  double min_slope = 0.1;   ///< warps that nearly stop the clock are not taken
  double ridge = 1e-6;      ///< times k^4 and the norm: what a cosine must gain to be used
  double tolerance = 1e-8;  ///< a level ends when a step lowers the energy by less than this share of it
};

struct TemporalSummary {
  double energy_before = 0;  ///< |q1 - q2|^2, length unit
  double energy_after = 0;
  double norm = 0;  ///< |q1|^2
  double min_slope = 1;
  int steps = 0;
  std::string stop;
};

struct TemporalResult {
  TimeWarp warp;
  TemporalSummary summary;
};

namespace detail {

/// Dynamic programming over piecewise linear warps from (0, 0) to (1, 1) on an n x n grid; returns zeta at the n times.
/// source   Srivastava, Klassen 2016, section 4.8
inline Eigen::VectorXd dynamic_programming_warp(const Eigen::MatrixXd& q1, const Eigen::MatrixXd& q2, int max_slope) {
  const int n = static_cast<int>(q1.cols());
  struct Move {
    int dt, dz;
  };
  std::vector<Move> moves;
  for (int a = 1; a <= max_slope; ++a)
    for (int b = 1; b <= max_slope; ++b)
      if (std::gcd(a, b) == 1) moves.push_back({a, b});
  const double h = 1.0 / (n - 1);
  Eigen::MatrixXd cost = Eigen::MatrixXd::Constant(n, n, std::numeric_limits<double>::infinity());
  Eigen::MatrixXi best = Eigen::MatrixXi::Constant(n, n, -1);
  cost(0, 0) = 0;
  const auto cost_of = [&](int t, int z, const Move& move) {
    const double slope = double(move.dz) / move.dt, root = std::sqrt(slope);
    double sum = 0;
    for (int s = 0; s <= move.dt; ++s) {
      const double x = z + slope * s;
      const int left = std::min(static_cast<int>(x), n - 2);
      const double f = x - left, weight = s == 0 || s == move.dt ? 0.5 : 1;
      sum += weight * (q1.col(t + s) - root * ((1 - f) * q2.col(left) + f * q2.col(left + 1))).squaredNorm();
    }
    return sum * h;
  };
  for (int t = 1; t < n; ++t)
    for (int z = 1; z < n; ++z)
      for (std::size_t m = 0; m < moves.size(); ++m) {
        const int t0 = t - moves[m].dt, z0 = z - moves[m].dz;
        if (t0 < 0 || z0 < 0 || !(cost(t0, z0) < cost(t, z))) continue;
        const double c = cost(t0, z0) + cost_of(t0, z0, moves[m]);
        if (c < cost(t, z)) {
          cost(t, z) = c;
          best(t, z) = static_cast<int>(m);
        }
      }
  Eigen::VectorXd warp(n);
  warp[n - 1] = 1;
  for (int t = n - 1, z = n - 1; t > 0;) {
    const Move& move = moves[std::size_t(best(t, z))];
    t -= move.dt;
    z -= move.dz;
    for (int s = 0; s < move.dt; ++s) warp[t + s] = h * (z + double(move.dz) / move.dt * s);
  }
  return warp;
}

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

/// The refinement's state and its linearisation.
class TemporalProblem {
 public:
  TemporalProblem(const Curve& first, const Curve& second, int max_cosines)
      : grid_(time_grid()),
        basis_(cosines(grid_.times, max_cosines)),
        target_(warped_srvf(first, {}, grid_)),
        second_(&second) {}

  TimeWarp warp(const Eigen::VectorXd& c) const { return TimeWarp::from_log_slope(basis_.leftCols(c.size()) * c); }
  double norm() const { return squared_norm(target_, grid_); }
  double energy(const TimeWarp& zeta) const {
    return squared_norm(target_ - warped_srvf(*second_, zeta, grid_), grid_);
  }

  struct NormalEquations {
    Eigen::MatrixXd matrix;
    Eigen::VectorXd right;
  };

  /// d(zeta) = P - zeta P(1) and d(log zeta') = phi - P(1) with P the integral of phi zeta'.
  NormalEquations linearise(const Eigen::VectorXd& c) const {
    const Index K = c.size(), n = grid_.times.size();
    const TimeWarp zeta = warp(c);
    Eigen::MatrixXd integral = Eigen::MatrixXd::Zero(n, K);
    const Eigen::MatrixXd moving = zeta.slopes().asDiagonal() * basis_.leftCols(K);
    for (Index k = 1; k < n; ++k)
      integral.row(k) = integral.row(k - 1) + (moving.row(k - 1) + moving.row(k)) / (2 * double(n - 1));
    const Eigen::RowVectorXd total = integral.row(n - 1);
    NormalEquations system{Eigen::MatrixXd::Zero(K, K), Eigen::VectorXd::Zero(K)};
    for (Index k = 0; k < n; ++k) {
      const Eigen::VectorXd v = second_->velocity(zeta.values()[k]), a = second_->acceleration(zeta.values()[k]);
      const double speed = std::sqrt(v.squaredNorm() + resting_speed_squared), root = std::sqrt(zeta.slopes()[k]);
      const Eigen::VectorXd q = v / std::sqrt(speed) * root;
      const Eigen::VectorXd dq = (a - v * (v.dot(a) / (2 * speed * speed))) / std::sqrt(speed) * root;
      const Eigen::RowVectorXd d_zeta = integral.row(k) - zeta.values()[k] * total;
      const Eigen::RowVectorXd d_log = 0.5 * (basis_.row(k).head(K) - total);
      const Eigen::VectorXd r = target_.col(k) - q;
      const double w = grid_.weights[k];
      system.right += w * (d_zeta.transpose() * dq.dot(r) + d_log.transpose() * q.dot(r));
      system.matrix += w * (d_zeta.transpose() * (dq.squaredNorm() * d_zeta + dq.dot(q) * d_log) +
                            d_log.transpose() * (dq.dot(q) * d_zeta + q.squaredNorm() * d_log));
    }
    return system;
  }

 private:
  TimeGrid grid_;
  Eigen::MatrixXd basis_, target_;
  const Curve* second_;
};

}  // namespace detail

/// Registers the second curve to the first in time.
/// returns  an increasing warp; the identity where nothing better was found, or where the first curve rests
/// accuracy L2 error below 1e-3 for strong smooth warps [elastic/temporal_registration_test]
inline TemporalResult register_temporally(const Curve& first, const Curve& second,
                                          const TemporalOptions& options = {}) {
  require(first.dimension() == second.dimension(), "register_temporally: curves in R^", first.dimension(), " and R^",
          second.dimension(), ", project both on one basis");
  require(!options.cosines.empty() && options.grid >= 2, "register_temporally: ", options.cosines.size(),
          " levels on a grid of ", options.grid, ", give at least one level and two nodes");
  const int most = *std::max_element(options.cosines.begin(), options.cosines.end());
  const detail::TemporalProblem problem(first, second, most);
  TemporalResult result;
  TemporalSummary& summary = result.summary;
  summary.norm = problem.norm();
  summary.energy_before = summary.energy_after = problem.energy({});
  summary.stop = "nothing better than the identity was found";
  if (!(summary.energy_before > 1e-14 * summary.norm)) return result;

  const TimeGrid coarse = time_grid(options.grid - 1);
  Eigen::VectorXd c = detail::log_slope_coefficients(
      detail::dynamic_programming_warp(warped_srvf(first, {}, coarse), warped_srvf(second, {}, coarse),
                                       options.max_slope),
      options.cosines.front());
  double energy = problem.energy(problem.warp(c));
  if (energy > summary.energy_before || problem.warp(c).slopes().minCoeff() < options.min_slope) {
    c.setZero();
    energy = summary.energy_before;
  }
  double damping = 1e-4;
  for (const int count : options.cosines) {
    c.conservativeResizeLike(Eigen::VectorXd::Zero(count));
    const Eigen::VectorXd ridge =
        options.ridge * summary.norm * Eigen::VectorXd::LinSpaced(count, 1, count).array().pow(4);
    for (int step = 0; step < options.steps_per_level; ++step) {
      auto system = problem.linearise(c);
      system.right -= ridge.cwiseProduct(c);
      const double penalised = energy + ridge.dot(c.cwiseAbs2());
      bool accepted = false;
      double gain = 0;
      for (int attempt = 0; attempt < 10 && !accepted; ++attempt) {
        Eigen::MatrixXd matrix = system.matrix;
        matrix.diagonal() += ridge + damping * system.matrix.diagonal();
        const Eigen::VectorXd trial = c + matrix.ldlt().solve(system.right);
        if (trial.allFinite() && problem.warp(trial).slopes().minCoeff() >= options.min_slope) {
          const double trial_energy = problem.energy(problem.warp(trial));
          const double next = trial_energy + ridge.dot(trial.cwiseAbs2());
          if (next < penalised) {
            accepted = true;
            gain = (penalised - next) / penalised;
            c = trial;
            energy = trial_energy;
          }
        }
        damping = accepted ? std::max(damping / 5, 1e-10) : damping * 5;
      }
      if (!accepted) break;
      ++summary.steps;
      if (gain < options.tolerance || energy < 1e-14 * summary.norm) break;
    }
  }
  if (energy >= summary.energy_before) return result;
  result.warp = problem.warp(c);
  summary.energy_after = energy;
  summary.min_slope = result.warp.min_slope();
  summary.stop = "all levels done";
  return result;
}

}  // namespace dsns
