#pragma once
/// The optimiser chosen at run time.
#include <dsns/optim/adam.hpp>
#include <dsns/optim/rmsprop.hpp>
#include <dsns/optim/soap.hpp>

#include <utility>
#include <variant>
#include <vector>

namespace dsns {

enum class OptimizerKind { rmsprop, adam, soap };

struct OptimizerOptions {
  OptimizerKind kind = OptimizerKind::soap;
  RmsPropOptions rmsprop = {};
  AdamOptions adam = {};
  SoapOptions soap = {};
};

/// Owns one optimiser of any kind.
template <class T>
class AnyOptimizer {
 public:
  using Scalar = T;

  /// blocks   the matrices and vectors that the parameters consist of, in order
  explicit AnyOptimizer(const std::vector<ParameterBlock>& blocks, const OptimizerOptions& options = {})
      : optimizer_(make(blocks, options)) {}

  void step(Eigen::Ref<Eigen::VectorX<T>> theta, const Eigen::Ref<const Eigen::VectorX<T>>& gradient, double rate) {
    std::visit([&](auto& o) { o.step(theta, gradient, rate); }, optimizer_);
  }
  const OptimizerState<T>& state() const {
    return std::visit([](const auto& o) -> const OptimizerState<T>& { return o.state(); }, optimizer_);
  }
  void restore(OptimizerState<T> state) {
    std::visit([&](auto& o) { o.restore(std::move(state)); }, optimizer_);
  }

 private:
  using Variant = std::variant<RmsProp<T>, Adam<T>, Soap<T>>;

  static Variant make(const std::vector<ParameterBlock>& blocks, const OptimizerOptions& options) {
    Index n = 0;
    for (const ParameterBlock& b : blocks) n += b.rows * b.cols;
    switch (options.kind) {
      case OptimizerKind::rmsprop:
        return RmsProp<T>(n, options.rmsprop);
      case OptimizerKind::adam:
        return Adam<T>(n, options.adam);
      case OptimizerKind::soap:
        break;
    }
    return Soap<T>(blocks, options.soap);
  }

  Variant optimizer_;
};

static_assert(Optimizer<AnyOptimizer<float>> && Optimizer<AnyOptimizer<double>>);

}  // namespace dsns
