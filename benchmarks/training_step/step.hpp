#pragma once
/// One batch of points and one network to train on it, and libtorch's step on them.
#include <dsns/nn/mlp.hpp>

#include <functional>

namespace training_step {

struct Workload {
  dsns::MlpShape shape;
  Eigen::VectorXf parameters;
  Eigen::MatrixXf inputs, targets;  // a column a sample
  double rate = 1e-4;
};

/// One step of RMSProp on the mean squared distance, the whole batch at once, which returns the loss before it; nothing
/// where the benchmark was built without libtorch. The workload must outlive it.
std::function<double()> libtorch_step(const Workload& workload);
void set_libtorch_threads(int threads);

}  // namespace training_step
