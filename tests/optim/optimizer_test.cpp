#include "catch.hpp"

#include <dsns/optim/adam.hpp>
#include <dsns/optim/rmsprop.hpp>
#include <dsns/optim/schedule.hpp>
#include <dsns/optim/soap.hpp>

#include <random>
#include <type_traits>

namespace optimizer_test {

using namespace dsns;

static_assert(!Optimizer<double> && !Optimizer<OptimizerState<double>>);

namespace {

using AllOptimizers = std::tuple<RmsProp<float>, RmsProp<double>, Adam<float>, Adam<double>, Soap<float>, Soap<double>>;

/// An optimiser of 3 x 4 weights with their biases and 2 x 3 weights, as one of 21 parameters.
template <class O>
O make_optimizer() {
  if constexpr (std::is_constructible_v<O, Index>) {
    return O(21);
  } else {
    SoapOptions options;
    options.refresh = 3;
    return O({{0, 3, 4}, {12, 3, 1}, {15, 2, 3}}, options);
  }
}

template <class T>
Eigen::VectorX<T> random_vector(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return Eigen::VectorX<T>::NullaryExpr(21, [&] { return T(normal(random)); });
}

}  // namespace

TEMPLATE_LIST_TEST_CASE("optimizers: a restored state continues with the same bits", "[optim][law]", AllOptimizers) {
  using T = typename TestType::Scalar;
  const int stop = GENERATE(0, 1, 2, 7);
  std::mt19937_64 random(5);
  auto optimizer = make_optimizer<TestType>();
  Eigen::VectorX<T> theta = random_vector<T>(random);
  for (int i = 0; i < stop; ++i) optimizer.step(theta, random_vector<T>(random), 0.01);
  CHECK(optimizer.state().steps == stop);

  auto other = make_optimizer<TestType>();
  Eigen::VectorX<T> copy = theta;
  other.step(copy, random_vector<T>(random), 0.01);  // forgotten by restoring
  other.restore(optimizer.state());
  copy = theta;
  for (int i = 0; i < 8; ++i) {
    const Eigen::VectorX<T> g = random_vector<T>(random);
    optimizer.step(theta, g, 0.01);
    other.step(copy, g, 0.01);
    CHECK(theta == copy);
  }
}

TEMPLATE_LIST_TEST_CASE("optimizers: the state of something else is refused", "[optim]", AllOptimizers) {
  auto optimizer = make_optimizer<TestType>();
  const auto own = optimizer.state();
  auto negative = own, renamed = own, longer = own, fewer = own;
  negative.steps = -1;
  renamed.arrays[1].name = "other";
  longer.arrays[0].values.resize(own.arrays[0].values.size() + 1);
  fewer.arrays.pop_back();
  for (const auto& state : {negative, renamed, longer, fewer})
    CHECK_THROWS_AS(optimizer.restore(state), InvalidArgument);
  CHECK_NOTHROW(optimizer.restore(own));
}

TEMPLATE_LIST_TEST_CASE("optimizers: a quadratic is minimised with a falling rate", "[optim][law]", AllOptimizers) {
  using T = typename TestType::Scalar;
  std::mt19937_64 random(9);
  auto optimizer = make_optimizer<TestType>();
  const Eigen::VectorX<T> minimum = random_vector<T>(random);
  const Eigen::VectorX<T> curvature = Eigen::VectorX<T>::LinSpaced(21, 1, 30);
  Eigen::VectorX<T> theta = Eigen::VectorX<T>::Zero(21);
  const int steps = 2000;
  for (int i = 0; i < steps; ++i)
    optimizer.step(theta, curvature.cwiseProduct(theta - minimum), 0.01 * CosineRate{}(double(i) / steps));
  CHECK(double((theta - minimum).norm()) == Approx(0).margin(1e-4));
}

}  // namespace optimizer_test
