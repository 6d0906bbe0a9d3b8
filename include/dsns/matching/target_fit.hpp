#pragma once
/// A piecewise-linear diffeomorphism fitted to targets that are no map themselves: noisy, partly wrong, many to one.
///
///   const auto nearest = [&](const Mat3X& y) -> Mat3X { ... };   // for images of the vertices, where each ought to be
///   const TargetFit fit = fit_to_targets(SphereDiffeomorphism(start), nearest);
///   fit.map;                                                     // certified one to one, whatever the targets were
///
/// Minimised over the images y_i of an icosphere's vertices, masses m_i, is
///   sum of m_i rho(|y_i - target_i|) + elastic * mean |(Laplacian + 2) y|^2 + barrier on small Jacobians
/// with rho(d) = d^2 / (1 + d^2 / r^2) of Geman and McClure. The elastic term leaves rotations free. From coarse icospheres to
/// fine ones and from stiff to soft, a step solves the problem without its barrier, goes there as far as no face turns over,
/// and lets every vertex settle in the full energy.
#include <dsns/core/progress.hpp>
#include <dsns/matching/target_problem.hpp>
#include <dsns/sphere/landmarks.hpp>

#include <optional>

namespace dsns {

/// One query of the targets, and steps towards them.
struct TargetFitStage {
  int level;       ///< of the icosphere whose vertices move
  double elastic;  ///< weight of the elastic energy
  double robust;   ///< radians: targets much farther away than this hardly count
  int steps;
};

struct TargetFitOptions {
  int level = 5;  ///< of the icosphere whose vertices have targets, and of the result
  /// In this order. Levels above `level` count as that, and once fine the icosphere stays so. A finest elastic weight of 1e-6
  /// follows targets whose errors go together; where each is wrong by itself, 1e-5 averages more of them.
  std::vector<TargetFitStage> stages{{3, 1e-3, 0.5, 3}, {3, 1e-4, 0.5, 3}, {3, 3e-5, 0.5, 3}, {4, 3e-5, 0.5, 3},
                                     {4, 1e-5, 0.5, 3}, {4, 1e-5, 0.2, 3}, {4, 3e-6, 0.2, 3}, {5, 3e-6, 0.2, 1},
                                     {5, 1e-6, 0.2, 1}, {5, 1e-6, 0.2, 1}};
  int sweeps = 20;                 ///< over all vertices after each step
  double barrier_threshold = 0.1;  ///< Jacobians above it are free
  double barrier = 1e-3;           ///< weight
  Eigen::VectorXd weights{};       ///< of the vertices' targets, a factor each; empty: all 1
};

struct TargetFitSummary {
  std::vector<double> energies;  ///< after each stage, with its weights
  int steps = 0;
  AngularDistance to_targets;  ///< of the vertices' images from the last targets, radians
  AngularDistance to_landmarks;
  double min_jacobian = 0;  ///< by certify()
};

struct TargetFit {
  PiecewiseLinearDiffeomorphism map;
  TargetFitSummary summary;
};

/// Gives, for images of the vertices of the icosphere, 3 x n, the targets as they are seen from there, 3 x n unit columns.
template <class F>
concept SphereTargets = requires(const F& targets, const Mat3X& images) {
  { targets(images) } -> std::same_as<Mat3X>;
};

namespace detail {

inline void require_targets(const Mat3X& targets, Index count, const char* of) {
  require(targets.cols() == count, "fit_to_targets: ", targets.cols(), " targets for ", count, " ", of);
  for (Index i = 0; i < count; ++i)
    require(std::abs(targets.col(i).norm() - 1) < 1e-6, "fit_to_targets: the target of number ", i, " of the ", of,
            " has length ", targets.col(i).norm(), ", give unit vectors");
}

/// The coarsest level from `level` on where samples of the start are one to one.
template <SphereMap G>
int level_without_folds(const G& start, int level, int finest) {
  for (; level < finest; ++level) {
    const TriangleMesh sphere = icosphere(level);
    if (certify(start(sphere.vertices), sphere.faces).bijective()) return level;
  }
  return finest;
}

}  // namespace detail

/// Fits to targets that depend on where the map is.
/// start    whose samples on the icosphere must not fold
/// returns  a map whose every triangle is upright, by the exact certificate
/// accuracy on a level-4 icosphere a warp of 10 degrees from its exact targets to 0.05 degrees rms; from targets with independent
///          noise of 5 degrees and 10 % gross outliers to 3 degrees, and to 1.6 where `elastic` stays above 1e-5. Permuted,
///          mirrored and constant targets give certified maps [matching/target_fit_test]
/// throws   InvalidArgument where sizes do not fit or targets are not unit vectors; UnusableMesh where the start folds
template <SphereMap G, SphereTargets F>
TargetFit fit_to_targets(const G& start, const F& targets, const TargetFitOptions& options = {},
                         const SphereLandmarks& landmarks = {}, const Progress& progress = {}) {
  require(!options.stages.empty(), "fit_to_targets: no stages, give at least one");
  const TriangleMesh sphere = icosphere(options.level);
  const Index n = sphere.vertices.cols();
  require(options.weights.size() == 0 || (options.weights.size() == n && !(options.weights.array() < 0).any()),
          "fit_to_targets: ", options.weights.size(), " weights for ", n, " vertices, or negative ones");
  require_landmarks(landmarks, "fit_to_targets");

  detail::Observations dense{sphere.vertices, {}, vertex_areas(sphere.vertices, sphere.faces)};
  dense.weights /= dense.weights.sum();
  if (options.weights.size() > 0) dense.weights.array() *= options.weights.array();
  const detail::Observations sparse{landmarks.points, landmarks.targets, landmarks.weights};
  const int coarsest =
      detail::level_without_folds(start, std::min(options.stages.front().level, options.level), options.level);

  std::optional<detail::TargetProblem> problem;
  std::vector<SphereHit> dense_hits, sparse_hits;
  int level = -1;
  Mat3X y;
  const auto change_level = [&](int to) {
    const Mat3X vertices = icosphere(to).vertices;
    y = problem ? Mat3X(problem->interpolate(y, problem->locate(vertices)).colwise().normalized()) : start(vertices);
    problem.emplace(to, detail::JacobianBarrier{options.barrier_threshold, options.barrier});
    level = to;
    dense_hits = problem->locate(dense.points);
    sparse_hits = problem->locate(sparse.points);
  };
  const auto images = [&]() -> Mat3X { return problem->interpolate(y, dense_hits).colwise().normalized(); };
  TargetFitSummary summary;
  for (std::size_t k = 0; k < options.stages.size(); ++k) {
    const TargetFitStage& stage = options.stages[k];
    report(progress, "fit to targets", double(k) / double(options.stages.size()));
    const int wanted = std::max(level, std::clamp(stage.level, coarsest, options.level));
    if (wanted != level) change_level(wanted);
    dense.targets = targets(images());
    detail::require_targets(dense.targets, n, "vertices");
    dense.robust = stage.robust;
    for (int step = 0; step < stage.steps; ++step, ++summary.steps) {
      problem->begin(y, stage.elastic);
      problem->observe(y, dense, dense_hits);
      problem->observe(y, sparse, sparse_hits);
      y = problem->global_step(y);
      problem->settle(y, options.sweeps);
    }
    summary.energies.push_back(problem->energy(y));
  }
  y = images();
  summary.to_targets = angular_distance(y, dense.targets, dense.weights);
  PiecewiseLinearDiffeomorphism map(sphere, std::move(y));
  if (sparse.points.cols() > 0)
    summary.to_landmarks = angular_distance(map(sparse.points), sparse.targets, sparse.weights);
  summary.min_jacobian = certify(map).min_jacobian;
  report(progress, "fit to targets", 1);
  return {std::move(map), std::move(summary)};
}

/// Fits to targets that stay: one unit column for each vertex of the icosphere of options.level.
template <SphereMap G>
TargetFit fit_to_targets(const G& start, const Mat3X& targets, const TargetFitOptions& options = {},
                         const SphereLandmarks& landmarks = {}, const Progress& progress = {}) {
  return fit_to_targets(
      start, [&](const Mat3X&) { return targets; }, options, landmarks, progress);
}

}  // namespace dsns
