#pragma once
/// Fits a network to a moving surface: random points of the sphere and times, mean squared error of the coordinates and, on
/// request, of the derivatives and normals. A training step is the differentiation engine's matrix tape, tile by tile.
///
///   FitOptions options;
///   options.seconds = 30;
///   options.threads = 2;
///   const FitResult fit = fit_neural_surface(sampled_surface, options);
///   fit.surface(s, t);                               // a NeuralSurface, in the units of the target
#include <dsns/core/progress.hpp>
#include <dsns/core/spline.hpp>
#include <dsns/nn/neural_surface.hpp>
#include <dsns/nn/surface_archive.hpp>
#include <dsns/nn/surface_problem.hpp>
#include <dsns/nn/training_archive.hpp>

#include <chrono>
#include <ctime>

namespace dsns {

/// How far a training is.
struct FitState {
  int steps;
  double seconds;      ///< of wall time in the steps
  double cpu_seconds;  ///< of the process since the fit began, observers left out
  const NeuralSurface& surface;
};

struct FitOptions {
  SurfaceEncoding encoding = {};
  int width = 64;
  int blocks = 2;
  Activation activation = Activation::silu;

  int points = 20000;                    ///< of the sphere, drawn once
  int times = 48;                        ///< equidistant in [0, 1]; 1: a surface at rest, taken at t = 0
  std::vector<double> frame_times = {};  ///< these, increasing, instead of equidistant ones
  int batch = 1024;                      ///< (point, time) pairs a step
  int steps = 6000;
  double seconds = 0;           ///< of wall time for all; 0: no limit. With a limit runs are not repeatable
  double target_msd = 0;        ///< stops where the error at other points is below, in units of scale^2; 0: never
  double learning_rate = 1e-2;  ///< at its highest; rises over the first hundredth and falls to 0 along half a cosine
  LossWeights loss = {};
  OptimizerOptions optimizer = {};
  double clip_norm = 0;  ///< longest gradient; 0: no limit
  std::uint64_t seed = 0;
  int threads = 1;  ///< the result does not depend on it
  /// Where points are drawn: n unit vectors, 3 x n. Empty: uniformly on the sphere.
  std::function<Mat3X(int n, std::mt19937_64& random)> sampler = {};
  /// Called about every `observe_every` seconds with what has been learnt so far; its own time does not count.
  std::function<void(const FitState&)> observer = {};
  double observe_every = 1;
  CheckpointOptions checkpoint = {};
};

enum class FitStop {
  steps,
  seconds,
  target_msd,
  functions,  ///< a closed form has as many as it may
};

struct FitSummary {
  int steps = 0;
  Index parameters = 0;
  double cpu_seconds = 0;     ///< of the process, and of those that a resumed fit ran in before
  std::vector<double> loss;   ///< mean squared coordinate error of the batches, in scale^2, over stretches of steps
  double validation_msd = 0;  ///< at points beside the trained ones, in scale^2, when target_msd was last judged by it
  FitStop stopped = FitStop::steps;
};

struct FitResult {
  NeuralSurface surface;
  FitSummary summary;
};

/// The network, encoding, optimiser and batch of the D-SNS paper. 12.7 million parameters: days, not seconds.
inline FitOptions paper_fit() {
  FitOptions o;
  o.encoding = paper_encoding();
  o.width = 1024;
  o.blocks = 6;
  o.activation = Activation::softplus;
  o.optimizer.kind = OptimizerKind::rmsprop;
  o.batch = 80000;
  o.steps = 50000;
  o.learning_rate = 1e-4;
  return o;
}

namespace detail {

inline void check_fit_options(const FitOptions& o) {
  require(o.points > 0 && o.times > 0 && o.steps > 0 && o.threads > 0 && o.batch > 0, "fit: ", o.points, " points, ",
          o.times, " times, ", o.steps, " steps, ", o.threads, " threads, a batch of ", o.batch,
          "; give at least 1 of each");
  require(o.learning_rate > 0 && o.seconds >= 0 && o.target_msd >= 0, "fit: learning rate ", o.learning_rate, ", ",
          o.seconds, " seconds and a target of ", o.target_msd, " must not be negative");
  require(o.loss.tangents >= 0 && o.loss.normals >= 0, "fit: loss weights ", o.loss.tangents, " and ", o.loss.normals,
          " must not be negative");
}

/// Wall and processor time since a start, of which spans can be left out.
class TrainingClock {
 public:
  explicit TrainingClock(double seconds = 0) : start_(Clock::now() - to_duration(seconds)) {}

  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
  double cpu_seconds() const { return double(std::clock() - cpu_start_) / CLOCKS_PER_SEC; }
  template <class F>
  void leave_out(const F& span) {
    const Clock::time_point start = Clock::now();
    const std::clock_t cpu_start = std::clock();
    span();
    start_ += Clock::now() - start;
    cpu_start_ += std::clock() - cpu_start;
  }

 private:
  using Clock = std::chrono::steady_clock;
  static Clock::duration to_duration(double seconds) {
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  }
  Clock::time_point start_;
  std::clock_t cpu_start_ = std::clock();
};

/// The chosen times, or so many equidistant ones.
inline std::vector<double> fit_times(int count, const std::vector<double>& chosen) {
  for (std::size_t k = 0; k < chosen.size(); ++k)
    require(std::isfinite(chosen[k]) && (k == 0 || chosen[k] > chosen[k - 1]), "fit: frame ", k,
            " is at t = ", chosen[k], ", give finite times that increase");
  return chosen.empty() ? equidistant_times(count) : chosen;
}

/// The target at points that are not trained on, at a few of the times. The error of batches flatters a network that has
/// seen them, so a target error is judged here; a check costs a few steps.
template <class F>
class Validation {
 public:
  /// Options: of either fit.
  template <class Options>
  Validation(const F& target, const Options& options, const std::vector<double>& times) {
    if (!(options.target_msd > 0)) return;
    constexpr int count = 1000;
    constexpr std::size_t most = 4;
    std::mt19937_64 random(options.seed + 1);
    points_ = options.sampler ? options.sampler(count, random) : uniform_sphere_points(count, random);
    for (std::size_t k = 0, n = std::min(most, times.size()); k < n; ++k)
      times_.push_back(times[k * (times.size() - 1) / std::max<std::size_t>(n - 1, 1)]);
    visit_positions(target, points_, times_, [&](Index, const Mat3X& p) { positions_.push_back(p); });
  }

  /// MSD in units of scale^2.
  template <class G>
  double msd(const G& fitted) const {
    double sum = 0;
    for (std::size_t k = 0; k < times_.size(); ++k)
      sum += (fitted.positions(points_, times_[k]) - positions_[k]).squaredNorm();
    return sum / (3 * double(points_.cols()) * double(times_.size()) * fitted.scale() * fitted.scale());
  }

 private:
  Mat3X points_;
  std::vector<double> times_;
  std::vector<Mat3X> positions_;
};

inline FitIdentity identity_of(const FitOptions& o, std::uint64_t target) {
  FitIdentity id;
  identify(id, o.encoding);
  id.add("width", o.width);
  id.add("blocks", o.blocks);
  id.add("activation", static_cast<double>(o.activation));
  id.add("points", o.points);
  id.add("times", o.frame_times.empty() ? o.times : double(o.frame_times.size()));
  id.add("batch", o.batch);
  id.add("steps", o.steps);
  id.add("seconds", o.seconds);
  id.add("learning rate", o.learning_rate);
  id.add("weight of tangents", o.loss.tangents);
  id.add("weight of normals", o.loss.normals);
  id.add("clip norm", o.clip_norm);
  identify(id, o.optimizer);
  identify_seed(id, o.seed);
  id.target = target;
  return id;
}

/// Steps until steps, seconds or error end it. `observe(steps, seconds, cpu_seconds)` is called now and then, and
/// `store(archive)` where a checkpoint is due, for the surface; `validate()` gives the error at other points where that of the
/// batches is below the target.
template <class T, class Problem, class Observe, class Store, class Validate>
FitSummary train(Trainer<T, Problem>& trainer, const FitOptions& options, const FitIdentity& identity,
                 const Progress& progress, const Observe& observe, const Store& store, const Validate& validate) {
  const CosineRate schedule{0.01, 0};
  TrainingProgress at;
  at.budget = options.seconds;
  if (options.checkpoint.resume != nullptr) at = resume_training(*options.checkpoint.resume, identity, trainer);
  FitSummary summary;
  summary.parameters = trainer.network().parameters().size();
  summary.steps = static_cast<int>(trainer.steps());
  const int window = std::clamp(options.steps / 100, 1, 500);
  require<FileError>(Index(at.loss.size()) == summary.steps / window, "fit: a checkpoint of ", summary.steps,
                     " steps with ", at.loss.size(), " errors");
  TrainingClock clock(at.seconds);
  const double earlier_cpu_seconds = at.cpu_seconds;
  const auto checkpoint = [&] {
    if (!options.checkpoint.write) return;
    Archive archive;
    store(archive);
    store_training(archive, identity, trainer, at);
    options.checkpoint.write(archive);
  };
  double observed = at.seconds, written = -options.checkpoint.every + at.seconds;
  for (;; ++summary.steps) {
    at.seconds = clock.seconds();
    at.cpu_seconds = earlier_cpu_seconds + clock.cpu_seconds();
    const bool complete = summary.steps > 0 && summary.steps % window == 0;
    if (complete && at.loss.back() < options.target_msd) {
      summary.validation_msd = validate();
      if (summary.validation_msd < options.target_msd) {
        summary.stopped = FitStop::target_msd;
        break;
      }
    }
    if (summary.steps >= options.steps) break;
    double done = (summary.steps + 0.5) / options.steps;
    if (at.budget > 0) {
      if (at.seconds >= at.budget) {
        summary.stopped = FitStop::seconds;
        break;
      }
      done = std::max(done, at.seconds / at.budget);
    }
    if (complete) report(progress, "fit", done);
    if (options.observer && at.seconds >= observed + options.observe_every) {
      observed = at.seconds;
      clock.leave_out([&] { observe(summary.steps, at.seconds, at.cpu_seconds); });
    }
    if (at.seconds >= written + options.checkpoint.every) {
      written = at.seconds;
      checkpoint();
    }
    const double loss = trainer.step(options.learning_rate * schedule(done));
    require<Error>(std::isfinite(loss), "fit: the training diverged at step ", summary.steps,
                   "; lower the learning rate ", options.learning_rate);
    at.window_loss += loss / window;
    if ((summary.steps + 1) % window == 0) at.loss.push_back(std::exchange(at.window_loss, 0));
  }
  checkpoint();
  report(progress, "fit", 1);
  summary.loss = std::move(at.loss);
  summary.cpu_seconds = at.cpu_seconds;
  return summary;
}

template <class T, JetLayout layout, class F>
FitResult fit_layout(const F& target, const FitOptions& options, const Progress& progress) {
  const TrainingClock clock;
  std::mt19937_64 random(options.seed);
  const Mat3X points =
      options.sampler ? options.sampler(options.points, random) : uniform_sphere_points(options.points, random);
  require(points.cols() == options.points && ((points.colwise().norm().array() - 1).abs() < 1e-9).all(),
          "fit: the sampler gave ", points.cols(), " points for ", options.points, ", or not unit vectors");
  std::vector<double> times = fit_times(options.times, options.frame_times);
  const Validation<F> validation(target, options, times);
  const SurfaceProblem<T, layout> problem(target, options.encoding, points, std::move(times), options.loss);
  const MlpShape shape{static_cast<int>(options.encoding.features()), options.width, options.blocks, 3,
                       options.activation};
  Trainer<T, SurfaceProblem<T, layout>> trainer(
      problem, Mlp<T>(shape, random()),
      {options.batch, options.threads, options.clip_norm, options.optimizer, options.seed});
  const auto surface = [&] {
    return NeuralSurface(options.encoding, trainer.network().template cast<double>(), problem.ball().translation,
                         problem.ball().scale);
  };
  const double prepared = clock.cpu_seconds();
  FitOptions budget = options;
  if (options.seconds > 0) budget.seconds = std::max(1e-3, options.seconds - clock.seconds());
  FitSummary summary = train(
      trainer, budget, identity_of(options, problem.checksum()), progress,
      [&](int steps, double seconds, double cpu_seconds) {
        options.observer({steps, seconds, cpu_seconds + prepared, surface()});
      },
      [&](Archive& archive) {
        store_surface(archive, BasicNeuralSurface<T>(options.encoding, trainer.network(), problem.ball().translation,
                                                     problem.ball().scale));
      },
      [&] { return validation.msd(surface()); });
  summary.cpu_seconds += prepared;
  return {surface(), std::move(summary)};
}

}  // namespace detail

/// Trains in precision T and returns the surface in double precision.
/// target   AnimatedSurface
/// returns  the surface in the target's units, and how it went
/// accuracy mean squared coordinate error below 1e-5 scale^2 on a moving ellipsoid in a second [nn/fit_test]
/// throws   InvalidArgument for unusable options, Error where the training diverges
template <class T = float, AnimatedSurface F>
FitResult fit_neural_surface(const F& target, const FitOptions& options = {}, const Progress& progress = {}) {
  detail::check_fit_options(options);
  if (options.loss.tangents > 0 || options.loss.normals > 0)
    return detail::fit_layout<T, jet_layouts::tangents>(target, options, progress);
  return detail::fit_layout<T, jet_layouts::value>(target, options, progress);
}

}  // namespace dsns
