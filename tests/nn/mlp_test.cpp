#include "catch.hpp"

#include <dsns/autodiff/jet2.hpp>
#include <dsns/autodiff/tape.hpp>
#include <dsns/nn/mlp.hpp>

#include <random>
#include <vector>

namespace mlp_test {

using namespace dsns;

namespace {

MlpShape small_shape(Activation activation) {
  MlpShape shape;
  shape.inputs = 5;
  shape.width = 9;
  shape.blocks = 2;
  shape.outputs = 3;
  shape.activation = activation;
  return shape;
}

Eigen::MatrixXd inputs(Index rows, Index cols) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd x(rows, cols);
  for (double& entry : x.reshaped()) entry = normal(random);
  return x;
}

}  // namespace

TEST_CASE("mlp: parameter counts, the paper's among them", "[nn]") {
  MlpShape paper;
  paper.inputs = 80;
  paper.width = 1024;
  paper.blocks = 6;
  paper.activation = Activation::softplus;
  CHECK(paper.parameter_count() == 80 * 1024 + 1024 + 12 * (1024 * 1024 + 1024) + 3 * 1024 + 3);
  CHECK(Mlp<float>(small_shape(Activation::silu)).parameters().size() == 5 * 9 + 9 + 4 * 90 + 30);
}

TEST_CASE("mlp: weights start uniform within 1 / sqrt(inputs), from the seed", "[nn]") {
  MlpShape shape = small_shape(Activation::silu);
  shape.width = 100;
  const Mlp<double> a(shape, 7), b(shape, 7), c(shape, 8);
  CHECK(a.parameters() == b.parameters());
  CHECK(a.parameters() != c.parameters());
  for (int l = 0; l < shape.layers(); ++l) {
    const auto layer = a.parameters().segment(shape.offset(l), shape.offset(l + 1) - shape.offset(l));
    const double bound = 1 / std::sqrt(double(shape.cols(l)));
    CHECK(layer.cwiseAbs().maxCoeff() <= bound);
    CHECK(layer.cwiseAbs().maxCoeff() > 0.95 * bound);
    CHECK(std::sqrt(layer.squaredNorm() / double(layer.size())) == Approx(bound / std::sqrt(3.0)).epsilon(0.1));
  }
}

TEST_CASE("mlp: the residual block written out", "[nn]") {
  MlpShape shape;
  shape.inputs = shape.width = shape.outputs = shape.blocks = 1;
  shape.activation = Activation::softplus;
  Eigen::VectorXd p(8);
  p << 0.5, 0.1, 2, -0.3, -1, 0.2, 3, 0.4;  // weight and bias of each layer
  const Mlp<double> net(shape, p);
  const double x = 0.7, y = softplus(0.5 * x + 0.1);
  const double z = softplus(-softplus(2 * y - 0.3) + 0.2 + y);
  CHECK(net(Eigen::VectorXd(Eigen::VectorXd::Constant(1, x)))[0] == Approx(3 * z + 0.4));
  CHECK(net.columns(Eigen::MatrixXd::Constant(1, 1, x), jet_layouts::value)(0, 0) == Approx(3 * z + 0.4));
}

TEST_CASE("mlp: columns carry the jets of the scalar path", "[nn]") {
  const auto activation = GENERATE(Activation::softplus, Activation::silu, Activation::tanh, Activation::sine);
  const Mlp<double> net(small_shape(activation), 3);
  const Index n = 7;
  const Eigen::MatrixXd x = inputs(5, 6 * n);
  const Eigen::MatrixXd jets = net.columns(x, jet_layouts::second),
                        tangents = net.columns(x.leftCols(2 * n), jet_layouts::rate),
                        values = net.columns(x.leftCols(n), jet_layouts::value);
  double worst = 0;
  for (Index j = 0; j < n; ++j) {
    Eigen::VectorX<Jet2<double, 2>> in(5);
    for (Index k = 0; k < 5; ++k) {
      in[k].f = x(k, j);
      in[k].g = {x(k, n + j), x(k, 2 * n + j)};
      in[k].h = {x(k, 3 * n + j), x(k, 4 * n + j), x(k, 5 * n + j)};
    }
    const auto out = net(in);
    for (Index k = 0; k < 3; ++k) {
      const double errors[] = {jets(k, j) - out[k].f,
                               jets(k, n + j) - out[k].g[0],
                               jets(k, 2 * n + j) - out[k].g[1],
                               jets(k, 3 * n + j) - out[k].h[0],
                               jets(k, 4 * n + j) - out[k].h[1],
                               jets(k, 5 * n + j) - out[k].h[2],
                               tangents(k, j) - out[k].f,
                               tangents(k, n + j) - out[k].g[0],
                               values(k, j) - out[k].f};
      for (const double error : errors) worst = std::max(worst, std::abs(error));
    }
  }
  CHECK(worst < 1e-12);
}

TEST_CASE("mlp: recorded on the matrix tape it has the gradient of the scalar tape", "[nn]") {
  const auto activation = GENERATE(Activation::softplus, Activation::silu, Activation::tanh, Activation::sine);
  const MlpShape shape = small_shape(activation);
  const Mlp<double> net(shape, 11);
  const Eigen::MatrixXd x = inputs(5, 6), target = inputs(3, 6);

  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(shape.parameter_count());
  MatrixTape<double> tape;
  const auto out = net.record(tape, tape.constant(x), gradient);
  CHECK(Eigen::MatrixXd(tape.value(out)).isApprox(net.columns(x, jet_layouts::value), 1e-14));
  tape.backward(tape.squared_error(out, target));

  using V = Var<double>;
  Tape<double> scalar;
  const auto recording = scalar.record();
  Eigen::VectorX<V> parameters(shape.parameter_count());
  for (Index k = 0; k < parameters.size(); ++k) parameters[k] = scalar.variable(net.parameters()[k]);
  const Mlp<V> active(shape, parameters);
  V loss(0);
  for (Index j = 0; j < x.cols(); ++j) {
    const Eigen::VectorX<V> y = active(Eigen::VectorX<V>(x.col(j).cast<V>()));
    for (Index k = 0; k < 3; ++k) loss += sqr(y[k] - target(k, j));
  }
  scalar.backward(loss);
  double worst = 0;
  for (Index k = 0; k < parameters.size(); ++k)
    worst = std::max(worst, std::abs(gradient[k] - scalar.adjoint(parameters[k])));
  CHECK(worst < 1e-12 * gradient.norm());
}

namespace {

/// How far the recorded jets are from the batch's, and the gradient of the sum of their squares from reverse mode over
/// scalars that carry the derivatives in the input. `places`: of the layout's second derivatives in the scalar's Hessian.
template <JetLayout layout, class Jet>
double recorded_jets_error(Activation activation, const std::vector<std::size_t>& places) {
  const MlpShape shape = small_shape(activation);
  const Mlp<double> net(shape, 11);
  constexpr Index n = 4;
  const Eigen::MatrixXd x = inputs(5, n * layout.blocks());
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(shape.parameter_count());
  MatrixTape<double> tape;
  const auto out = net.record<layout>(tape, tape.constant(x), gradient);
  double worst = (tape.value(out) - net.columns(x, layout)).cwiseAbs().maxCoeff();
  tape.backward(tape.squared_error(out, Eigen::MatrixXd::Zero(3, x.cols())));

  using V = Var<double>;
  Tape<double> scalar;
  const auto recording = scalar.record();
  Eigen::VectorX<V> parameters(shape.parameter_count());
  for (Index k = 0; k < parameters.size(); ++k) parameters[k] = scalar.variable(net.parameters()[k]);
  const Mlp<V> active(shape, parameters);
  V loss(0);
  for (Index j = 0; j < n; ++j) {
    Eigen::VectorX<Jet> in(5);
    for (Index k = 0; k < 5; ++k) {
      in[k] = Jet(V(x(k, j)));
      for (int d = 0; d < layout.firsts; ++d) in[k].g[std::size_t(d)] = V(x(k, (1 + d) * n + j));
      for (std::size_t d = 0; d < places.size(); ++d)
        in[k].h[places[d]] = V(x(k, (1 + layout.firsts + Index(d)) * n + j));
    }
    for (const Jet& y : active(in)) {
      loss += sqr(y.f);
      for (int d = 0; d < layout.firsts; ++d) loss += sqr(y.g[std::size_t(d)]);
      for (const std::size_t place : places) loss += sqr(y.h[place]);
    }
  }
  scalar.backward(loss);
  for (Index k = 0; k < parameters.size(); ++k)
    worst = std::max(worst, std::abs(gradient[k] - scalar.adjoint(parameters[k])) / gradient.norm());
  return worst;
}

}  // namespace

TEST_CASE("mlp: gradients of losses that contain derivatives in the input are those of the scalar tape", "[nn]") {
  const auto a = GENERATE(Activation::softplus, Activation::silu, Activation::tanh, Activation::sine);
  using V = Var<double>;
  CHECK(recorded_jets_error<jet_layouts::tangents, Jet2<V, 2>>(a, {}) < 1e-12);
  CHECK(recorded_jets_error<jet_layouts::second, Jet2<V, 2>>(a, {0, 1, 2}) < 1e-12);
  CHECK(recorded_jets_error<jet_layouts::motion, Jet2<V, 3>>(a, {2, 4}) < 1e-12);  // of uu uv ut vv vt tt
}

TEST_CASE("mlp: shapes and inputs that do not fit are refused", "[nn]") {
  MlpShape shape = small_shape(Activation::silu);
  const Mlp<double> net(shape);
  CHECK_THROWS_AS(net.columns(Eigen::MatrixXd::Zero(4, 6), jet_layouts::value), InvalidArgument);
  CHECK_THROWS_AS(net.columns(Eigen::MatrixXd::Zero(5, 7), jet_layouts::second), InvalidArgument);
  CHECK_THROWS_AS(Mlp<double>(shape, Eigen::VectorXd::Zero(3)), InvalidArgument);
  shape.width = 0;
  CHECK_THROWS_AS(Mlp<double>(shape), InvalidArgument);
}

}  // namespace mlp_test
