#include "step.hpp"

#ifdef DSNS_WITH_TORCH
#include <ATen/Parallel.h>
#include <dlfcn.h>
#include <torch/torch.h>

#include <memory>
#include <vector>
#endif

namespace training_step {

#ifdef DSNS_WITH_TORCH

namespace {

/// The rows of the result are the columns of m.
torch::Tensor columns(const float* m, std::int64_t rows, std::int64_t cols) {
  return torch::from_blob(const_cast<float*>(m), {cols, rows}, torch::kFloat32).clone();
}

struct Training {
  dsns::MlpShape shape;
  torch::Tensor inputs, targets;
  std::vector<torch::Tensor> weights, biases;
  std::unique_ptr<torch::optim::RMSprop> optimizer;

  explicit Training(const Workload& w)
      : shape(w.shape),
        inputs(columns(w.inputs.data(), w.inputs.rows(), w.inputs.cols())),
        targets(columns(w.targets.data(), w.targets.rows(), w.targets.cols())) {
    std::vector<torch::Tensor> all;
    for (int l = 0; l < shape.layers(); ++l) {
      const float* const begin = w.parameters.data() + shape.offset(l);
      const std::int64_t rows = shape.rows(l), cols = shape.cols(l);
      weights.push_back(columns(begin, rows, cols).t().contiguous().requires_grad_(true));
      biases.push_back(columns(begin + rows * cols, rows, 1).reshape({rows}).requires_grad_(true));
      all.push_back(weights.back());
      all.push_back(biases.back());
    }
    optimizer = std::make_unique<torch::optim::RMSprop>(
        all, torch::optim::RMSpropOptions(w.rate).alpha(0.99).momentum(0.9).eps(1e-8));
  }

  torch::Tensor activated(const torch::Tensor& z) const {
    return shape.activation == dsns::Activation::silu ? torch::silu(z) : torch::nn::functional::softplus(z);
  }
  torch::Tensor affine(int layer, const torch::Tensor& x) const {
    return torch::nn::functional::linear(x, weights[std::size_t(layer)], biases[std::size_t(layer)]);
  }
  double step() {
    optimizer->zero_grad();
    torch::Tensor y = activated(affine(0, inputs));
    for (int l = 1; l + 1 < shape.layers(); l += 2) y = activated(affine(l + 1, activated(affine(l, y))) + y);
    const torch::Tensor loss = torch::mse_loss(affine(shape.layers() - 1, y), targets);
    loss.backward();
    optimizer->step();
    return loss.item<double>();
  }
};

}  // namespace

std::function<double()> libtorch_step(const Workload& workload) {
  return [training = std::make_shared<Training>(workload)] { return training->step(); };
}
void set_libtorch_threads(int threads) {
  at::set_num_threads(threads);
  // Where libtorch multiplies by OpenBLAS with threads of its own, it does not tell it.
  if (void* const set = dlsym(RTLD_DEFAULT, "openblas_set_num_threads")) reinterpret_cast<void (*)(int)>(set)(threads);
}

#else

std::function<double()> libtorch_step(const Workload&) { return {}; }
void set_libtorch_threads(int) {}

#endif

}  // namespace training_step
