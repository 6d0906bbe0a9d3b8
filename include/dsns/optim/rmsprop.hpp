#pragma once
/// RMSProp with momentum over flat parameters, as PyTorch defines it and the D-SNS paper uses it:
///   v <- decay v + (1 - decay) g^2,   b <- momentum b + g / (sqrt(v) + epsilon),   theta <- theta - rate b
/// with v and b starting at 0 and no bias correction. Its law is tested in optim/rmsprop_test.
#include <dsns/core/errors.hpp>

#include <Eigen/Core>

namespace dsns {

struct RmsPropOptions {
  double decay = 0.99;
  double momentum = 0.9;
  double epsilon = 1e-8;
};

/// The state of one optimisation of n parameters.
template <class T>
class RmsProp {
 public:
  explicit RmsProp(Eigen::Index n, const RmsPropOptions& options = {})
      : options_(options), square_(Eigen::ArrayX<T>::Zero(n)), step_(Eigen::ArrayX<T>::Zero(n)) {}

  /// Moves theta one step against the gradient.
  /// throws   InvalidArgument unless both have the n entries of the state
  void step(Eigen::Ref<Eigen::VectorX<T>> theta, const Eigen::Ref<const Eigen::VectorX<T>>& gradient, double rate) {
    require(theta.size() == square_.size() && gradient.size() == square_.size(), "RmsProp::step: ", theta.size(),
            " parameters and ", gradient.size(), " derivatives for a state of ", square_.size());
    const T decay = T(options_.decay);
    square_ = decay * square_ + (1 - decay) * gradient.array().square();
    step_ = T(options_.momentum) * step_ + gradient.array() / (square_.sqrt() + T(options_.epsilon));
    theta.array() -= T(rate) * step_;
  }

 private:
  RmsPropOptions options_;
  Eigen::ArrayX<T> square_, step_;
};

}  // namespace dsns
