#pragma once
/// RMSProp with momentum over flat parameters, as PyTorch defines it and the D-SNS paper uses it:
///   v <- decay v + (1 - decay) g^2,   b <- momentum b + g / (sqrt(v) + epsilon),   theta <- theta - rate b
/// with v and b starting at 0 and no bias correction. Its law is tested in optim/rmsprop_test.
#include <dsns/optim/optimizer.hpp>

namespace dsns {

struct RmsPropOptions {
  double decay = 0.99;
  double momentum = 0.9;
  double epsilon = 1e-8;
};

/// The state of one optimisation of n parameters: v as "square", b as "step".
template <class T>
class RmsProp {
 public:
  using Scalar = T;

  explicit RmsProp(Eigen::Index n, const RmsPropOptions& options = {})
      : options_(options), state_(detail::zero_state<T>({{"square", n}, {"step", n}})) {}

  /// Moves theta one step against the gradient.
  /// throws   InvalidArgument unless both have the n entries of the state
  void step(Eigen::Ref<Eigen::VectorX<T>> theta, const Eigen::Ref<const Eigen::VectorX<T>>& gradient, double rate) {
    auto& square = state_.arrays[0].values;
    auto& step = state_.arrays[1].values;
    detail::require_matching_size("RmsProp", theta.size(), gradient.size(), square.size());
    ++state_.steps;
    const T decay = T(options_.decay);
    square = decay * square + (1 - decay) * gradient.array().square();
    step = T(options_.momentum) * step + gradient.array() / (square.sqrt() + T(options_.epsilon));
    theta.array() -= T(rate) * step;
  }

  const OptimizerState<T>& state() const { return state_; }
  /// Continues from the state of an optimiser of as many parameters.
  void restore(OptimizerState<T> state) { state_ = detail::matching_state(state_, std::move(state)); }

 private:
  RmsPropOptions options_;
  OptimizerState<T> state_;
};

static_assert(Optimizer<RmsProp<float>> && Optimizer<RmsProp<double>>);

}  // namespace dsns
