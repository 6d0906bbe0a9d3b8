#pragma once
/// Adam (Kingma, Ba 2015) over flat parameters, with the decoupled weight decay of Loshchilov, Hutter 2019. At step n
///   m <- beta1 m + (1 - beta1) g,   v <- beta2 v + (1 - beta2) g^2,
///   theta <- theta - rate (weight_decay theta + m / (1 - beta1^n) / (sqrt(v / (1 - beta2^n)) + epsilon))
/// with m and v starting at 0, as PyTorch's AdamW does. Its law is tested in optim/adam_test.
#include <dsns/optim/optimizer.hpp>

#include <cmath>

namespace dsns {

struct AdamOptions {
  double beta1 = 0.9;
  double beta2 = 0.99;     ///< 0.999 is usual for long trainings; ours take a few thousand steps
  double epsilon = 1e-12;  ///< errors fall to 1e-4 of the scale, and gradients with them
  double weight_decay = 0;
};

namespace detail {

/// Adam's law at one step, for any stretch of parameters.
template <class T>
struct AdamLaw {
  T beta1, beta2, epsilon, correction1, correction2;

  AdamLaw(double b1, double b2, double e, std::int64_t step)
      : beta1(T(b1)),
        beta2(T(b2)),
        epsilon(T(e)),
        correction1(T(1 / (1 - std::pow(b1, double(step))))),
        correction2(T(1 / (1 - std::pow(b2, double(step))))) {}

  /// Takes the gradient into both moments and replaces it by the direction to descend against.
  void operator()(Eigen::Ref<Eigen::ArrayX<T>> moment, Eigen::Ref<Eigen::ArrayX<T>> square,
                  Eigen::Ref<Eigen::ArrayX<T>> gradient) const {
    moment = beta1 * moment + (1 - beta1) * gradient;
    square = beta2 * square + (1 - beta2) * gradient.square();
    gradient = correction1 * moment / ((correction2 * square).sqrt() + epsilon);
  }
};

}  // namespace detail

/// The state of one optimisation of n parameters: m as "moment", v as "square".
template <class T>
class Adam {
 public:
  using Scalar = T;

  explicit Adam(Eigen::Index n, const AdamOptions& options = {})
      : options_(options), state_(detail::zero_state<T>({{"moment", n}, {"square", n}})), direction_(n) {}

  /// Moves theta one step against the gradient.
  /// throws   InvalidArgument unless both have the n entries of the state
  void step(Eigen::Ref<Eigen::VectorX<T>> theta, const Eigen::Ref<const Eigen::VectorX<T>>& gradient, double rate) {
    detail::require_matching_size("Adam", theta.size(), gradient.size(), direction_.size());
    const detail::AdamLaw<T> law(options_.beta1, options_.beta2, options_.epsilon, ++state_.steps);
    direction_ = gradient.array();
    law(state_.arrays[0].values, state_.arrays[1].values, direction_);
    theta.array() -= T(rate) * (T(options_.weight_decay) * theta.array() + direction_);
  }

  const OptimizerState<T>& state() const { return state_; }
  /// Continues from the state of an optimiser of as many parameters.
  void restore(OptimizerState<T> state) { state_ = detail::matching_state(state_, std::move(state)); }

 private:
  AdamOptions options_;
  OptimizerState<T> state_;
  Eigen::ArrayX<T> direction_;
};

static_assert(Optimizer<Adam<float>> && Optimizer<Adam<double>>);

}  // namespace dsns
