#include "catch.hpp"
#include "support/matrices.hpp"

#include <dsns/nn/losses.hpp>

namespace losses_test {

using namespace dsns;
using test::random_matrix;
using Matrix = Eigen::MatrixXd;

namespace {

/// The largest difference between the recorded derivative in y and central differences, which are exact for quadratics.
template <class Loss>
double gradient_error(const Matrix& y, const Loss& loss) {
  Matrix gradient = Matrix::Zero(y.rows(), y.cols());
  const auto value = [&](const Matrix& at) {
    MatrixTape<double> tape;
    return tape.value(loss(tape, tape.constant(at)))(0, 0);
  };
  MatrixTape<double> tape;
  tape.backward(loss(tape, tape.parameter({y.data(), y.rows(), y.cols()}, {gradient.data(), y.rows(), y.cols()})));
  double worst = 0;
  for (Eigen::Index k = 0; k < y.size(); ++k) {
    Matrix up = y, down = y;
    up.reshaped()[k] += 0.5;
    down.reshaped()[k] -= 0.5;
    worst = std::max(worst, std::abs(gradient.reshaped()[k] - (value(up) - value(down))));
  }
  return worst;
}

}  // namespace

TEST_CASE("losses: the error of jets is the weighted sum of squares", "[nn]") {
  constexpr JetLayout layout = jet_layouts::tangents;
  const Matrix y = random_matrix(3, 12, 1), target = random_matrix(3, 12, 2);
  const BlockWeights<layout> weights{1, 0.5, 2};
  const auto loss = [&](MatrixTape<double>& tape, MatrixTape<double>::Node node) {
    return jet_error<layout>(tape, node, target, weights);
  };
  MatrixTape<double> tape;
  const Matrix d = y - target;
  CHECK(
      tape.value(loss(tape, tape.constant(y)))(0, 0) ==
      Approx(d.leftCols(4).squaredNorm() + 0.5 * d.middleCols(4, 4).squaredNorm() + 2 * d.rightCols(4).squaredNorm()));
  CHECK(gradient_error(y, loss) < 1e-12);
  CHECK_THROWS_AS(jet_error<layout>(tape, tape.constant(y), Matrix(random_matrix(3, 9, 2)), weights), InvalidArgument);
}

TEST_CASE("losses: the error of normals is the squared angle of small turns, and zero for tangents in the plane",
          "[nn]") {
  constexpr JetLayout layout = jet_layouts::tangents;
  const double angle = 1e-4;
  Matrix y(3, 3), normal(3, 1);
  normal << 0, 0, 1;
  y << 7, 1, 0, 8, 0, 1, 9, 0, std::tan(angle);  // turned about the x-axis
  MatrixTape<double> tape;
  CHECK(tape.value(normal_error<layout>(tape, tape.constant(y), normal))(0, 0) == Approx(angle * angle));
  y(2, 2) = 0;
  CHECK(tape.value(normal_error<layout>(tape, tape.constant(y), normal))(0, 0) == 0);
  const Matrix many = random_matrix(3, 12, 3), normals = random_matrix(3, 4, 4);
  CHECK(gradient_error(many, [&](MatrixTape<double>& t, MatrixTape<double>::Node node) {
          return normal_error<layout>(t, node, normals);
        }) < 1e-12);
  CHECK_THROWS_AS(normal_error<layout>(tape, tape.constant(many), normal), InvalidArgument);
}

}  // namespace losses_test
