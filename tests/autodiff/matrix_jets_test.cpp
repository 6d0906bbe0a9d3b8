#include "catch.hpp"
#include "support/matrices.hpp"

#include <dsns/autodiff/jet2.hpp>
#include <dsns/autodiff/matrix_jets.hpp>
#include <dsns/autodiff/tape.hpp>

#include <array>
#include <cmath>

namespace matrix_jets_test {

using namespace dsns;
using test::random_matrix;
using Matrix = Eigen::MatrixXd;

namespace {

const auto tanh_jets = [](auto z, auto slope, auto second, auto third) {
  z = z.tanh();
  slope = 1 - z.square();
  second = -2 * z * slope;
  third = slope * (6 * z.square() - 2);
};

/// A number that depends on every part of a surface's jet: values (block 0), tangents, second derivatives.
const auto curved = [](const auto& f) {
  using T = std::decay_t<decltype(f[0][0])>;
  T s(0);
  for (std::size_t r = 0; r < 2; ++r) s += f[0][r] * f[3][r] + f[1][r] * f[2][r] * f[4][r] - sqr(f[5][r]) * f[0][0];
  return s / (2 + sqr(f[1][0]));
};

struct Network {
  Matrix w1 = random_matrix(4, 3, 1), b1 = random_matrix(4, 1, 2), w2 = random_matrix(2, 4, 3),
         b2 = random_matrix(2, 1, 4);
  Matrix dw1 = Matrix::Zero(4, 3), db1 = Matrix::Zero(4, 1), dw2 = Matrix::Zero(2, 4), db2 = Matrix::Zero(2, 1);
};

using Node = MatrixTape<double>::Node;
Node parameter(MatrixTape<double>& tape, const Matrix& value, Matrix& gradient) {
  return tape.parameter({value.data(), value.rows(), value.cols()},
                        {gradient.data(), gradient.rows(), gradient.cols()});
}

Node loss(MatrixTape<double>& tape, Network& n, const Matrix& x) {
  const Node h =
      jet_layer(tape, parameter(tape, n.w1, n.dw1), parameter(tape, n.b1, n.db1), tape.constant(x), tanh_jets);
  const Node y = jet_bias(tape, tape.product(parameter(tape, n.w2, n.dw2), h), parameter(tape, n.b2, n.db2));
  return tape.sum(pointwise<2, 6>(tape, tape.scale(y, 1.5), curved));
}

}  // namespace

TEST_CASE("matrix jets: a loss with second derivatives in the input, against jets of variables", "[autodiff]") {
  const Eigen::Index m = 3;
  const Matrix x = random_matrix(3, 6 * m, 5);
  Network net;
  MatrixTape<double> tape;
  Node result{};
  for (int repeat = 0; repeat < 2; ++repeat) {  // the second on used memory
    net.dw1.setZero(), net.db1.setZero(), net.dw2.setZero(), net.db2.setZero();
    tape.clear();
    result = loss(tape, net, x);
    tape.backward(result);
  }

  using V = Var<double>;
  using J = Jet2<V, 2>;
  Tape<double> scalar;
  const auto recording = scalar.record();
  const auto variables = [&](const Matrix& p) {
    Eigen::MatrixX<V> v(p.rows(), p.cols());
    for (Eigen::Index k = 0; k < p.size(); ++k) v.reshaped()[k] = scalar.variable(p.reshaped()[k]);
    return v;
  };
  const auto w1 = variables(net.w1), b1 = variables(net.b1), w2 = variables(net.w2), b2 = variables(net.b2);
  V total(0);
  for (Eigen::Index i = 0; i < m; ++i) {
    std::array<J, 4> h;
    for (Eigen::Index r = 0; r < 4; ++r) {
      J s(b1(r, 0));
      for (Eigen::Index c = 0; c < 3; ++c) {
        const auto at = [&](Eigen::Index k) { return V(x(c, k * m + i)); };
        s += w1(r, c) * J(at(0), {at(1), at(2)}, {at(3), at(4), at(5)});
      }
      h[std::size_t(r)] = tanh(s);
    }
    std::array<std::array<V, 2>, 6> f;
    for (Eigen::Index r = 0; r < 2; ++r) {
      J s(b2(r, 0));
      for (Eigen::Index c = 0; c < 4; ++c) s += w2(r, c) * h[std::size_t(c)];
      s *= 1.5;
      const V* const parts[] = {&s.f, &s.g[0], &s.g[1], &s.h[0], &s.h[1], &s.h[2]};
      for (std::size_t k = 0; k < 6; ++k) f[k][std::size_t(r)] = *parts[k];
    }
    total += curved(f);
  }
  scalar.backward(total);
  CHECK(tape.value(result)(0, 0) == Approx(total.f).epsilon(1e-13));
  const auto check = [&](const Eigen::MatrixX<V>& v, const Matrix& gradient) {
    for (Eigen::Index k = 0; k < v.size(); ++k)
      CHECK(gradient.reshaped()[k] == Approx(scalar.adjoint(v.reshaped()[k])).epsilon(1e-11).margin(1e-12));
  };
  check(w1, net.dw1);
  check(b1, net.db1);
  check(w2, net.dw2);
  check(b2, net.db2);
}

TEST_CASE("matrix jets: the gradient against central differences", "[autodiff]") {
  const Matrix x = random_matrix(3, 12, 6);
  Network net;
  MatrixTape<double> tape;
  const auto value = [&] {
    tape.clear();
    return tape.value(loss(tape, net, x))(0, 0);
  };
  tape.clear();
  tape.backward(loss(tape, net, x));
  const Matrix gradient = net.dw1;
  for (Eigen::Index k = 0; k < gradient.size(); ++k) {
    double& w = net.w1.reshaped()[k];
    const double before = w, h = 1e-6;
    w = before + h;
    const double up = value();
    w = before - h;
    const double down = value();
    w = before;
    CHECK(gradient.reshaped()[k] == Approx((up - down) / (2 * h)).epsilon(1e-6).margin(1e-7));
  }
}

TEST_CASE("matrix jets: shapes that do not fit are named", "[autodiff]") {
  MatrixTape<double> tape;
  const auto w = tape.constant(Matrix::Zero(2, 3)), b = tape.constant(Matrix::Zero(2, 1));
  const auto x = tape.constant(Matrix::Zero(3, 6)), odd = tape.constant(Matrix::Zero(3, 7));
  CHECK_NOTHROW(jet_layer(tape, w, b, x, tanh_jets));
  CHECK_THROWS_AS(jet_layer(tape, w, b, odd, tanh_jets), InvalidArgument);
  CHECK_THROWS_AS(jet_layer(tape, w, x, x, tanh_jets), InvalidArgument);
  CHECK_THROWS_AS(jet_bias(tape, x, b), InvalidArgument);
  CHECK_THROWS_AS((pointwise<2, 6>(tape, x, curved)), InvalidArgument);
}

}  // namespace matrix_jets_test
