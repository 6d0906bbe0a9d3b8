#include "catch.hpp"

#include <dsns/autodiff/eigen.hpp>
#include <dsns/autodiff/tape.hpp>

#include <Eigen/Dense>

namespace eigen_test {

using namespace dsns;

TEMPLATE_TEST_CASE("eigen: products, norms and mixed expressions of every scalar", "[autodiff]", (Dual<double, 2>),
                   (Jet2<double, 2>), (Dual<Dual<double, 2>, 2>), (Jet2<Dual<float, 1>, 2>)) {
  using X = TestType;
  using V3 = Eigen::Matrix<X, 3, 1>;
  using Number = Passive<X>;
  const Eigen::Matrix<Number, 3, 3> R = (Eigen::Matrix<Number, 3, 3>() << 0, -1, 0, 1, 0, 0, 0, 0, 1).finished();
  const Eigen::Matrix<Number, 3, 1> p(1, 2, 3);
  // a(u) = p + u q at u = 0 in direction 0
  V3 a;
  const Number q[3] = {2, 0, 1};
  for (int k = 0; k < 3; ++k) a[k] = X(p[k]) + q[k] * X::variable(0, 0);

  const V3 b = R * a * Number(2) + p.cross(p) + 3 * a - a / Number(2);
  CHECK(value(b[0]) == Approx(-4 + 2.5));
  CHECK(value(X(b[0]).g[0]) == Approx(0 + 5));
  CHECK(value(X(b[1]).g[0]) == Approx(4));

  CHECK(value(X(a.squaredNorm()).g[0]) == Approx(10));  // 2 p . q
  CHECK(value(X(a.norm()).g[0]) == Approx(5 / std::sqrt(14.0)));
  CHECK(value(X(p.dot(a)).g[0]) == Approx(5));
  CHECK(value(X(a.cross(b).dot(a))) == Approx(0).margin(1e-5));
  CHECK(value(X((R * (a * a.transpose())).trace()).g[0]) ==
        Approx(6.0));  // d/du a_2^2 = 2 p_2 q_2, off-diagonals cancel
  const V3 unit = a.normalized();
  CHECK(value(X(unit.squaredNorm())) == Approx(1));
  CHECK(value(X(unit.squaredNorm()).g[0]) == Approx(0).margin(1e-6));
  CHECK(a.array().exp()[0].g[0] == exp(a[0]).g[0]);
}

TEST_CASE("eigen: an entry that is zero but carries a derivative is not skipped", "[autodiff]") {
  using D = Dual<double, 1>;
  Eigen::Matrix<D, 2, 2> m;
  m << D::variable(0, 0), D(1), D(0), D(1);
  const Eigen::Matrix<D, 2, 2> square = m * m;
  CHECK(square(0, 1).g[0] == 1);
  CHECK((square(0, 0).f == 0 && square(0, 0).g[0] == 0));
  CHECK(m.determinant().g[0] == 1);
  CHECK(m.norm().g[0] == 0);
}

TEST_CASE("eigen: reverse mode through matrix products", "[autodiff]") {
  using V = Var<double>;
  Tape<double> tape;
  const auto recording = tape.record();
  const Eigen::MatrixXd A = (Eigen::MatrixXd(3, 3) << 2, 1, 0, 1, 3, 1, 0, 1, 4).finished();
  Eigen::VectorX<V> x(3);
  for (int k = 0; k < 3; ++k) x[k] = tape.variable(k + 1);
  const V y = x.dot(A * x) / 2;
  tape.backward(y);
  const Eigen::Vector3d expected = A * Eigen::Vector3d(1, 2, 3);
  for (int k = 0; k < 3; ++k) CHECK(tape.adjoint(x[k]) == expected[k]);
}

}  // namespace eigen_test
