#pragma once
/// Fits a network to a moving surface: random points of the sphere and times, mean squared error of the coordinates,
/// RMSProp. A training step is the differentiation engine's matrix tape, tile by tile.
///
///   FitOptions options;
///   options.seconds = 30;
///   options.threads = 2;
///   const FitResult fit = fit_neural_surface(sampled_surface, options);
///   fit.surface(s, t);                               // a NeuralSurface, in the units of the target
#include <dsns/core/parallel.hpp>
#include <dsns/core/progress.hpp>
#include <dsns/nn/neural_surface.hpp>
#include <dsns/optim/rmsprop.hpp>

#include <chrono>
#include <ctime>
#include <functional>
#include <random>
#include <vector>

namespace dsns {

struct FitOptions {
  SurfaceEncoding encoding;
  int width = 64;
  int blocks = 2;
  Activation activation = Activation::silu;

  int points = 20000;  ///< of the sphere, drawn once
  int times = 48;      ///< equidistant in [0, 1]
  int batch = 1024;    ///< (point, time) pairs a step
  int steps = 6000;
  double seconds = 0;           ///< of wall time for the steps; 0: no limit. With a limit runs are not repeatable
  double learning_rate = 5e-4;  ///< at the start; falls to 0 along half a cosine
  RmsPropOptions rmsprop;
  std::uint64_t seed = 0;
  int threads = 1;  ///< the result does not depend on it
  /// Where points are drawn: n unit vectors, 3 x n. Empty: uniformly on the sphere.
  std::function<Mat3X(int n, std::mt19937_64& random)> sampler;
};

enum class FitStop { steps, seconds };

struct FitSummary {
  int steps = 0;
  Index parameters = 0;
  double cpu_seconds = 0;    ///< of the whole process
  std::vector<double> loss;  ///< mean squared coordinate error on the batches, in units of the scale, at most 100 means
  FitStop stopped = FitStop::steps;
};

struct FitResult {
  NeuralSurface surface;
  FitSummary summary;
};

/// The network, encoding and batch of the D-SNS paper. 12.7 million parameters: days, not seconds.
inline FitOptions paper_fit() {
  FitOptions o;
  o.encoding = paper_encoding();
  o.width = 1024;
  o.blocks = 6;
  o.activation = Activation::softplus;
  o.batch = 80000;
  o.steps = 50000;
  o.learning_rate = 1e-4;
  return o;
}

namespace detail {

inline Mat3X uniform_sphere_points(int n, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  Mat3X s(3, n);
  for (double& x : s.reshaped()) x = normal(random);
  return s.colwise().normalized();
}

/// The target's positions at all points for each time in turn; surfaces that locate points do so once.
template <class F, class Visit>
void visit_positions(const F& target, const Mat3X& s, int times, const Visit& visit) {
  const auto time = [times](int k) { return double(k) / (times - 1); };
  if constexpr (requires { { target.positions(target.locate(s), 0.0) } -> std::same_as<Mat3X>; }) {
    const auto places = target.locate(s);
    for (int k = 0; k < times; ++k) visit(k, target.positions(places, time(k)));
  } else {
    for (int k = 0; k < times; ++k) visit(k, positions(target, s, time(k)));
  }
}

/// What is learnt from: encoded points and times, and the target at each pair of them.
struct TrainingSet {
  Eigen::MatrixXf space, time, targets;  // features x points, features x times, 3 x (points times)
  Vec3d translation;
  double scale = 1;

  template <class F>
  TrainingSet(const F& target, const FitOptions& options, std::mt19937_64& random)
      : space(options.encoding.space_features(), options.points),
        time(options.encoding.time_features(), options.times), targets(3, Index(options.points) * options.times) {
    const Mat3X s = options.sampler ? options.sampler(options.points, random) : uniform_sphere_points(options.points, random);
    require(s.cols() == options.points && ((s.colwise().norm().array() - 1).abs() < 1e-9).all(),
            "fit: the sampler gave ", s.cols(), " points for ", options.points, ", or not unit vectors");
    for (Index i = 0; i < s.cols(); ++i) space.col(i) = options.encoding.space(Vec3d(s.col(i))).template cast<float>();
    for (Index k = 0; k < time.cols(); ++k)
      time.col(k) = options.encoding.time(double(k) / double(options.times - 1)).template cast<float>();
    Mat3X all(3, targets.cols());
    visit_positions(target, s, options.times, [&](int k, const Mat3X& p) { all.middleCols(k * s.cols(), s.cols()) = p; });
    require(all.allFinite(), "fit: the target is not finite everywhere");
    translation = all.rowwise().mean();
    all.colwise() -= translation;
    scale = all.colwise().norm().maxCoeff();
    require(scale > 0, "fit: the target is one point");
    targets = (all / scale).cast<float>();
  }
};

/// One tile of a batch: its own tape and gradient, so that the sum over tiles does not depend on threads.
struct TrainingTile {
  static constexpr Index columns = 64;
  MatrixTape<float> tape;
  Eigen::VectorXf gradient;
  Eigen::MatrixXf targets{3, columns};
  std::vector<std::pair<Index, Index>> pairs = std::vector<std::pair<Index, Index>>(columns);  // point, time
  double squared_error = 0;

  void run(const Mlp<float>& network, const TrainingSet& set, float weight) {
    tape.clear();
    gradient.setZero();
    const auto x = tape.constant(network.shape().inputs, columns, [&](Eigen::MatrixXf& m) {
      for (Index j = 0; j < columns; ++j) {
        const auto [point, time] = pairs[static_cast<std::size_t>(j)];
        m.col(j) << set.space.col(point), set.time.col(time);
        targets.col(j) = set.targets.col(time * set.space.cols() + point);
      }
    });
    const auto loss = tape.squared_error(network.record(tape, x, gradient), targets);
    squared_error = double(tape.value(loss)(0, 0));
    tape.backward(loss, weight);
  }
};

inline void check_fit_options(const FitOptions& o) {
  require(o.points > 0 && o.times > 1 && o.steps > 0 && o.threads > 0, "fit: ", o.points, " points, ", o.times,
          " times, ", o.steps, " steps, ", o.threads, " threads; give at least 1, 2, 1 and 1");
  require(o.batch > 0 && o.batch % TrainingTile::columns == 0, "fit: a batch of ", o.batch, ", give a multiple of ",
          TrainingTile::columns);
  require(o.learning_rate > 0 && o.seconds >= 0, "fit: learning rate ", o.learning_rate, " and ", o.seconds,
          " seconds must not be negative");
}

}  // namespace detail

/// Trains in single precision and returns the surface in double precision.
/// target   AnimatedSurface
/// returns  the surface in the target's units, and how it went: the steps end after options.steps or options.seconds
/// accuracy mean squared coordinate error of 1e-6 of the squared scale on a moving ellipsoid in a second [nn/fit_test]
/// throws   InvalidArgument for unusable options, Error where the training diverges
template <AnimatedSurface F>
FitResult fit_neural_surface(const F& target, const FitOptions& options = {}, const Progress& progress = {}) {
  using Clock = std::chrono::steady_clock;
  detail::check_fit_options(options);
  const std::clock_t cpu_start = std::clock();
  std::mt19937_64 random(options.seed);
  const detail::TrainingSet set(target, options, random);

  Mlp<float> network({static_cast<int>(options.encoding.features()), options.width, options.blocks, 3, options.activation},
                     random());
  RmsProp<float> optimizer(network.parameters().size(), options.rmsprop);
  std::vector<detail::TrainingTile> tiles(static_cast<std::size_t>(options.batch / detail::TrainingTile::columns));
  for (auto& tile : tiles) tile.gradient.resize(network.parameters().size());
  Eigen::VectorXf gradient(network.parameters().size());
  std::uniform_int_distribution<Index> any_point(0, options.points - 1), any_time(0, options.times - 1);

  FitSummary summary;
  summary.parameters = network.parameters().size();
  const int window = (options.steps + 99) / 100;
  double window_loss = 0;
  const auto start = Clock::now();
  for (int step = 0; step < options.steps; ++step) {
    double done = double(step) / options.steps;
    if (options.seconds > 0) {
      const double elapsed = std::chrono::duration<double>(Clock::now() - start).count();
      if (elapsed >= options.seconds) {
        summary.stopped = FitStop::seconds;
        break;
      }
      done = std::max(done, elapsed / options.seconds);
    }
    for (auto& tile : tiles)
      for (auto& pair : tile.pairs) pair = {any_point(random), any_time(random)};
    const float weight = 1 / float(3 * options.batch);
    parallel_for(static_cast<int>(tiles.size()), options.threads,
                 [&](int k) { tiles[static_cast<std::size_t>(k)].run(network, set, weight); });
    gradient.setZero();
    double loss = 0;
    for (const auto& tile : tiles) {
      gradient += tile.gradient;
      loss += tile.squared_error / (3 * options.batch);
    }
    require<Error>(std::isfinite(loss), "fit: the training diverged at step ", step, "; lower the learning rate ",
                   options.learning_rate);
    optimizer.step(network.parameters(), gradient, options.learning_rate * (1 + std::cos(pi * done)) / 2);
    window_loss += loss / window;
    if (++summary.steps % window == 0) {
      summary.loss.push_back(window_loss);
      window_loss = 0;
      report(progress, "fit", done);
    }
  }
  report(progress, "fit", 1);
  summary.cpu_seconds = double(std::clock() - cpu_start) / CLOCKS_PER_SEC;
  return {NeuralSurface(options.encoding, network.cast<double>(), set.translation, set.scale), std::move(summary)};
}

}  // namespace dsns
