#pragma once
/// Earlier schemes of spatial registration, to compare with: a rotation by SVD and a gradient step on the coefficients of fields,
/// by turns, several hundred times, on one frame, all degrees at once.
/// source   Jermyn et al. 2012 and the 4D D-SNS paper as written; the latter's released code, which follows Kurtek et al. 2010
#include <dsns/elastic/spatial_registration.hpp>

namespace dsns {

enum class GradientScheme {
  paper,     ///< SRNF without sqrt(J), fields of degree 8, steps halved where the energy rises
  released,  ///< sqrt|n| f, the 16 fields of degree 2, one fixed step
};

/// start    such as the best of many rotations
/// returns  the map after `iterations`, or before the step that would fold
/// accuracy leaves most of a warp of 4 degrees after 60 iterations [elastic/gradient_registration_test]
inline SpatialResult register_by_gradient(std::span<const HarmonicSurface> first,
                                          std::span<const HarmonicSurface> second, GradientScheme scheme,
                                          const SpatialStart& start = {}, SpatialOptions options = {},
                                          int iterations = 500) {
  constexpr double first_step = 0.02;  // radians, the farthest that a point moves
  const bool paper = scheme == GradientScheme::paper;
  const SpatialLevel level{paper ? 8 : 2, 20, 0, paper ? 0.0 : 1.0};
  options.action = paper ? FieldAction::as_published : FieldAction::half_density;
  const detail::SpatialPair pair(first, second, options);
  const SphereQuadrature q = masked(sphere_quadrature(options.latitudes), options);
  const detail::SpatialProblem problem = pair.problem(level, q);
  const Eigen::MatrixXd target = pair.field(pair.first(), level)(charts_at(q.points)).g;
  const auto svd = [&](const detail::Particles& p) {
    const Eigen::MatrixXd g = paper ? p.field.g : Eigen::MatrixXd(p.field.g * p.J.cwiseSqrt().asDiagonal());
    return nearest_rotation(block_correlation(target, g, q.weights));
  };

  SpatialResult result{start.rotation, start.gamma, {}};
  const SphereDisplacement begin = start.gamma.displacement(charts_at(q.points));
  detail::Particles p = problem.at(begin.y, begin.J, start.rotation);
  result.summary.norm = problem.norm();
  result.summary.energy_before = p.energy;
  result.summary.stop = "all iterations done";
  double step = 0;
  const Index count = harmonic_count(level.field_degree) - 1;
  for (int i = 0; i < iterations; ++i) {
    p = problem.at(p.y, p.J, svd(p));
    const ChartBatch charts = charts_at(p.y);
    const Eigen::VectorXd down = problem.linearise(p, charts, level.field_degree).right;
    SphereVectorField v = SphereVectorField::zero(level.field_degree);
    const auto scaled = [&](double factor) {
      v.a.tail(count) = factor * down.head(count);
      v.b.tail(count) = factor * down.segment(count, count);
      return displace(v, charts);
    };
    if (i == 0) step = first_step / scaled(1e-6).longest_step * 1e-6;
    SphereDisplacement moved = scaled(step);
    detail::Particles next = problem.at(moved.y, p.J.cwiseProduct(moved.J), p.O);
    for (int halving = 0; paper && halving < 20 && !(next.energy < p.energy); ++halving) {
      moved = scaled(step /= 2);
      next = problem.at(moved.y, p.J.cwiseProduct(moved.J), p.O);
    }
    if (!(moved.J.minCoeff() > 0) || next.J.minCoeff() < options.min_jacobian || (paper && !(next.energy < p.energy))) {
      result.summary.stop = "the next step would fold, or not lower the energy";
      break;
    }
    p = std::move(next);
    result.gamma.append(std::move(v));
    result.summary.energies.push_back(p.energy);
    ++result.summary.steps;
  }
  result.rotation = p.O;
  result.summary.energy_after = p.energy;
  result.summary.min_jacobian = certify(result.gamma).min_jacobian;
  return result;
}

}  // namespace dsns
