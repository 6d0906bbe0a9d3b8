#pragma once
/// What every optimiser of flat parameters has in common. An optimiser is its options and its state; the state is one
/// plain value, so that a training can be written to a file and continued as if it had never stopped:
///
///   const OptimizerState<float> saved = adam.state();
///   Adam<float> other(n, options);
///   other.restore(saved);                            // other.step(...) now moves exactly as adam.step(...)
#include <dsns/core/errors.hpp>
#include <dsns/core/types.hpp>

#include <concepts>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace dsns {

/// Named flat arrays and the number of steps taken. Names and sizes are fixed by the optimiser's construction.
template <class T>
struct OptimizerState {
  struct Array {
    std::string name;
    Eigen::ArrayX<T> values;
  };

  std::int64_t steps = 0;
  std::vector<Array> arrays;
};

/// A stretch of flat parameters that is a matrix, column after column; with one column it is a vector.
struct ParameterBlock {
  Index offset = 0;
  Index rows = 1;
  Index cols = 1;
};

/// Moves flat parameters against a gradient. The rate is given with each step, by a Schedule for instance.
template <class O>
concept Optimizer = std::floating_point<typename O::Scalar> &&
    requires(O& optimizer, const O& constant, Eigen::VectorX<typename O::Scalar>& theta,
             const Eigen::VectorX<typename O::Scalar>& gradient, double rate,
             OptimizerState<typename O::Scalar> state) {
  { optimizer.step(theta, gradient, rate) } -> std::same_as<void>;
  { constant.state() } -> std::same_as<const OptimizerState<typename O::Scalar>&>;
  { optimizer.restore(std::move(state)) } -> std::same_as<void>;
};

namespace detail {

template <class T>
OptimizerState<T> zero_state(std::vector<std::pair<std::string, Eigen::Index>> arrays) {
  OptimizerState<T> state;
  for (auto& [name, size] : arrays) state.arrays.push_back({std::move(name), Eigen::ArrayX<T>::Zero(size)});
  return state;
}

/// `saved` where it has the arrays of `own`.
/// throws   InvalidArgument where it is the state of another optimiser or of other parameters
template <class T>
OptimizerState<T> matching_state(const OptimizerState<T>& own, OptimizerState<T> saved) {
  require(saved.steps >= 0 && saved.arrays.size() == own.arrays.size(), "restore: ", saved.steps, " steps and ",
          saved.arrays.size(), " arrays for an optimiser of ", own.arrays.size());
  for (std::size_t k = 0; k < own.arrays.size(); ++k)
    require(saved.arrays[k].name == own.arrays[k].name && saved.arrays[k].values.size() == own.arrays[k].values.size(),
            "restore: array ", saved.arrays[k].name, " of ", saved.arrays[k].values.size(), " where the optimiser has ",
            own.arrays[k].name, " of ", own.arrays[k].values.size());
  return saved;
}

inline void require_matching_size(const char* name, Eigen::Index parameters, Eigen::Index derivatives,
                                  Eigen::Index state) {
  require(parameters == state && derivatives == state, name, "::step: ", parameters, " parameters and ", derivatives,
          " derivatives for a state of ", state);
}

}  // namespace detail
}  // namespace dsns
