#pragma once
/// Karcher mean, or median, of curves up to warps of time: align all to it, centre the warps, average the SRVFs, repeat.
#include <dsns/core/parallel.hpp>
#include <dsns/core/progress.hpp>
#include <dsns/elastic/temporal_registration.hpp>

#include <algorithm>
#include <numeric>
#include <utility>

namespace dsns {

/// mean: least sum of squared distances; median: least sum of distances, which a few outliers hardly move.
enum class KarcherCentre { mean, median };

struct KarcherOptions {
  KarcherCentre centre = KarcherCentre::mean;
  std::vector<double> weights = {};  ///< one a curve, not negative; empty: 1 each
  int iterations = 30;
  double tolerance = 1e-3;  ///< converged when an iteration lowers the energy by no more than this share of the first
  TemporalOptions temporal;
  int threads = 1;
};

struct KarcherSummary {
  /// Sum of weighted squared distances to the mean (median: of distances): before any warp, then after every iteration.
  std::vector<double> energy;
  double min_slope = 1;  ///< over all warps
  bool converged = false;
};

struct KarcherMean {
  Eigen::VectorXd start;        ///< K
  Eigen::MatrixXd q;            ///< SRVF of the mean on the grid of time_grid(), K x n
  std::vector<TimeWarp> warps;  ///< curve i is taken along warps[i]; their own mean is the identity
  KarcherSummary summary;
};

namespace detail {

/// The SRVFs of all curves along their warps, their centre, and the energy around it.
struct AlignedCurves {
  std::vector<Eigen::MatrixXd> q;
  Eigen::VectorXd start;
  Eigen::MatrixXd mean;
  double energy = 0;
};

inline AlignedCurves align(const std::vector<Curve>& curves, const std::vector<TimeWarp>& warps, const TimeGrid& grid,
                           const KarcherOptions& options) {
  AlignedCurves aligned;
  for (std::size_t i = 0; i < curves.size(); ++i) aligned.q.push_back(warped_srvf(curves[i], warps[i], grid));
  const auto average = [&](const std::vector<double>& weights) {
    const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
    aligned.start.setZero(curves.front().dimension());
    aligned.mean.setZero(curves.front().dimension(), grid.times.size());
    for (std::size_t i = 0; i < curves.size(); ++i) {
      aligned.start += weights[i] / total * curves[i].start();
      aligned.mean += weights[i] / total * aligned.q[i];
    }
  };
  const auto squared_distance = [&](std::size_t i) {
    return squared_norm(aligned.q[i] - aligned.mean, grid) + (curves[i].start() - aligned.start).squaredNorm();
  };
  const auto energy = [&] {
    double sum = 0;
    for (std::size_t i = 0; i < curves.size(); ++i)
      sum += options.weights[i] *
             (options.centre == KarcherCentre::mean ? squared_distance(i) : std::sqrt(squared_distance(i)));
    return sum;
  };
  average(options.weights);
  aligned.energy = energy();
  if (options.centre == KarcherCentre::mean) return aligned;
  // Weiszfeld 1937: the median is the mean with the inverse distances to it as weights.
  constexpr double least_distance = 1e-12;
  for (int step = 0; step < 200; ++step) {
    std::vector<double> weights;
    for (std::size_t i = 0; i < curves.size(); ++i)
      weights.push_back(options.weights[i] / std::max(std::sqrt(squared_distance(i)), least_distance));
    average(weights);
    const double former = std::exchange(aligned.energy, energy());
    if (former - aligned.energy <= 1e-10 * former) break;
  }
  return aligned;
}

}  // namespace detail

/// returns  the mean with energies that never rise: a curve keeps its warp where a new one is no better
/// accuracy copies of one curve under known warps are brought together [stats/karcher_mean_test]
/// source   Srivastava, Klassen 2016, section 7.5; the start is the curve nearest to the average
inline KarcherMean karcher_mean(const std::vector<Curve>& curves, KarcherOptions options = {},
                                const Progress& progress = {}) {
  require(!curves.empty(), "karcher_mean: no curves, give at least one");
  if (options.weights.empty()) options.weights.assign(curves.size(), 1);
  require(options.weights.size() == curves.size() &&
              *std::min_element(options.weights.begin(), options.weights.end()) >= 0 &&
              *std::max_element(options.weights.begin(), options.weights.end()) > 0,
          "karcher_mean: ", options.weights.size(), " weights for ", curves.size(),
          " curves, give as many, none negative, not all 0");
  const TimeGrid grid = time_grid();
  KarcherMean result;
  result.warps.resize(curves.size());
  detail::AlignedCurves aligned = detail::align(curves, result.warps, grid, options);
  result.summary.energy.push_back(aligned.energy);
  std::size_t nearest = 0;
  for (std::size_t i = 1; i < curves.size(); ++i)
    if (squared_norm(aligned.q[i] - aligned.mean, grid) < squared_norm(aligned.q[nearest] - aligned.mean, grid))
      nearest = i;
  Eigen::MatrixXd target = aligned.q[nearest];
  TemporalOptions temporal = options.temporal;
  temporal.alignment = TemporalAlignment::whole;  // a mean of all of them
  temporal.search_grid = 0;                       // nobody is there to be advised
  const Eigen::VectorXd no_start = Eigen::VectorXd::Zero(curves.front().dimension());

  for (int iteration = 0; iteration < options.iterations && !result.summary.converged; ++iteration) {
    report(progress, "mean", double(iteration) / options.iterations);
    const Curve mean_curve = curve_of_srvf(no_start, target);
    std::vector<TimeWarp> warps(curves.size());
    parallel_for(static_cast<int>(curves.size()), options.threads, [&](int k) {
      const auto i = std::size_t(k);
      warps[i] = register_temporally(mean_curve, curves[i], temporal).warp;
      const auto miss = [&](const TimeWarp& w) { return squared_norm(target - warped_srvf(curves[i], w, grid), grid); };
      if (miss(result.warps[i]) < miss(warps[i])) warps[i] = result.warps[i];
    });
    const TimeWarp centre = inverse(karcher_mean(warps, options.weights));
    for (auto& warp : warps) warp = compose(warp, centre);
    detail::AlignedCurves next = detail::align(curves, warps, grid, options);
    const double gain = aligned.energy - next.energy;
    if (gain > 0) {
      aligned = std::move(next);
      result.warps = std::move(warps);
    }
    result.summary.energy.push_back(aligned.energy);
    result.summary.converged = gain <= options.tolerance * result.summary.energy.front();
    target = aligned.mean;
  }
  result.start = aligned.start;
  result.q = aligned.mean;
  for (const auto& warp : result.warps) result.summary.min_slope = std::min(result.summary.min_slope, warp.min_slope());
  report(progress, "mean", 1);
  return result;
}

/// The mean of n curves with one more: this one alone is registered. The mean's clock is centred again.
/// returns  what karcher_mean of all would, unless the others' warps would have to change much
/// accuracy for copies of one curve, a thousandth of its size from the mean of all [stats/karcher_mean_test]
inline KarcherMean with_one_more(KarcherMean mean, const Curve& curve, TemporalOptions temporal = {}) {
  require(!mean.warps.empty() && curve.dimension() == mean.start.size(), "with_one_more: a curve in R^",
          curve.dimension(), " for a mean of ", mean.warps.size(), " in R^", mean.start.size(),
          ", project it on the same basis");
  temporal.alignment = TemporalAlignment::whole;
  temporal.search_grid = 0;
  const TimeGrid grid = time_grid();
  const double n = double(mean.warps.size());
  mean.warps.push_back(register_temporally(curve_of_srvf(mean.start, mean.q), curve, temporal).warp);
  const Eigen::MatrixXd q = warped_srvf(curve, mean.warps.back(), grid);
  // Squared distances to a new centre are those to the old one and n times the way between them.
  mean.summary.energy.push_back(mean.summary.energy.back() +
                                n / (n + 1) *
                                    (squared_norm(q - mean.q, grid) + (curve.start() - mean.start).squaredNorm()));
  const Eigen::MatrixXd next = (n * mean.q + q) / (n + 1);
  mean.start = (n * mean.start + curve.start()) / (n + 1);
  const TimeWarp centre = inverse(karcher_mean(mean.warps));
  mean.q = warped_srvf(curve_of_srvf(mean.start, next), centre, grid);
  mean.summary.min_slope = 1;
  for (TimeWarp& warp : mean.warps) {
    warp = compose(warp, centre);
    mean.summary.min_slope = std::min(mean.summary.min_slope, warp.min_slope());
  }
  return mean;
}

}  // namespace dsns
