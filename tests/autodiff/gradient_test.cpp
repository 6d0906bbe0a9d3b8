#include "catch.hpp"

#include <dsns/autodiff/gradient.hpp>

#include <Eigen/Dense>

namespace gradient_test {

using namespace dsns;

namespace {

const auto rosenbrock = [](const auto& x) {
  auto sum = sqr(1 - x[0]);
  for (Eigen::Index i = 0; i + 1 < x.size(); ++i) {
    sum += 100 * sqr(x[i + 1] - x[i] * x[i]);
    if (i > 0) sum += sqr(1 - x[i]);
  }
  return sum;
};

}  // namespace

TEST_CASE("gradient: Rosenbrock's function against its closed form", "[autodiff]") {
  Eigen::VectorXd x(6);
  x << 0.3, -0.7, 1.2, 0.9, -0.2, 0.5;
  Eigen::VectorXd expected = Eigen::VectorXd::Zero(6);
  double value = 0;
  for (Eigen::Index i = 0; i < 5; ++i) {
    const double gap = x[i + 1] - x[i] * x[i];
    value += 100 * gap * gap + (1 - x[i]) * (1 - x[i]);
    expected[i] += -400 * x[i] * gap - 2 * (1 - x[i]);
    expected[i + 1] += 200 * gap;
  }
  const auto result = value_and_gradient(rosenbrock, wrt(x), at(x));
  CHECK(result.value == Approx(value));
  CHECK((result.gradient - expected).norm() < 1e-12 * expected.norm());
  CHECK(gradient(rosenbrock, wrt(x), at(x)) == result.gradient);
}

TEST_CASE("gradient: chosen arguments, in the order of wrt, others passive", "[autodiff]") {
  const Eigen::Vector2d x(2, 3);
  const double a = 5;
  const Eigen::Matrix2d m = (Eigen::Matrix2d() << 1, 2, 3, 4).finished();
  const auto f = [](const auto& p, const auto& c, const auto& w) { return c * p.dot(w * p); };
  const double q = x.dot(m * x);
  const Eigen::Vector2d dx = a * (m + m.transpose()) * x;

  CHECK(gradient(f, wrt(x), at(x, a, m)).isApprox(dx, 1e-15));
  const Eigen::VectorXd both = gradient(f, wrt(a, x), at(x, a, m));
  CHECK(both.size() == 3);
  CHECK(both[0] == Approx(q));
  CHECK(both.tail(2).isApprox(dx, 1e-15));
  const Eigen::VectorXd of_matrix = gradient(f, wrt(m), at(x, a, m));
  const Eigen::Matrix2d dm = a * x * x.transpose();
  CHECK(of_matrix.isApprox(dm.reshaped(), 1e-15));

  const double b = 7;
  CHECK(gradient([](const auto& u, const auto& v) { return u * v; }, wrt(b), at(a, b))[0] == 5);
}

TEST_CASE("gradient: an object that is not among the arguments is refused", "[autodiff]") {
  const double x = 1, copy = x;
  CHECK_THROWS_AS(gradient([](const auto& y) { return sin(y); }, wrt(copy), at(x)), InvalidArgument);
}

TEST_CASE("jacobian: a linear map returned as an unevaluated expression", "[autodiff]") {
  Eigen::MatrixXd A(4, 3);
  A << 1, 2, 3, 4, 5, 6, 7, 8, 10, -1, 0, 2;
  const Eigen::Vector3d x(0.5, -1, 2);
  CHECK(jacobian([&](const auto& v) { return A * v; }, wrt(x), at(x)) == A);

  const auto polar = [](const auto& p) {
    using V = std::decay_t<decltype(p[0])>;
    return Eigen::Matrix<V, 2, 1>(p[0] * cos(p[1]), p[0] * sin(p[1]));
  };
  const Eigen::Vector2d p(2, 0.5);
  const Eigen::MatrixXd J = jacobian(polar, wrt(p), at(p));
  CHECK(J.determinant() == Approx(2));
  CHECK(J(0, 1) == Approx(-2 * std::sin(0.5)));
}

TEST_CASE("hessian: Rosenbrock's function against its closed form", "[autodiff]") {
  const Eigen::Vector2d x(0.3, -0.7);
  const Eigen::MatrixXd H = hessian(rosenbrock, wrt(x), at(x));
  CHECK(H(0, 0) == Approx(1200 * 0.09 - 400 * -0.7 + 2));
  CHECK(H(0, 1) == Approx(-120));
  CHECK(H(1, 0) == Approx(-120));
  CHECK(H(1, 1) == Approx(200));
}

TEST_CASE("jvp, vjp: products with the Jacobian, without forming it", "[autodiff]") {
  const auto f = [](const auto& v, const auto& a) {
    using V = std::decay_t<decltype(v[0] * a)>;
    return Eigen::Matrix<V, 3, 1>(a * v[0] * v[1], sin(v[1]), v[0] / (1 + a * a));
  };
  const Eigen::Vector2d x(0.5, -1);
  const double a = 2;
  const Eigen::MatrixXd J = jacobian(f, wrt(x, a), at(x, a));
  const Eigen::Vector3d direction(0.3, -0.2, 0.7), weights(1, -2, 0.5);
  const auto along = jvp(f, wrt(x, a), at(x, a), direction);
  CHECK(along.value.isApprox(Eigen::Vector3d(-1, std::sin(-1), 0.1), 1e-15));
  CHECK(along.derivative.isApprox(J * direction, 1e-14));
  CHECK(vjp(f, wrt(x, a), at(x, a), weights).isApprox(J.transpose() * weights, 1e-14));
  CHECK(jvp([](const auto& v) { return v.squaredNorm(); }, wrt(x), at(x), Eigen::Vector2d(1, 1)).derivative == -1);
  const Eigen::VectorXd two = x;
  CHECK_THROWS_AS(jvp(f, wrt(x, a), at(x, a), two), InvalidArgument);
  CHECK_THROWS_AS(vjp(f, wrt(x, a), at(x, a), two), InvalidArgument);
}

TEST_CASE("hvp, jet2: second derivatives along a direction and in two numbers", "[autodiff]") {
  Eigen::VectorXd x(6), d(6);
  x << 0.3, -0.7, 1.2, 0.9, -0.2, 0.5;
  d << 1, 0.5, -2, 0, 0.3, -1;
  const Eigen::MatrixXd H = hessian(rosenbrock, wrt(x), at(x));
  CHECK(hvp(rosenbrock, wrt(x), at(x), d).isApprox(H * d, 1e-13));
  CHECK_THROWS_AS(hvp(rosenbrock, wrt(x), at(x), Eigen::VectorXd(d.head(2))), InvalidArgument);
  const auto jet = jet2([](const auto& u, const auto& v) { return u * u * v; }, 3.0, 5.0);
  CHECK((jet.f == 45 && jet.g[0] == 30 && jet.g[1] == 9 && jet.h[0] == 10 && jet.h[1] == 6 && jet.h[2] == 0));
}

}  // namespace gradient_test
