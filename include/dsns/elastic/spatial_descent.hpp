#pragma once
/// The damped Gauss-Newton iteration that all stages of spatial registration share. Each step composes exp(v) on the left of
/// gamma and a rotation on the right of O.
#include <dsns/elastic/spatial_options.hpp>

#include <Eigen/Cholesky>
#include <algorithm>
#include <optional>

namespace dsns::detail {

/// Of a linearised problem, lower triangle: gradients' coefficients, curls' coefficients, three of a rotation.
struct NormalEquations {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd right;
  int degree;

  /// Fills v with the damped step and returns its rotation.
  Mat3 solve(double damping, SphereVectorField& v) const {
    const Index count = harmonic_count(degree) - 1;
    const Eigen::ArrayXd l = harmonic_degrees(degree).tail(count);
    const Eigen::VectorXd penalty = (l * (l + 1)).square();
    Eigen::MatrixXd damped = matrix;
    damped.diagonal().head(count) += damping * penalty;
    damped.diagonal().segment(count, count) += damping * penalty;
    damped.diagonal().array() += 1e-10 * matrix.trace() / double(matrix.rows());
    const Eigen::VectorXd x = damped.selfadjointView<Eigen::Lower>().ldlt().solve(right);
    v.a.tail(count) = x.head(count);
    v.b.tail(count) = x.segment(count, count);
    return rotation_exp(x.tail<3>());
  }
};

/// Steps with fields of one degree; a step is taken only where the energy falls and the map stays clear of folds.
/// problem  gives .at(y, J, O), a state with y, J, O and energy, and .linearise(state, degree)
/// Appends the accepted fields and energies.
template <class Problem, class State>
State descend(const Problem& problem, State p, int degree, int steps, const SpatialOptions& options,
              std::vector<SphereVectorField>& fields, std::vector<double>& energies) {
  double damping = options.damping;
  for (int step = 0; step < steps; ++step) {
    const ChartBatch charts = charts_at(p.y);
    const NormalEquations system = problem.linearise(p, charts, degree);
    std::optional<State> next;
    SphereVectorField v = SphereVectorField::zero(degree);
    for (int attempt = 0; attempt < 8 && !next; ++attempt) {
      const Mat3 turn = system.solve(damping, v);
      const SphereDisplacement moved = displace(v, charts);
      const Eigen::VectorXd J = p.J.cwiseProduct(moved.J);
      if (moved.J.minCoeff() >= options.min_step_jacobian && J.minCoeff() >= options.min_jacobian &&
          moved.longest_step <= options.longest_step) {
        State trial = problem.at(moved.y, J, p.O * turn);
        if (trial.energy < p.energy) next = std::move(trial);
      }
      if (!next) damping = std::max(damping * 4, 1e-8);
    }
    if (!next) break;
    const double gain = (p.energy - next->energy) / p.energy;
    p = std::move(*next);
    fields.push_back(std::move(v));
    energies.push_back(p.energy);
    damping = std::max(damping / 3, 1e-4 * options.damping);
    if (gain < options.tolerance) break;
  }
  return p;
}

}  // namespace dsns::detail
