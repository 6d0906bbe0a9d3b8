#pragma once
/// Karcher mean of curves up to warps of time: align all to the mean, centre the warps, average the SRVFs, repeat.
#include <dsns/core/parallel.hpp>
#include <dsns/core/progress.hpp>
#include <dsns/elastic/temporal_registration.hpp>

namespace dsns {

struct KarcherOptions {
  int iterations = 30;
  double tolerance = 1e-4;  ///< converged when an iteration lowers the energy by less than this share of it
  TemporalOptions temporal;
  int threads = 1;
};

struct KarcherSummary {
  std::vector<double> energy;  ///< sum of squared distances to the mean: before any warp, then after every iteration
  double min_slope = 1;        ///< over all warps
  bool converged = false;
};

struct KarcherMean {
  Eigen::VectorXd start;        ///< mean of the starts, K
  Eigen::MatrixXd q;            ///< SRVF of the mean on the grid of time_grid(), K x n
  std::vector<TimeWarp> warps;  ///< curve i is taken along warps[i]; their own mean is the identity
  KarcherSummary summary;
};

namespace detail {

/// The SRVFs of all curves along their warps, their average, and the sum of squared distances to the mean.
struct AlignedCurves {
  std::vector<Eigen::MatrixXd> q;
  Eigen::MatrixXd mean;
  double energy = 0;
};

inline AlignedCurves align(const std::vector<Curve>& curves, const std::vector<TimeWarp>& warps, const TimeGrid& grid) {
  AlignedCurves aligned;
  Eigen::VectorXd start = Eigen::VectorXd::Zero(curves.front().dimension());
  for (std::size_t i = 0; i < curves.size(); ++i) {
    aligned.q.push_back(warped_srvf(curves[i], warps[i], grid));
    aligned.mean = i == 0 ? aligned.q.back() : Eigen::MatrixXd(aligned.mean + aligned.q.back());
    start += curves[i].start() / double(curves.size());
  }
  aligned.mean /= double(curves.size());
  for (std::size_t i = 0; i < curves.size(); ++i)
    aligned.energy += squared_norm(aligned.q[i] - aligned.mean, grid) + (curves[i].start() - start).squaredNorm();
  return aligned;
}

}  // namespace detail

/// returns  the mean with energies that never rise: a curve keeps its warp where a new one is no better
/// accuracy copies of one curve under known warps are brought together [stats/karcher_mean_test]
/// source   Srivastava, Klassen 2016, section 7.5; the start is the curve nearest to the average
inline KarcherMean karcher_mean(const std::vector<Curve>& curves, const KarcherOptions& options = {},
                                const Progress& progress = {}) {
  require(!curves.empty(), "karcher_mean: no curves, give at least one");
  const TimeGrid grid = time_grid();
  KarcherMean result;
  result.warps.resize(curves.size());
  detail::AlignedCurves aligned = detail::align(curves, result.warps, grid);
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
    const TimeWarp centre = inverse(karcher_mean(warps));
    for (auto& warp : warps) warp = compose(warp, centre);
    detail::AlignedCurves next = detail::align(curves, warps, grid);
    const double gain = aligned.energy - next.energy;
    if (gain > 0) {
      aligned = std::move(next);
      result.warps = std::move(warps);
    }
    result.summary.energy.push_back(aligned.energy);
    result.summary.converged = gain <= options.tolerance * aligned.energy;
    target = aligned.mean;
  }
  result.start = Eigen::VectorXd::Zero(curves.front().dimension());
  for (const auto& curve : curves) result.start += curve.start() / double(curves.size());
  result.q = aligned.mean;
  for (const auto& warp : result.warps) result.summary.min_slope = std::min(result.summary.min_slope, warp.min_slope());
  report(progress, "mean", 1);
  return result;
}

}  // namespace dsns
