#include "catch.hpp"

#include <dsns/nn/warp_network.hpp>

namespace warp_network_test {

using namespace dsns;

namespace {

/// A field of three values with its exact rate.
FieldOfTime field(double t) {
  Eigen::Vector3d value, rate;
  for (int k = 0; k < 3; ++k) {
    value[k] = std::sin((k + 2) * t + k) + 0.2;
    rate[k] = (k + 2) * std::cos((k + 2) * t + k);
  }
  return {value, rate};
}

/// sqrt(zeta') field(zeta) for zeta = t + 0.4 t (1 - t).
Eigen::VectorXd warped_field(double t) { return std::sqrt(1 + 0.4 * (1 - 2 * t)) * field(t + 0.4 * t * (1 - t)).value; }

const MlpShape shape{1, 6, 1, 1, Activation::softplus};

}  // namespace

TEST_CASE("warp network: the slope is the derivative of the warp", "[nn]") {
  const WarpNetwork warp(Mlp<double>(shape, 3));
  constexpr double h = 1e-5;
  for (const double t : {0.1, 0.5, 0.9})
    CHECK(warp.slope(t) == Approx((warp(t + h) - warp(t - h)) / (2 * h)).epsilon(1e-8));
}

TEST_CASE("warp network: the gradient of its loss is that of differences, through both signs of the slope", "[nn]") {
  // Seeds whose networks rise, and fall, where the penalty counts.
  const std::uint64_t seed = GENERATE(1u, 2u, 3u, 4u, 5u);
  const auto loss = detail::elastic_warp_loss(warped_field, field, 1.7, 5.0);
  detail::WarpProblem problem(loss, 20);
  std::mt19937_64 random(2);
  problem.draw(random);
  std::vector<Index> all(20);
  std::iota(all.begin(), all.end(), Index(0));
  Mlp<double> network(shape, seed);
  const auto value_and_gradient = [&](Eigen::VectorXd& gradient) {
    MatrixTape<double> tape;
    gradient = Eigen::VectorXd::Zero(shape.parameter_count());
    const auto x = tape.constant(1, 40, [&](Eigen::MatrixXd& m) { problem.fill(all, m); });
    const auto result = problem.loss(tape, network.record<jet_layouts::rate>(tape, x, gradient), all);
    tape.backward(result.node);
    return tape.value(result.node)(0, 0);
  };
  Eigen::VectorXd gradient, unused;
  value_and_gradient(gradient);
  constexpr double h = 1e-6;
  for (Index k = 0; k < gradient.size(); ++k) {
    const double at = network.parameters()[k];
    network.parameters()[k] = at + h;
    const double above = value_and_gradient(unused);
    network.parameters()[k] = at - h;
    const double below = value_and_gradient(unused);
    network.parameters()[k] = at;
    CHECK(gradient[k] == Approx((above - below) / (2 * h)).epsilon(1e-6).margin(1e-6));
  }
}

TEST_CASE("warp network: training begins at the identity and goes to the known warp", "[nn]") {
  WarpNetworkOptions options;
  options.width = 8;
  options.times = 40;
  options.steps = 0;
  options.learning_rate = 1e-3;
  const auto distance_to = [](const WarpNetwork& warp, const auto& truth) {
    double sum = 0;
    for (int k = 0; k < 100; ++k) sum += std::pow(warp((k + 0.5) / 100) - truth((k + 0.5) / 100), 2) / 100;
    return std::sqrt(sum);
  };
  const auto zeta = [](double t) { return t + 0.4 * t * (1 - t); };
  const WarpFit start = fit_warp_network(warped_field, field, options);
  CHECK(distance_to(start.warp, [](double t) { return t; }) < 0.03);
  options.steps = 1500;
  const WarpFit fit = fit_warp_network(warped_field, field, options);
  CHECK(distance_to(start.warp, zeta) > 0.05);
  CHECK(distance_to(fit.warp, zeta) < 0.02);
  CHECK(fit.error < 1e-2);
}

TEST_CASE("warp network: what cannot be trained is refused", "[nn]") {
  const auto nothing = [](double) { return Eigen::VectorXd::Zero(3).eval(); };
  CHECK_THROWS_AS(fit_warp_network(nothing, field), InvalidArgument);
  CHECK_THROWS_AS(WarpNetwork(Mlp<double>(MlpShape{2, 4, 1, 1})), InvalidArgument);
}

}  // namespace warp_network_test
