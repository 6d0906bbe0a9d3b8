#include "catch.hpp"

#include <dsns/optim/adam.hpp>

#include <cmath>
#include <random>

namespace adam_test {

using namespace dsns;

namespace {

AdamOptions pytorch_defaults() {
  AdamOptions o;
  o.beta2 = 0.999;
  o.epsilon = 1e-8;
  return o;
}

}  // namespace

TEST_CASE("adam: the first steps by hand", "[optim]") {
  // Gradients 2, -1, 3 with rate 0.1, carried out from the law with a calculator's precision.
  Adam<double> optimizer(1, pytorch_defaults());
  Eigen::VectorXd theta = Eigen::VectorXd::Constant(1, 1.0), g(1);
  g[0] = 2;  // m = 0.2, v = 0.004; corrected 2 and 4
  optimizer.step(theta, g, 0.1);
  CHECK(theta[0] == Approx(0.9).margin(1e-8));
  g[0] = -1;  // m = 0.18 - 0.1 = 0.08, v = 0.003996 + 0.001; corrected 0.08 / 0.19 and 0.004996 / 0.001999
  optimizer.step(theta, g, 0.1);
  CHECK(theta[0] == Approx(0.9 - 0.1 * 0.42105263 / 1.58090151).margin(1e-8));
  g[0] = 3;  // m = 0.372, v = 0.013991004; corrected 0.372 / 0.271 and 0.013991004 / 0.002997001
  optimizer.step(theta, g, 0.1);
  CHECK(theta[0] == Approx(0.87336624 - 0.1 * 1.37269373 / 2.16063294).margin(1e-7));
}

TEST_CASE("adam: a constant gradient makes steps of the rate from the first on", "[optim]") {
  Adam<double> optimizer(2);
  Eigen::VectorXd theta = Eigen::VectorXd::Zero(2);
  const Eigen::Vector2d g(1e-3, -50);  // the size of a gradient does not matter
  for (int i = 1; i <= 50; ++i) {
    optimizer.step(theta, g, 1e-2);
    CHECK(theta[0] == Approx(-1e-2 * i));
    CHECK(theta[1] == Approx(1e-2 * i));
  }
}

TEST_CASE("adam: weight decay as PyTorch's AdamW, which shrinks the parameters first", "[optim]") {
  AdamOptions options = pytorch_defaults();
  options.weight_decay = 0.3;
  const int n = 5;
  Adam<double> optimizer(n, options);
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  Eigen::VectorXd theta(n), g(n);
  for (double& x : theta) x = normal(random);
  std::vector<long double> expected(theta.begin(), theta.end()), m(n, 0.0L), v(n, 0.0L);
  for (int step = 1; step <= 40; ++step) {
    const double rate = 0.1 / step;
    for (double& x : g) x = normal(random);
    optimizer.step(theta, g, rate);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const auto x = static_cast<long double>(g[static_cast<Eigen::Index>(i)]);
      expected[i] *= 1 - static_cast<long double>(rate) * 0.3L;
      m[i] += 0.1L * (x - m[i]);
      v[i] += 0.001L * (x * x - v[i]);
      const long double first = m[i] / (1 - std::pow(0.9L, step)), second = v[i] / (1 - std::pow(0.999L, step));
      expected[i] -= static_cast<long double>(rate) * first / (std::sqrt(second) + 1e-8L);
      CHECK(theta[static_cast<Eigen::Index>(i)] == Approx(static_cast<double>(expected[i])).epsilon(1e-12));
    }
  }
}

TEST_CASE("adam: a gradient of another length is refused", "[optim]") {
  Adam<double> optimizer(3);
  Eigen::VectorXd theta = Eigen::VectorXd::Zero(3), g = Eigen::VectorXd::Zero(2);
  CHECK_THROWS_AS(optimizer.step(theta, g, 1), InvalidArgument);
}

}  // namespace adam_test
