#pragma once
/// The elastic energy of two curves along a warp, in a discretisation that does not prefer either: both run along
/// s = (t + zeta(t)) / 2, in which neither is faster than twice its own pace.
#include <dsns/elastic/srvf.hpp>

namespace dsns {

/// What an energy is taken of: a stretch of either curve, and how much a warp itself costs.
struct EnergyTerms {
  TimeWindow first = {}, second = {};
  double penalty = 0;  ///< times the integral of (1 - sqrt(zeta'))^2, length unit
};

/// |q1 - sqrt(zeta') q2(zeta)|^2 = integral of |sqrt(t') q1(t) - sqrt(zeta') q2(zeta)|^2 ds, with t' and zeta' by s.
/// accuracy equal for the curves exchanged and the warp inverted, to 1e-6 [elastic/temporal_laws_test]
template <WarpOfTime W>
double elastic_energy(const Curve& first, const Curve& second, const W& warp, const EnergyTerms& terms = {}) {
  constexpr int n = 1000;
  const auto q = [](const Curve& curve, const TimeWindow& window, double t) -> Eigen::VectorXd {
    const Eigen::VectorXd v = window.length * curve.velocity(window(t));
    return v / std::sqrt(std::sqrt(v.squaredNorm() + resting_speed_squared));
  };
  double energy = 0;
  double from = 0;  // t at the node before
  for (int k = 0; k <= n; ++k) {
    const double twice = 2.0 * k / n;
    double low = from, high = std::min(1.0, from + 2.0 / n + 1e-12);
    for (int step = 0; step < 45; ++step) {
      const double middle = (low + high) / 2;
      (middle + warp(middle) < twice ? low : high) = middle;
    }
    const double t = from = (low + high) / 2, slope = std::max(warp.slope(t), 0.0);
    const double root1 = std::sqrt(2 / (1 + slope)), root2 = std::sqrt(2 * slope / (1 + slope));
    const double miss = (root1 * q(first, terms.first, t) - root2 * q(second, terms.second, warp(t))).squaredNorm() +
                        terms.penalty * (root1 - root2) * (root1 - root2);
    energy += (k == 0 || k == n ? 0.5 : 1.0) / n * miss;
  }
  return energy;
}

}  // namespace dsns
