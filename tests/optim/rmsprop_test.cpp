#include "catch.hpp"

#include <dsns/optim/rmsprop.hpp>

#include <cmath>

namespace rmsprop_test {

using namespace dsns;

TEST_CASE("rmsprop: the first steps by hand", "[optim]") {
  // Gradients 2, -1, 3 with rate 0.1, carried out from the law with a calculator's precision.
  RmsProp<double> optimizer(1);
  Eigen::VectorXd theta = Eigen::VectorXd::Constant(1, 1.0), g(1);
  g[0] = 2;  // v = 0.04, b = 2 / 0.2 = 10
  optimizer.step(theta, g, 0.1);
  CHECK(theta[0] == Approx(1 - 0.1 * 10).margin(1e-7));
  g[0] = -1;  // v = 0.0396 + 0.01 = 0.0496, b = 9 - 1 / 0.22271057451 = 4.5098673
  optimizer.step(theta, g, 0.1);
  CHECK(theta[0] == Approx(-0.45098673).margin(1e-7));
  g[0] = 3;  // v = 0.049104 + 0.09 = 0.139104, b = 4.05888057 + 3 / 0.37296648642 = 12.1024829
  optimizer.step(theta, g, 0.1);
  CHECK(theta[0] == Approx(-0.45098673 - 1.21024829).margin(1e-6));
}

TEST_CASE("rmsprop: a constant gradient ends in steps of rate / (1 - momentum)", "[optim]") {
  RmsProp<double> optimizer(2);
  Eigen::VectorXd theta = Eigen::VectorXd::Zero(2), before;
  const Eigen::Vector2d g(1e-3, -50);  // the size of a gradient does not matter
  for (int i = 0; i < 3000; ++i) {
    before = theta;
    optimizer.step(theta, g, 1e-3);
  }
  CHECK(theta[0] - before[0] == Approx(-1e-2).epsilon(1e-4));
  CHECK(theta[1] - before[1] == Approx(1e-2).epsilon(1e-4));
}

TEMPLATE_TEST_CASE("rmsprop: an ill-conditioned quadratic is minimised with a falling rate", "[optim]", float, double) {
  using Vector = Eigen::VectorX<TestType>;
  RmsProp<TestType> optimizer(3);
  const Vector curvature = Eigen::Vector3d(1, 100, 10000).cast<TestType>();
  const Vector minimum = Eigen::Vector3d(1, -2, 0.5).cast<TestType>();
  Vector theta = Vector::Zero(3);
  const int steps = 2000;
  for (int i = 0; i < steps; ++i) {
    const Vector g = curvature.cwiseProduct(theta - minimum);
    optimizer.step(theta, g, 1e-2 * (1 + std::cos(3.14159265 * i / steps)) / 2);
  }
  CHECK((theta - minimum).norm() == Approx(0).margin(1e-4));
}

TEST_CASE("rmsprop: a gradient of another length is refused", "[optim]") {
  RmsProp<double> optimizer(3);
  Eigen::VectorXd theta = Eigen::VectorXd::Zero(3), g = Eigen::VectorXd::Zero(2);
  CHECK_THROWS_AS(optimizer.step(theta, g, 1), InvalidArgument);
}

}  // namespace rmsprop_test
