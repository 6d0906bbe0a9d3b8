#pragma once
/// Temporal registration: the warp zeta of [0, 1] that minimises |q1 - sqrt(zeta') q2(zeta)|^2. Dynamic programming on a grid
/// finds the right valley, Gauss-Newton its bottom, once from either curve: the better of the two warps is taken, so that
/// the distance does not depend on which curve is the first.
///
///   const TemporalResult r = register_temporally(first, second);
///   second.velocity(r.second_time(t));                 // beside first.velocity(r.first_time(t))
#include <dsns/elastic/dynamic_programming.hpp>
#include <dsns/elastic/elastic_energy.hpp>
#include <dsns/elastic/temporal_problem.hpp>

#include <optional>

namespace dsns {

namespace detail {

/// The second curve, or a part of it, brought to the whole first.
struct DirectedRegistration {
  TimeWarp warp;
  TimeWindow window;
  int steps = 0;
};

/// Both curves' own terms of the energy, which give it its size.
struct CurveNorms {
  double first, second;
  double mean() const { return (first + second) / 2; }
};

inline DirectedRegistration register_directed(const Curve& first, const Curve& second, const CurveNorms& norms,
                                              const TimeWindow& start, FreeWindow free,
                                              const TemporalOptions& options) {
  const double penalty = options.penalty * norms.mean();
  const TemporalProblem problem(first, second, free, penalty, options);
  const TimeGrid coarse = time_grid(options.grid - 1);
  const GridSearch search(warped_srvf(first, {}, coarse), warped_srvf(second, {}, coarse, start), options.max_slope,
                          penalty);
  const int last = options.grid - 1;
  int end = last;
  if (free == FreeWindow::length)
    for (int z = std::max(1, int(std::ceil(options.min_share * last))); z < last; ++z)
      if (search.cost(z) < search.cost(end)) end = z;
  TemporalState x{Eigen::VectorXd::Zero(options.cosines.front()), start};
  const double rest = problem.energy({}, start);
  if (std::isfinite(search.cost(end))) {
    const double share = double(end) / last;
    TemporalState found{log_slope_coefficients(search.path(end).values / share, options.cosines.front()), start};
    found.window.length *= share;
    if (problem.allowed(found) && problem.energy(problem.warp(found), found.window) < rest) x = found;
  }
  DirectedRegistration out;
  out.steps = problem.refine(x, norms.first);
  out.warp = problem.warp(x);
  out.window = x.window;
  out.window.begin -= std::floor(out.window.begin);
  return out;
}

/// The best start and number of passes of the second for one of the first, by dynamic programming at `phases` starts.
struct PhaseSearch {
  TimeWindow window;
  double energy = std::numeric_limits<double>::infinity();  // as a share of both curves' own terms
};

inline PhaseSearch search_phase(const Curve& first, const Curve& second, const CurveNorms& norms, int phases,
                                const TemporalOptions& options) {
  const TimeGrid grid = time_grid(std::max(options.search_grid, 10) - 1);
  const Eigen::MatrixXd q1 = warped_srvf(first, {}, grid);
  std::vector<double> passes{1, 1.0 / 3, 0.5, 2, 3};
  if (options.passes > 0) passes = {options.passes};
  PhaseSearch best;
  for (const double length : passes)
    for (int k = 0; k < phases; ++k) {
      const TimeWindow window{double(k) / phases, length};
      const Eigen::MatrixXd q2 = warped_srvf(second, {}, grid, window);
      const GridSearch search(q1, q2, 4, options.penalty * norms.mean());
      const double energy = search.cost(search.samples() - 1) / (norms.first + squared_norm(q2, grid));
      if (energy < best.energy) best = {window, energy};
    }
  return best;
}

/// Share of the longer curve that matches the shorter, by dynamic programming; the lowest energy as a share of both terms.
struct PartSearch {
  double share = 1, energy = std::numeric_limits<double>::infinity();
};

inline PartSearch search_part(const Curve& first, const Curve& second, const TemporalOptions& options) {
  const TimeGrid grid = time_grid(std::max(options.search_grid, 10) - 1);
  const Eigen::MatrixXd q1 = warped_srvf(first, {}, grid), q2 = warped_srvf(second, {}, grid);
  const GridSearch search(q1, q2, 4, 0);
  const int last = search.samples() - 1;
  PartSearch best;
  double own = squared_norm(q1, grid);
  for (int z = 1; z <= last; ++z) {
    own += 0.5 * (q2.col(z - 1).squaredNorm() + q2.col(z).squaredNorm()) / last;
    if (z >= options.min_share * last && search.cost(z) / own < best.energy)
      best = {double(z) / last, search.cost(z) / own};
  }
  return best;
}

/// A curve that ends near its start, beside how far it goes: captured cycles do not close exactly.
inline bool is_closed(const Curve& curve) {
  constexpr int looks = 50;
  double extent = 0;
  for (int k = 1; k <= looks; ++k) extent = std::max(extent, (curve(double(k) / looks) - curve.start()).norm());
  return (curve.end() - curve.start()).norm() < 0.3 * extent;
}

/// Another alignment is advised where it would leave less than a third of the energy.
inline std::string advice(const Curve& first, const Curve& second, const CurveNorms& norms, double share,
                          const TemporalOptions& options) {
  constexpr double much = 0.1, better = 1.0 / 3;
  if (options.search_grid == 0 || share < much) return {};
  if (is_closed(first) && is_closed(second)) {
    const PhaseSearch phase = search_phase(first, second, norms, 12, options);
    if (phase.energy < better * share)
      return message("cyclic alignment would leave ", phase.energy, " of the two motions' own terms where this leaves ",
                     share, ": the second from ", phase.window.begin, ", ", phase.window.length, " times");
  }
  const PartSearch of_second = search_part(first, second, options), of_first = search_part(second, first, options);
  const PartSearch& part = of_second.energy < of_first.energy ? of_second : of_first;
  if (part.energy < better * share)
    return message("partial alignment would leave ", part.energy, " of the two motions' own terms where this leaves ",
                   share, ": the ", &part == &of_second ? "second" : "first", " up to ", part.share);
  return {};
}

}  // namespace detail

/// Registers the second curve to the first in time.
/// returns  an increasing warp; the identity where nothing better was found, or where a curve rests
/// accuracy L2 error below 1e-3 for strong smooth warps [elastic/temporal_registration_test]; energy_after is the same for
///          the curves exchanged, to the last bit [elastic/temporal_laws_test]
/// throws   InvalidArgument for curves of different dimensions, or options out of their ranges
inline TemporalResult register_temporally(const Curve& first, const Curve& second,
                                          const TemporalOptions& options = {}) {
  require(first.dimension() == second.dimension(), "register_temporally: curves in R^", first.dimension(), " and R^",
          second.dimension(), ", project both on one basis");
  require(!options.cosines.empty() && options.grid >= 2 && options.max_slope >= 1,
          "register_temporally: ", options.cosines.size(), " levels on a grid of ", options.grid, " with slopes up to ",
          options.max_slope, ", give at least one level, two nodes and a slope of 1");
  require(options.penalty >= 0 && options.passes >= 0 && options.min_share > 0 && options.min_share <= 1 &&
              options.min_slope > 0 && options.min_slope < 1,
          "register_temporally: penalty ", options.penalty, ", passes ", options.passes, ", min_share ",
          options.min_share, ", min_slope ", options.min_slope,
          "; the first two may not be negative, the others are between 0 and 1");
  const TimeGrid grid = time_grid();
  const detail::CurveNorms norms{squared_norm(warped_srvf(first, {}, grid), grid),
                                 squared_norm(warped_srvf(second, {}, grid), grid)};
  TemporalResult result;
  TemporalSummary& summary = result.summary;
  summary.norm = norms.first;
  summary.energy_before = summary.energy_after = elastic_energy(first, second, TimeWarp());
  summary.stop = "nothing better than the identity was found";
  if (!(summary.energy_before > 1e-14 * norms.mean())) return result;

  const double penalty = options.penalty * norms.mean();
  const double identity = summary.energy_before / (norms.first + norms.second);
  double best = identity;
  const auto offer = [&](const TimeWarp& warp, const TimeWindow& window1, const TimeWindow& window2, double energy,
                         double share) {
    constexpr double gain = 1e-6;  // a resting curve has the same energy along any warp, but for rounding
    if (!(share < best && share < (1 - gain) * identity)) return;
    best = share;
    result.warp = warp;
    result.first = window1;
    result.second = window2;
    summary.energy_after = energy;
    summary.stop = "all levels done";
  };
  // A registration to the first, or to the second, judged by what it leaves of the stretches' own terms.
  enum class Target { to_first, to_second };
  const auto judge = [&](const detail::DirectedRegistration& r, Target target) {
    summary.steps += r.steps;
    const bool ahead = target == Target::to_first;
    const Curve &a = ahead ? first : second, &b = ahead ? second : first;
    const double own =
        squared_norm(warped_srvf(a, {}, grid), grid) + squared_norm(warped_srvf(b, {}, grid, r.window), grid);
    const double energy = elastic_energy(a, b, r.warp, {{}, r.window, 0});
    const double cost = elastic_energy(a, b, r.warp, {{}, r.window, penalty});
    const TimeWindow all;
    offer(ahead ? r.warp : inverse(r.warp), ahead ? all : r.window, ahead ? r.window : all, energy, cost / own);
  };
  const detail::CurveNorms exchanged{norms.second, norms.first};
  if (options.alignment == TemporalAlignment::cyclic) {
    const TimeWindow start = detail::search_phase(first, second, norms, 24, options).window;
    judge(detail::register_directed(first, second, norms, start, detail::FreeWindow::begin, options), Target::to_first);
  } else {
    const auto free =
        options.alignment == TemporalAlignment::partial ? detail::FreeWindow::length : detail::FreeWindow::none;
    judge(detail::register_directed(first, second, norms, {}, free, options), Target::to_first);
    judge(detail::register_directed(second, first, exchanged, {}, free, options), Target::to_second);
  }
  summary.min_slope = std::min(result.warp.min_slope(), 1 / result.warp.slopes().maxCoeff());
  if (options.alignment == TemporalAlignment::whole)
    summary.advice = detail::advice(first, second, norms, best, options);
  return result;
}

}  // namespace dsns
