#pragma once
/// Trains a network on samples in batches: a batch is recorded on matrix tapes tile by tile, the tiles' gradients are
/// summed, the optimiser steps. What is learnt is the problem's: a TrainingProblem says what the inputs of a sample are and
/// what its loss.
#include <dsns/core/parallel.hpp>
#include <dsns/nn/mlp.hpp>
#include <dsns/optim/any_optimizer.hpp>
#include <dsns/optim/schedule.hpp>

#include <algorithm>
#include <atomic>
#include <concepts>
#include <cstdint>
#include <numeric>
#include <random>
#include <span>
#include <utility>
#include <vector>

namespace dsns {

/// The loss of a tile, a 1 x 1 node, and the sum over its samples of the error that is reported.
template <class T>
struct TileLoss {
  typename MatrixTape<T>::Node node;
  double error = 0;
};

/// Samples are numbered from 0. `fill` writes the network's inputs for the n samples of a tile, inputs x (n blocks) in the
/// problem's layout; `loss` records the sum of the samples' losses for the network's outputs. Both are called from several
/// threads at a time.
template <class P, class T>
concept TrainingProblem = requires(const P& problem, std::span<const Index> samples, Eigen::MatrixX<T>& inputs,
                                   MatrixTape<T>& tape, typename MatrixTape<T>::Node outputs) {
  { P::layout } -> std::same_as<const JetLayout&>;
  { problem.samples() } -> std::same_as<Index>;
  { problem.fill(samples, inputs) } -> std::same_as<void>;
  { problem.loss(tape, outputs, samples) } -> std::same_as<TileLoss<T>>;
};

struct TrainerOptions {
  int batch = 4096;      ///< samples a step, at most all of them
  int threads = 1;       ///< the result does not depend on it
  double clip_norm = 0;  ///< longest gradient; 0: no limit
  OptimizerOptions optimizer = {};
  std::uint64_t seed = 0;  ///< of the order in which samples are taken
};

/// A network in training. The problem must outlive it. Memory: what a tile takes, a few times, whatever the batch.
template <class T, TrainingProblem<T> Problem>
class Trainer {
 public:
  Trainer(const Problem& problem, Mlp<T> network, const TrainerOptions& options)
      : problem_(&problem),
        options_(options),
        network_(std::move(network)),
        optimizer_(network_.shape().blocks_of_parameters(), on_threads(options.optimizer, options.threads)),
        gradient_(network_.parameters().size()),
        order_(std::size_t(problem.samples())) {
    require(options.batch > 0 && options.threads > 0 && options.clip_norm >= 0 && problem.samples() > 0,
            "Trainer: a batch of ", options.batch, " of ", problem.samples(), " samples, ", options.threads,
            " threads, gradients up to ", options.clip_norm, "; give at least 1, 1, 1 and 0");
    batch_ = std::min<Index>(options.batch, problem.samples());
    tile_ = std::max<Index>(32, (batch_ < 2048 ? 128 : 256) / Problem::layout.blocks());
    const Index tiles = (batch_ + tile_ - 1) / tile_;
    // Groups of tiles are summed one after the other and then together, so that the sum does not depend on the threads.
    const Index groups = std::min<Index>(tiles, gradient_.size() > 1000000 ? 2 : 8);
    groups_ = std::vector<Group>(std::size_t(groups));
    for (Group& group : groups_) group.gradient.resize(gradient_.size());
    tapes_ = std::vector<MatrixTape<T>>(std::size_t(std::min<Index>(options.threads, groups)));
  }

  const Mlp<T>& network() const { return network_; }
  std::int64_t steps() const { return steps_; }
  const OptimizerState<T>& optimizer_state() const { return optimizer_.state(); }

  /// Continues where a trainer of the same problem and options stood: what follows is the same to the last bit.
  void restore(Eigen::VectorX<T> parameters, OptimizerState<T> state, std::int64_t steps) {
    require(parameters.size() == gradient_.size() && steps >= 0, "Trainer::restore: ", parameters.size(),
            " parameters after ", steps, " steps for a network of ", gradient_.size());
    network_.parameters() = std::move(parameters);
    optimizer_.restore(std::move(state));
    steps_ = steps;
    epoch_ = -1;
  }

  /// One step at a learning rate.
  /// returns  the mean reported error of the batch's samples
  double step(double rate) {
    choose_batch();
    const Index tiles = (batch_ + tile_ - 1) / tile_, groups = Index(groups_.size());
    std::atomic<Index> next{0};
    parallel_for(int(tapes_.size()), options_.threads, [&](int worker) {
      for (Index g = next++; g < groups; g = next++) {
        Group& group = groups_[std::size_t(g)];
        group.gradient.setZero();
        group.error = 0;
        for (Index tile = g * tiles / groups; tile < (g + 1) * tiles / groups; ++tile)
          run(tapes_[std::size_t(worker)], group, tile);
      }
    });
    gradient_ = groups_[0].gradient;
    double error = groups_[0].error;
    for (std::size_t g = 1; g < groups_.size(); ++g) {
      gradient_ += groups_[g].gradient;
      error += groups_[g].error;
    }
    if (options_.clip_norm > 0) clip_norm<T>(gradient_, options_.clip_norm);
    optimizer_.step(network_.parameters(), gradient_, rate);
    ++steps_;
    return error / double(batch_);
  }

 private:
  struct Group {
    Eigen::VectorX<T> gradient;
    double error = 0;
  };

  static OptimizerOptions on_threads(OptimizerOptions options, int threads) {
    options.soap.threads = std::max(1, threads);
    return options;
  }

  /// Each epoch is a random order of all samples, of which the last incomplete batch is left out. It follows from the seed
  /// and the epoch's number alone, so that a training can go on from the number of its steps.
  void choose_batch() {
    const std::int64_t batches = std::max<std::int64_t>(1, problem_->samples() / batch_);
    if (steps_ / batches != epoch_) {
      epoch_ = steps_ / batches;
      std::seed_seq seed{std::uint32_t(options_.seed), std::uint32_t(options_.seed >> 32), std::uint32_t(epoch_)};
      std::mt19937 random(seed);
      std::iota(order_.begin(), order_.end(), Index(0));
      for (std::size_t k = order_.size(); k > 1; --k)
        std::swap(order_[k - 1], order_[std::size_t((std::uint64_t(random()) * k) >> 32)]);
    }
    first_ = Index(steps_ % batches) * batch_;
  }

  void run(MatrixTape<T>& tape, Group& group, Index tile) {
    const Index begin = tile * tile_, n = std::min(tile_, batch_ - begin);
    const std::span<const Index> samples(order_.data() + first_ + begin, std::size_t(n));
    tape.clear();
    const auto x = tape.constant(network_.shape().inputs, n * Problem::layout.blocks(),
                                 [&](Eigen::MatrixX<T>& m) { problem_->fill(samples, m); });
    const auto y = network_.template record<Problem::layout>(tape, x, group.gradient);
    const TileLoss<T> loss = problem_->loss(tape, y, samples);
    group.error += loss.error;
    tape.backward(loss.node, T(1 / double(batch_)));
  }

  const Problem* problem_;
  TrainerOptions options_;
  Mlp<T> network_;
  AnyOptimizer<T> optimizer_;
  Eigen::VectorX<T> gradient_;
  std::vector<Index> order_;
  std::vector<Group> groups_;
  std::vector<MatrixTape<T>> tapes_;  // one a thread, so that its memory stays in that processor's cache
  Index batch_ = 0, tile_ = 0, first_ = 0;
  std::int64_t steps_ = 0, epoch_ = -1;
};

}  // namespace dsns
