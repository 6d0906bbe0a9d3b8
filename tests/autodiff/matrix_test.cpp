#include "catch.hpp"
#include "support/matrices.hpp"

#include <dsns/autodiff/dual.hpp>
#include <dsns/autodiff/matrix.hpp>
#include <dsns/autodiff/tape.hpp>

#include <cmath>
#include <string>
#include <type_traits>
#include <vector>

namespace matrix_test {

using namespace dsns;
using test::random_matrix;

namespace {

using Matrix = Eigen::MatrixXd;

const auto tanh_entries = [](Eigen::Index n, auto* y, auto* slope) {
  using std::tanh;
  for (Eigen::Index i = 0; i < n; ++i) {
    y[i] = tanh(y[i]);
    slope[i] = 1 - y[i] * y[i];
  }
};

/// Parameters of a small network with every kind of node, and their gradients.
template <class T>
struct Parameters {
  Eigen::MatrixX<T> w1, w2, b, dw1, dw2, db;

  Parameters()
      : w1(random_matrix(4, 3, 1).cast<T>()),
        w2(random_matrix(4, 4, 2).cast<T>()),
        b(random_matrix(4, 1, 3).cast<T>()) {
    clear();
  }
  void clear() {
    dw1 = Eigen::MatrixX<T>::Zero(4, 3);
    dw2 = Eigen::MatrixX<T>::Zero(4, 4);
    db = Eigen::MatrixX<T>::Zero(4, 1);
  }
};

template <class T>
typename MatrixTape<T>::Node parameter(MatrixTape<T>& tape, const Eigen::MatrixX<T>& value,
                                       Eigen::MatrixX<T>& gradient) {
  return tape.parameter(typename MatrixTape<T>::Value(value.data(), value.rows(), value.cols()),
                        typename MatrixTape<T>::Gradient(gradient.data(), gradient.rows(), gradient.cols()));
}

/// | w2 z + y - target |^2 with y = tanh(w1 x + b), z = tanh(w2 y + b + y); fused layers or one node an operation.
template <class T>
typename MatrixTape<T>::Node network(MatrixTape<T>& tape, Parameters<T>& p, const Eigen::MatrixX<T>& x,
                                     const Eigen::MatrixX<T>& target, bool fused) {
  const auto w1 = parameter(tape, p.w1, p.dw1), w2 = parameter(tape, p.w2, p.dw2), b = parameter(tape, p.b, p.db);
  const auto in = tape.constant(x);
  const auto first =
      fused ? tape.layer(w1, b, in, tanh_entries) : tape.apply(tape.add(tape.product(w1, in), b), tanh_entries);
  const auto second = fused ? tape.layer(w2, b, first, first, tanh_entries)
                            : tape.apply(tape.add(tape.add(tape.product(w2, first), b), first), tanh_entries);
  return tape.squared_error(tape.add(tape.product(w2, second), first), target);
}

}  // namespace

TEST_CASE("matrix tape: gradients equal those of the scalar tape, fused or not", "[autodiff]") {
  using V = Var<double>;
  const Matrix x = random_matrix(3, 5, 4), target = random_matrix(4, 5, 5);
  Parameters<double> p;

  Tape<double> scalar;
  const auto recording = scalar.record();
  const auto variables = [&](const Matrix& m) {
    Eigen::MatrixX<V> v(m.rows(), m.cols());
    for (Eigen::Index k = 0; k < m.size(); ++k) v.reshaped()[k] = scalar.variable(m.reshaped()[k]);
    return v;
  };
  const Eigen::MatrixX<V> w1 = variables(p.w1), w2 = variables(p.w2), b = variables(p.b);
  V loss(0);
  for (Eigen::Index j = 0; j < x.cols(); ++j) {
    const Eigen::VectorX<V> z = w1 * x.col(j).cast<V>() + b.col(0);
    const Eigen::VectorX<V> first = z.unaryExpr([](const V& y) { return tanh(y); });
    const Eigen::VectorX<V> u = w2 * first + b.col(0) + first;
    const Eigen::VectorX<V> second = u.unaryExpr([](const V& y) { return tanh(y); });
    const Eigen::VectorX<V> out = w2 * second + first;
    for (Eigen::Index k = 0; k < 4; ++k) loss += sqr(out[k] - target(k, j));
  }
  scalar.backward(loss);
  const auto check = [&](const Eigen::MatrixX<V>& v, const Matrix& gradient) {
    for (Eigen::Index k = 0; k < v.size(); ++k)
      CHECK(gradient.reshaped()[k] == Approx(scalar.adjoint(v.reshaped()[k])).epsilon(1e-12).margin(1e-13));
  };

  MatrixTape<double> tape;
  for (const bool fused : {false, true, true}) {  // the last on used memory
    INFO("fused " << fused);
    p.clear();
    tape.clear();
    const auto result = network(tape, p, x, target, fused);
    tape.backward(result);
    CHECK(tape.value(result)(0, 0) == Approx(loss.f).epsilon(1e-13));
    check(w1, p.dw1);
    check(w2, p.dw2);
    check(b, p.db);
  }
}

TEST_CASE("matrix tape: gradients against central differences", "[autodiff]") {
  const Matrix x = random_matrix(3, 5, 6), target = random_matrix(4, 5, 7);
  Parameters<double> p;
  MatrixTape<double> tape;
  const auto loss = [&] {
    tape.clear();
    const auto result = network(tape, p, x, target, true);
    return std::pair(result, tape.value(result)(0, 0));
  };
  tape.backward(loss().first);
  const Matrix gradient = p.dw1;
  const double h = 1e-6;
  for (Eigen::Index k = 0; k < p.w1.size(); ++k) {
    const double before = p.w1.reshaped()[k];
    p.w1.reshaped()[k] = before + h;
    const double up = loss().second;
    p.w1.reshaped()[k] = before - h;
    const double down = loss().second;
    p.w1.reshaped()[k] = before;
    CHECK(gradient.reshaped()[k] == Approx((up - down) / (2 * h)).epsilon(1e-7).margin(1e-8));
  }
}

TEST_CASE("matrix tape: forward scalars inside give the derivative of the gradient", "[autodiff]") {
  using D = Dual<double, 1>;
  const Matrix x = random_matrix(3, 2, 8), target = random_matrix(4, 2, 9);
  const double h = 1e-6;
  const auto gradient_at = [&](double shift) {
    Parameters<double> p;
    p.w1(1, 2) += shift;
    MatrixTape<double> tape;
    tape.backward(network(tape, p, x, target, true));
    return p.dw2;
  };
  Parameters<D> p;
  p.w1(1, 2).g[0] = 1;
  MatrixTape<D> tape;
  tape.backward(network<D>(tape, p, x.cast<D>(), target.cast<D>(), true));
  const Matrix difference = (gradient_at(h) - gradient_at(-h)) / (2 * h);
  for (Eigen::Index k = 0; k < difference.size(); ++k)
    CHECK(p.dw2.reshaped()[k].g[0] == Approx(difference.reshaped()[k]).epsilon(1e-6).margin(1e-7));
}

TEST_CASE("matrix tape: gradients add up over sweeps and carry the seed", "[autodiff]") {
  const Matrix x = random_matrix(3, 5, 10), target = random_matrix(4, 5, 11);
  Parameters<double> p;
  MatrixTape<double> tape;
  const auto result = network(tape, p, x, target, true);
  tape.backward(result);
  const Matrix once = p.dw2;
  tape.backward(result, 2.0);
  CHECK(p.dw2.isApprox(3 * once, 1e-14));
}

TEST_CASE("matrix tape: adjoints of inner nodes, and of nodes the result does not depend on", "[autodiff]") {
  Matrix w = random_matrix(2, 2, 12), dw = Matrix::Zero(2, 2);
  const Matrix target = Matrix::Zero(2, 3);
  MatrixTape<double> tape;
  const auto x = tape.constant(random_matrix(2, 3, 13));
  const auto y = tape.product(parameter(tape, w, dw), x), unused = tape.add(y, y);
  tape.backward(tape.squared_error(y, target));
  CHECK(tape.adjoint(y).isApprox(2 * Matrix(tape.value(y)), 1e-15));
  CHECK(tape.adjoint(unused).isZero());
  CHECK(tape.adjoint(x).isZero());  // constants take no part
  CHECK(dw.isApprox(2 * tape.value(y) * tape.value(x).transpose(), 1e-14));
}

namespace {

/// Scalars, a product of matrices of them, scalars made of its entries, and another product; `product` takes two
/// matrices, given column by column, and returns one.
template <class V, class Product>
V there_and_back(const std::vector<V>& x, const Product& product) {
  const V a = sin(x[0]) * x[1];
  const std::vector<V> left{a, x[1], x[2] * x[0], exp(x[3]), 2.0, a + x[4]};
  const std::vector<V> first = product(2, 3, 2, left, std::vector<V>{x[0], x[1], x[2], x[3], x[4], x[5]});
  const V b = log(1 + first[0] * first[0]) + a;
  const std::vector<V> second = product(2, 2, 2, first, std::vector<V>{b, first[3], x[5], b * x[0]});
  V sum = x[1] * b;
  for (const V& y : second) sum += y * cos(y);
  return sum;
}

}  // namespace

TEST_CASE("matrix tape: matrices and scalars on one tape, in one sweep", "[autodiff]") {
  const auto check = [](const auto& start) {
    using T = std::decay_t<decltype(start)>;
    using V = Var<T>;
    const auto values = [&](int k) { return T(0.3 + 0.2 * k) * start; };
    Tape<T> plain, tape;
    MatrixTape<T> matrices(tape);
    std::vector<T> expected;
    {
      const auto recording = plain.record();
      std::vector<V> x;
      for (int k = 0; k < 6; ++k) x.push_back(plain.variable(values(k)));
      plain.backward(there_and_back(x, [](int rows, int inner, int cols, const auto& a, const auto& b) {
        std::vector<V> r(std::size_t(rows * cols), V(0));
        for (int j = 0; j < cols; ++j)
          for (int i = 0; i < rows; ++i)
            for (int k = 0; k < inner; ++k)
              r[std::size_t(j * rows + i)] += a[std::size_t(k * rows + i)] * b[std::size_t(j * inner + k)];
        return r;
      }));
      for (const V& v : x) expected.push_back(plain.adjoint(v));
    }
    for (int round = 0; round < 2; ++round) {  // a recording forgets the nodes of the one before
      const auto recording = tape.record();
      std::vector<V> x;
      for (int k = 0; k < 6; ++k) x.push_back(tape.variable(values(k)));
      const V y = there_and_back(x, [&](int rows, int inner, int cols, const auto& a, const auto& b) {
        return matrices.entries(matrices.product(matrices.matrix(rows, inner, a), matrices.matrix(inner, cols, b)));
      });
      for (const double seed : {1.0, 2.0}) {  // a sweep replaces the one before
        tape.backward(y, T(seed));
        for (std::size_t k = 0; k < 6; ++k) {
          const T found = tape.adjoint(x[k]), wanted = seed * expected[k];
          CHECK(value(found) == Approx(value(wanted)).epsilon(1e-13));
          if constexpr (Differentiable<T>) CHECK(found.g[0] == Approx(wanted.g[0]).epsilon(1e-12));
        }
      }
    }
  };
  check(1.0);
  check(Dual<double, 1>::variable(1, 0));
}

TEST_CASE("matrix tape: parameters of a network inside a computation with scalars", "[autodiff]") {
  const Matrix x = random_matrix(3, 5, 14), target = random_matrix(4, 5, 15);
  Parameters<double> alone, beside;
  MatrixTape<double> matrices;
  const auto e = network(matrices, alone, x, target, true);
  const double error = matrices.value(e)(0, 0), factor = 3 / (1 + error);
  matrices.backward(e, factor);  // of 3 log(1 + error)

  Tape<double> tape;
  MatrixTape<double> on_tape(tape);
  const auto recording = tape.record();
  const auto three = tape.variable(3);
  const auto node = network(on_tape, beside, x, target, true);
  const auto loss = three * log(1 + on_tape.entries(node)[0]);
  CHECK(loss.f == Approx(3 * std::log(1 + error)));
  tape.backward(loss);
  CHECK(tape.adjoint(three) == Approx(std::log(1 + error)));
  CHECK(beside.dw1.isApprox(alone.dw1, 1e-13));
  CHECK(beside.dw2.isApprox(alone.dw2, 1e-13));
  CHECK(beside.db.isApprox(alone.db, 1e-13));
  CHECK(on_tape.adjoint(node)(0, 0) == Approx(factor));
  beside.clear();
  on_tape.backward(node, factor);
  CHECK(beside.dw2.isApprox(alone.dw2, 1e-13));
  const auto constant = on_tape.entries(on_tape.constant(x));
  tape.backward(constant[3] * three);
  CHECK(tape.adjoint(three) == x(0, 1));
  CHECK(on_tape.adjoint(node).isZero());
}

TEST_CASE("matrix tape: what cannot be on one tape is refused", "[autodiff]") {
  const auto message = [](const auto& wrong) -> std::string {
    try {
      wrong();
    } catch (const InvalidArgument& error) {
      return error.what();
    }
    return "";
  };
  Tape<double> tape, other;
  MatrixTape<double> alone, matrices(tape);
  CHECK(message([&] { matrices.constant(Matrix::Zero(1, 1)); }).find("recording") != std::string::npos);
  const auto recording = tape.record();
  const std::vector<Var<double>> x{tape.variable(1), tape.variable(2)};
  CHECK(message([&] { alone.matrix(1, 2, x); }).find("MatrixTape(tape)") != std::string::npos);
  CHECK(message([&] { matrices.matrix(2, 2, x); }) == "MatrixTape::matrix: 2 scalars for 2 x 2 entries");
  {
    const auto inner = other.record();
    CHECK(message([&] { matrices.matrix(1, 2, x); }).find("active") != std::string::npos);
    MatrixTape<double> on_other(other);
    CHECK(message([&] { on_other.matrix(1, 2, x); }).find("active") != std::string::npos);
  }
  Var<double> y;
  {
    MatrixTape<double> short_lived(tape);
    y = short_lived.entries(short_lived.matrix(1, 2, x))[0];
  }
  CHECK(message([&] { tape.backward(y); }).find("MatrixTape on it has ended") != std::string::npos);
}

TEST_CASE("matrix tape: shapes that do not fit are named", "[autodiff]") {
  MatrixTape<double> tape;
  const auto a = tape.constant(Matrix::Zero(2, 3)), b = tape.constant(Matrix::Zero(2, 2));
  CHECK_THROWS_AS(tape.product(a, b), InvalidArgument);
  CHECK_THROWS_AS(tape.add(a, b), InvalidArgument);
  CHECK_THROWS_AS(tape.squared_error(a, Matrix::Zero(3, 3)), InvalidArgument);
  CHECK_THROWS_AS(tape.layer(a, b, a, tanh_entries), InvalidArgument);
  CHECK_THROWS_AS(tape.backward(a), InvalidArgument);
  try {
    tape.product(a, b);
  } catch (const InvalidArgument& error) {
    CHECK(std::string(error.what()) == "MatrixTape::product: 2 x 3 times 2 x 2");
  }
}

}  // namespace matrix_test
