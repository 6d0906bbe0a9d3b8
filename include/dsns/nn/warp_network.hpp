#pragma once
/// A warp of time as the D-SNS paper has it: a small network of time with a sigmoid, trained from the identity to bring one
/// field over time to another, with a penalty where it runs backwards. It is what registration in time is compared with;
/// its ends are not fixed, and nothing but the penalty keeps it increasing.
///
///   const WarpFit fit = fit_warp_network([&](double t) { return q1(t); },
///                                        [&](double t) { return FieldOfTime{q2(t), dq2(t)}; });
///   fit.warp(0.5); fit.warp.slope(0.5);
#include <dsns/nn/trainer.hpp>

namespace dsns {

/// A field at a time, K values, and its derivative by time. Any type with these two members will do.
struct FieldOfTime {
  Eigen::VectorXd value, rate;
};

template <class F>
concept MovingField = requires(const F& f, double t) {
  { f(t).value } -> std::convertible_to<Eigen::VectorXd>;
  { f(t).rate } -> std::convertible_to<Eigen::VectorXd>;
};

struct WarpNetworkOptions {
  int width = 32;
  int blocks = 2;
  int identity_steps = 1500;  ///< towards t itself, first
  int steps = 2500;           ///< towards the field
  int times = 200;            ///< of a step, random
  int keep_times = 200;       ///< steps until others are drawn
  double penalty = 100;       ///< times the square of a negative slope
  double learning_rate = 3e-4;
  RmsPropOptions rmsprop = {};
  std::uint64_t seed = 0;
};

/// zeta(t) = 1 / (1 + e^-N(t)).
class WarpNetwork {
 public:
  explicit WarpNetwork(Mlp<double> network) : network_(std::move(network)) {
    require(network_.shape().inputs == 1 && network_.shape().outputs == 1, "WarpNetwork: a network of ",
            network_.shape().inputs, " inputs and ", network_.shape().outputs, " outputs, give one of each");
  }

  const Mlp<double>& network() const { return network_; }
  double operator()(double t) const { return at(t).first; }
  double slope(double t) const { return at(t).second; }

 private:
  std::pair<double, double> at(double t) const {
    const Eigen::MatrixXd y = network_.columns(Eigen::RowVector2d(t, 1), jet_layouts::rate);
    const double z = 1 / (1 + std::exp(-y(0, 0)));
    return {z, z * (1 - z) * y(0, 1)};
  }

  Mlp<double> network_;
};

struct WarpFit {
  WarpNetwork warp;
  double identity_error = 0;  ///< mean square of zeta(t) - t where training for the field began
  double error = 0;           ///< of the last step: mean of |q1 - sqrt(zeta') q2(zeta)|^2 over that of |q1|^2
};

namespace detail {

/// What a loss says of z = zeta(t) and its slope.
struct WarpLoss {
  double loss = 0, error = 0;
  double by_value = 0, by_slope = 0;
};

/// Samples are times; loss(t, z, slope) is what the network is trained by.
template <class Loss>
class WarpProblem {
 public:
  static constexpr JetLayout layout = jet_layouts::rate;

  WarpProblem(Loss loss, int times) : loss_(std::move(loss)), times_(times) {}

  void draw(std::mt19937_64& random) {
    std::uniform_real_distribution<double> uniform(0, 1);
    for (double& t : times_) t = uniform(random);
  }

  Index samples() const { return times_.size(); }
  void fill(std::span<const Index> samples, Eigen::MatrixXd& inputs) const {
    const Index n = Index(samples.size());
    for (Index j = 0; j < n; ++j) {
      inputs(0, j) = times_[samples[std::size_t(j)]];
      inputs(0, n + j) = 1;
    }
  }
  TileLoss<double> loss(MatrixTape<double>& tape, MatrixTape<double>::Node outputs,
                        std::span<const Index> samples) const {
    using Tape = MatrixTape<double>;
    const auto y = tape.value(outputs);
    auto& o = tape.operation(1, 1, {outputs}, [](Tape& t, const Tape::Operation& total) {
      t.accumulate(total.operands[0], total.adjoint(0, 0) * total.kept[0]);
    });
    const Index n = Index(samples.size());
    o.kept[0].resize(1, 2 * n);
    double sum = 0, error = 0;
    for (Index j = 0; j < n; ++j) {
      const double z = 1 / (1 + std::exp(-y(0, j))), s = z * (1 - z), rate = y(0, n + j);
      const WarpLoss l = loss_(times_[samples[std::size_t(j)]], z, s * rate);
      sum += l.loss;
      error += l.error;
      o.kept[0](0, j) = s * (l.by_value + l.by_slope * (1 - 2 * z) * rate);
      o.kept[0](0, n + j) = s * l.by_slope;
    }
    o.value(0, 0) = sum;
    return {tape.last(), error};
  }

 private:
  Loss loss_;
  Eigen::VectorXd times_;
};

/// |q1 - sqrt(slope) q2(z)|^2 / norm + penalty min(slope, 0)^2.
template <class Target, class Moving>
auto elastic_warp_loss(const Target& target, const Moving& moving, double norm, double penalty) {
  return [&target, &moving, norm, penalty](double t, double z, double slope) {
    constexpr double least = 1e-6;  // below it the root no longer counts, only the penalty
    const auto field = moving(z);
    const double root = std::sqrt(std::max(slope, least));
    const Eigen::VectorXd miss = target(t) - root * field.value;
    WarpLoss l;
    l.error = miss.squaredNorm() / norm;
    l.loss = l.error + penalty * std::pow(std::min(slope, 0.0), 2);
    l.by_value = -2 * root / norm * miss.dot(field.rate);
    if (slope > least) l.by_slope = -miss.dot(field.value) / (root * norm);
    l.by_slope += 2 * penalty * std::min(slope, 0.0);
    return l;
  };
}

/// Trains from the parameters given.
/// returns  the network and the error of the last step
template <class Loss>
std::pair<Mlp<double>, double> train_warp(const Loss& loss, Mlp<double> network, int steps, std::mt19937_64& random,
                                          const WarpNetworkOptions& options) {
  WarpProblem<Loss> problem(loss, options.times);
  TrainerOptions trainer_options;
  trainer_options.batch = options.times;
  trainer_options.optimizer.kind = OptimizerKind::rmsprop;
  trainer_options.optimizer.rmsprop = options.rmsprop;
  Trainer<double, WarpProblem<Loss>> trainer(problem, std::move(network), trainer_options);
  double error = 0;
  for (int k = 0; k < steps; ++k) {
    if (k % options.keep_times == 0) problem.draw(random);
    error = trainer.step(options.learning_rate);
  }
  return {trainer.network(), error};
}

}  // namespace detail

/// Trains zeta so that sqrt(zeta') moving(zeta(t)) is near target(t).
/// target   t -> K values
/// accuracy its derivatives are those of differences to 1e-6 [nn/warp_network_test]
/// throws   InvalidArgument where the target is zero everywhere, or for unusable options
template <class Target, MovingField Moving>
WarpFit fit_warp_network(const Target& target, const Moving& moving, const WarpNetworkOptions& options = {}) {
  require(options.steps >= 0 && options.identity_steps >= 0 && options.times > 0 && options.keep_times > 0 &&
              options.penalty >= 0,
          "fit_warp_network: ", options.identity_steps, " and ", options.steps, " steps of ", options.times,
          " times kept for ", options.keep_times, ", a penalty of ", options.penalty);
  constexpr int grid = 400;
  double norm = 0;
  for (int k = 0; k < grid; ++k) norm += Eigen::VectorXd(target((k + 0.5) / grid)).squaredNorm() / grid;
  require(norm > 0, "fit_warp_network: the target is zero at all times, there is nothing to bring to it");
  std::mt19937_64 random(options.seed);
  const auto towards_identity = [](double t, double z, double) {
    return detail::WarpLoss{(z - t) * (z - t), (z - t) * (z - t), 2 * (z - t), 0};
  };
  Mlp<double> network(MlpShape{1, options.width, options.blocks, 1, Activation::softplus}, options.seed);
  auto [start, identity_error] =
      detail::train_warp(towards_identity, std::move(network), options.identity_steps, random, options);
  auto [trained, error] = detail::train_warp(detail::elastic_warp_loss(target, moving, norm, options.penalty),
                                             std::move(start), options.steps, random, options);
  return {WarpNetwork(std::move(trained)), identity_error, error};
}

}  // namespace dsns
