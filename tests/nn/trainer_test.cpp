#include "catch.hpp"
#include "support/matrices.hpp"

#include <dsns/nn/trainer.hpp>

#include <set>

namespace trainer_test {

using namespace dsns;

namespace {

/// y = sin(3 x): 500 samples of one number.
struct Sine {
  static constexpr JetLayout layout = jet_layouts::value;
  Eigen::RowVectorXd x = Eigen::RowVectorXd::LinSpaced(500, -1, 1);

  Index samples() const { return x.size(); }
  void fill(std::span<const Index> chosen, Eigen::MatrixXd& inputs) const {
    for (std::size_t j = 0; j < chosen.size(); ++j) inputs(0, Index(j)) = x[chosen[j]];
  }
  TileLoss<double> loss(MatrixTape<double>& tape, MatrixTape<double>::Node y, std::span<const Index> chosen) const {
    Eigen::MatrixXd target(1, Index(chosen.size()));
    for (std::size_t j = 0; j < chosen.size(); ++j) target(0, Index(j)) = std::sin(3 * x[chosen[j]]);
    const auto node = tape.squared_error(y, target);
    return {node, tape.value(node)(0, 0)};
  }
};

const MlpShape shape{1, 16, 1, 1, Activation::tanh};

Trainer<double, Sine> trainer(const Sine& problem, const TrainerOptions& options) {
  return {problem, Mlp<double>(shape, 3), options};
}

}  // namespace

TEST_CASE("trainer: a curve is learnt with every optimiser", "[nn]") {
  const auto kind = GENERATE(OptimizerKind::rmsprop, OptimizerKind::adam, OptimizerKind::soap);
  TrainerOptions options;
  options.batch = 100;
  options.optimizer.kind = kind;
  const Sine problem;
  auto training = trainer(problem, options);
  const double before = training.step(1e-3);
  double after = 0;
  for (int k = 0; k < 1500; ++k) after = training.step(3e-3 * (1 - k / 1500.0));
  CHECK(before > 0.1);
  CHECK(after < 1e-3);
  CHECK(training.steps() == 1501);
}

TEST_CASE("trainer: a gradient is that of the mean over the batch, whatever the tiles", "[nn]") {
  // Adam's first moment after a step is (1 - beta1) times the gradient.
  TrainerOptions options;
  options.batch = 500;  // all samples: several tiles, the last one incomplete
  options.optimizer.kind = OptimizerKind::adam;
  const Sine problem;
  auto training = trainer(problem, options);
  const Mlp<double> start = training.network();
  training.step(1e-3);
  const auto& moment = training.optimizer_state().arrays[0].values;

  std::vector<Index> all(500);
  for (std::size_t k = 0; k < all.size(); ++k) all[k] = Index(k);
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(start.parameters().size());
  MatrixTape<double> tape;
  Eigen::MatrixXd inputs(1, 500);
  problem.fill(all, inputs);
  const auto y = start.record(tape, tape.constant(inputs), gradient);
  tape.backward(problem.loss(tape, y, all).node, 1 / 500.0);
  CHECK((moment.matrix() - (1 - AdamOptions{}.beta1) * gradient).norm() < 1e-14 * gradient.norm());
}

TEST_CASE("trainer: the order of a batch's samples changes its gradient by rounding alone", "[nn]") {
  TrainerOptions options;
  options.batch = 500;  // all samples, in an order that follows from the seed
  options.optimizer.kind = OptimizerKind::adam;
  const Sine problem;
  const auto gradient = [&](std::uint64_t seed) {
    options.seed = seed;
    auto training = trainer(problem, options);
    training.step(1e-3);
    return Eigen::VectorXd(training.optimizer_state().arrays[0].values.matrix());
  };
  const Eigen::VectorXd one = gradient(1), other = gradient(2);
  CHECK(one != other);
  CHECK((one - other).norm() < 1e-14 * one.norm());
}

TEST_CASE("trainer: memory is that of a tile, whatever the batch", "[nn]") {
  struct Weighed : Sine {
    mutable std::size_t most = 0;
    Weighed() { x = Eigen::RowVectorXd::LinSpaced(40000, -1, 1); }
    TileLoss<double> loss(MatrixTape<double>& tape, MatrixTape<double>::Node y, std::span<const Index> chosen) const {
      const auto tile = Sine::loss(tape, y, chosen);
      most = std::max(most, tape.bytes());
      return tile;
    }
  };
  const auto most = [](int batch) {
    const Weighed problem;
    TrainerOptions options;
    options.batch = batch;
    Trainer<double, Weighed> training(problem, Mlp<double>(shape, 3), options);
    training.step(1e-3);
    training.step(1e-3);
    return problem.most;
  };
  CHECK(most(4000) == most(40000));
  CHECK(most(4000) < 16 * std::size_t(shape.width) * 256 * sizeof(double));
}

TEST_CASE("trainer: threads do not change a bit, and every sample is taken once an epoch", "[nn]") {
  struct Counting : Sine {
    mutable std::multiset<Index> taken;
    void fill(std::span<const Index> chosen, Eigen::MatrixXd& inputs) const {
      Sine::fill(chosen, inputs);
      taken.insert(chosen.begin(), chosen.end());
    }
  };
  TrainerOptions options;
  options.batch = 125;
  const Counting counting;
  Trainer<double, Counting> once(counting, Mlp<double>(shape, 3), options);
  for (int k = 0; k < 4; ++k) once.step(1e-3);
  CHECK(counting.taken.size() == 500);
  CHECK(std::set<Index>(counting.taken.begin(), counting.taken.end()).size() == 500);

  options.batch = 500;
  const Sine problem;
  const auto parameters = [&](int threads) {
    options.threads = threads;
    auto training = trainer(problem, options);
    for (int k = 0; k < 10; ++k) training.step(1e-3);
    return training.network().parameters();
  };
  const Eigen::VectorXd one = parameters(1);
  CHECK(parameters(2) == one);
  CHECK(parameters(5) == one);
}

TEST_CASE("trainer: a restored training goes on as if it had never stopped", "[nn]") {
  TrainerOptions options;
  options.batch = 90;
  options.seed = 8;
  options.optimizer.kind = GENERATE(OptimizerKind::rmsprop, OptimizerKind::adam, OptimizerKind::soap);
  const Sine problem;
  auto whole = trainer(problem, options), first = trainer(problem, options);
  for (int k = 0; k < 23; ++k) whole.step(1e-3);
  for (int k = 0; k < 12; ++k) first.step(1e-3);
  auto second = trainer(problem, options);
  second.restore(first.network().parameters(), first.optimizer_state(), first.steps());
  for (int k = 0; k < 11; ++k) second.step(1e-3);
  CHECK(second.network().parameters() == whole.network().parameters());
  CHECK_THROWS_AS(second.restore(Eigen::VectorXd::Zero(3), first.optimizer_state(), 1), InvalidArgument);
}

TEST_CASE("trainer: long gradients are clipped", "[nn]") {
  TrainerOptions options;
  options.batch = 500;
  options.optimizer.kind = OptimizerKind::adam;
  options.clip_norm = 1e-3;
  const Sine problem;
  auto training = trainer(problem, options);
  training.step(1e-3);
  CHECK(training.optimizer_state().arrays[0].values.matrix().norm() == Approx((1 - AdamOptions{}.beta1) * 1e-3));
}

}  // namespace trainer_test
