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
#include <utility>
#include <vector>

namespace dsns {

/// The defaults gave the smallest error in 15 CPU-seconds on a galloping horse; many small steps matter most.
struct FitOptions {
  SurfaceEncoding encoding = {};
  int width = 64;
  int blocks = 2;
  Activation activation = Activation::silu;

  int points = 20000;  ///< of the sphere, drawn once
  int times = 48;      ///< equidistant in [0, 1]
  int batch = 256;     ///< (point, time) pairs a step
  int steps = 12000;
  double seconds = 0;           ///< of wall time for the steps; 0: no limit. With a limit runs are not repeatable
  double learning_rate = 1e-3;  ///< at the start; falls to 0 along half a cosine
  RmsPropOptions rmsprop = {};
  std::uint64_t seed = 0;
  int threads = 1;  ///< the result does not depend on it
  /// Where points are drawn: n unit vectors, 3 x n. Empty: uniformly on the sphere.
  std::function<Mat3X(int n, std::mt19937_64& random)> sampler = {};
};

enum class FitStop { steps, seconds };

struct FitSummary {
  int steps = 0;
  Index parameters = 0;
  double cpu_seconds = 0;    ///< of the whole process
  std::vector<double> loss;  ///< mean squared coordinate error of the batches, in scale^2, over stretches of steps
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
  if constexpr (requires {
                  { target.positions(target.locate(s), 0.0) } -> std::same_as<Mat3X>;
                }) {
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
        time(options.encoding.time_features(), options.times),
        targets(3, Index(options.points) * options.times) {
    const Mat3X s =
        options.sampler ? options.sampler(options.points, random) : uniform_sphere_points(options.points, random);
    require(s.cols() == options.points && ((s.colwise().norm().array() - 1).abs() < 1e-9).all(),
            "fit: the sampler gave ", s.cols(), " points for ", options.points, ", or not unit vectors");
    for (Index i = 0; i < s.cols(); ++i) space.col(i) = options.encoding.space(Vec3d(s.col(i))).template cast<float>();
    for (Index k = 0; k < time.cols(); ++k)
      time.col(k) = options.encoding.time(double(k) / double(options.times - 1)).template cast<float>();
    Mat3X all(3, targets.cols());
    visit_positions(target, s, options.times,
                    [&](int k, const Mat3X& p) { all.middleCols(k * s.cols(), s.cols()) = p; });
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

/// The network in training.
class Trainer {
 public:
  Trainer(const TrainingSet& set, const FitOptions& options, std::mt19937_64& random)
      : set_(set),
        random_(random),
        threads_(options.threads),
        network_({static_cast<int>(options.encoding.features()), options.width, options.blocks, 3, options.activation},
                 random()),
        optimizer_(network_.parameters().size(), options.rmsprop),
        tiles_(static_cast<std::size_t>(options.batch / TrainingTile::columns)),
        gradient_(network_.parameters().size()) {
    for (TrainingTile& tile : tiles_) tile.gradient.resize(gradient_.size());
  }

  const Mlp<float>& network() const { return network_; }

  /// One step; returns the mean squared coordinate error of its batch.
  double step(double rate) {
    std::uniform_int_distribution<Index> point(0, set_.space.cols() - 1), time(0, set_.time.cols() - 1);
    for (TrainingTile& tile : tiles_)
      for (auto& pair : tile.pairs) pair = {point(random_), time(random_)};
    const Index coordinates = 3 * TrainingTile::columns * static_cast<Index>(tiles_.size());
    parallel_for(static_cast<int>(tiles_.size()), threads_, [&](int k) {
      tiles_[static_cast<std::size_t>(k)].run(network_, set_, 1 / static_cast<float>(coordinates));
    });
    gradient_.setZero();
    double squared_error = 0;
    for (const TrainingTile& tile : tiles_) {
      gradient_ += tile.gradient;
      squared_error += tile.squared_error;
    }
    optimizer_.step(network_.parameters(), gradient_, rate);
    return squared_error / double(coordinates);
  }

 private:
  const TrainingSet& set_;
  std::mt19937_64& random_;
  int threads_;
  Mlp<float> network_;
  RmsProp<float> optimizer_;
  std::vector<TrainingTile> tiles_;
  Eigen::VectorXf gradient_;
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
/// accuracy mean squared coordinate error below 1e-5 scale^2 on a moving ellipsoid in a second [nn/fit_test]
/// throws   InvalidArgument for unusable options, Error where the training diverges
template <AnimatedSurface F>
FitResult fit_neural_surface(const F& target, const FitOptions& options = {}, const Progress& progress = {}) {
  using Clock = std::chrono::steady_clock;
  detail::check_fit_options(options);
  const std::clock_t cpu_start = std::clock();
  std::mt19937_64 random(options.seed);
  const detail::TrainingSet set(target, options, random);
  detail::Trainer trainer(set, options, random);

  FitSummary summary;
  summary.parameters = trainer.network().parameters().size();
  const int window = std::clamp(options.steps / 100, 1, 500);
  double window_loss = 0;
  const auto start = Clock::now();
  for (int step = 0; step < options.steps; ++step) {
    double done = double(step) / options.steps;
    if (options.seconds > 0) {
      const double spent = std::chrono::duration<double>(Clock::now() - start).count() / options.seconds;
      if (spent >= 1) {
        summary.stopped = FitStop::seconds;
        break;
      }
      done = std::max(done, spent);
    }
    const double loss = trainer.step(options.learning_rate * (1 + std::cos(pi * done)) / 2);
    require<Error>(std::isfinite(loss), "fit: the training diverged at step ", step, "; lower the learning rate ",
                   options.learning_rate);
    window_loss += loss / window;
    if (++summary.steps % window == 0) {
      summary.loss.push_back(std::exchange(window_loss, 0));
      report(progress, "fit", done);
    }
  }
  report(progress, "fit", 1);
  summary.cpu_seconds = double(std::clock() - cpu_start) / CLOCKS_PER_SEC;
  return {NeuralSurface(options.encoding, trainer.network().cast<double>(), set.translation, set.scale),
          std::move(summary)};
}

}  // namespace dsns
