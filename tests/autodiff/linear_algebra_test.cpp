#include "catch.hpp"

#include <dsns/autodiff/gradient.hpp>
#include <dsns/autodiff/linear_algebra.hpp>

#include <cmath>
#include <limits>

namespace linear_algebra_test {

using namespace dsns;

namespace {

/// A 3 x 3 matrix that depends on two numbers.
template <class X>
Eigen::Matrix3<X> matrix(const X& u, const X& v) {
  Eigen::Matrix3<X> m;
  m << 2 + u * u, sin(v), u - 1, v * u, 3 + cos(u), exp(0.3 * v), X(0.5), u * v, 1 + v * v;
  return m;
}
template <class X>
Eigen::Vector3<X> vector(const X& u, const X& v) {
  return {u + v, X(exp(u)), u * v - 2};
}

// By cofactors, for any scalar without a decomposition.
template <class X>
Eigen::Matrix3<X> cofactor_inverse(const Eigen::Matrix3<X>& m) {
  Eigen::Matrix3<X> c;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      c(j, i) = m((i + 1) % 3, (j + 1) % 3) * m((i + 2) % 3, (j + 2) % 3) -
                m((i + 1) % 3, (j + 2) % 3) * m((i + 2) % 3, (j + 1) % 3);
  return c / X(m(0, 0) * c(0, 0) + m(0, 1) * c(1, 0) + m(0, 2) * c(2, 0));
}

double distance(const Jet2<double>& a, const Jet2<double>& b) {
  double d = std::abs(a.f - b.f);
  for (std::size_t k = 0; k < 2; ++k) d = std::max(d, std::abs(a.g[k] - b.g[k]));
  for (std::size_t k = 0; k < 3; ++k) d = std::max(d, std::abs(a.h[k] - b.h[k]));
  return d;
}

const auto weights = [](auto x) { return x(0) * 0.3 + x(1) * x(1) - x(2) * x(0); };

}  // namespace

TEST_CASE("solve, inverse: second-order jets against cofactors", "[autodiff]") {
  using J = Jet2<double>;
  const J u = J::variable(0.7, 0), v = J::variable(-0.4, 1);
  const Eigen::Matrix3<J> a = matrix(u, v), expected = cofactor_inverse(a), found = inverse(a);
  const Eigen::Vector3<J> b = vector(u, v), x = solve(a, b), expected_x = expected * b;
  for (int k = 0; k < 9; ++k) CHECK(distance(found.reshaped()[k], expected.reshaped()[k]) < 1e-12);
  for (int k = 0; k < 3; ++k) CHECK(distance(x[k], expected_x[k]) < 1e-12);
}

TEST_CASE("solve: a zero entry that carries a derivative counts", "[autodiff]") {
  using D = Dual<double, 1>;
  Eigen::Matrix2<D> a;
  a << D(1), D::variable(0, 0), D(0), D(2);
  const Eigen::Vector2<D> x = solve(a, Eigen::Vector2<D>(D(1), D(4)));
  CHECK((x[0].f == 1 && x[1].f == 2));
  CHECK(x[0].g[0] == Approx(-2));
  CHECK(x[1].g[0] == Approx(0).margin(1e-15));
}

TEST_CASE("solve, symmetric eigen: reverse and forward mode agree, and reverse over forward", "[autodiff]") {
  const double u = 0.7, v = -0.4;
  const auto by_solve = [](const auto& s, const auto& t) { return weights(solve(matrix(s, t), vector(s, t))); };
  const auto by_eigen = [](const auto& s, const auto& t) {
    const auto m = matrix(s, t);
    using M = std::decay_t<decltype(m)>;
    const auto e = symmetric_eigen(M(m.transpose() * m));
    // no sign of a vector matters
    return weights(e.values) + e.values[1] * e.vectors(0, 1) * e.vectors(2, 1) + e.vectors(1, 0) * e.vectors(1, 0);
  };
  const auto check = [&](const auto& f) {
    const auto jet = jet2(f, u, v);
    const auto g = gradient(f, wrt(u, v), at(u, v));
    const auto h = hessian(f, wrt(u, v), at(u, v));
    CHECK(g[0] == Approx(jet.g[0]).epsilon(1e-11));
    CHECK(g[1] == Approx(jet.g[1]).epsilon(1e-11));
    CHECK(h(0, 0) == Approx(jet.h[0]).epsilon(1e-10));
    CHECK(h(0, 1) == Approx(jet.h[1]).epsilon(1e-10));
    CHECK(h(1, 1) == Approx(jet.h[2]).epsilon(1e-10));
    const double step = 1e-5;
    CHECK(jet.g[0] == Approx((jet2(f, u + step, v).f - jet2(f, u - step, v).f) / (2 * step)).epsilon(1e-7));
    CHECK(jet.h[1] == Approx((jet2(f, u, v + step).g[0] - jet2(f, u, v - step).g[0]) / (2 * step)).epsilon(1e-6));
  };
  check(by_solve);
  check(by_eigen);
}

TEST_CASE("symmetric eigen: eigenvalues of a rotated diagonal, and vectors at equal eigenvalues", "[autodiff]") {
  using D = Dual<double, 1>;
  const D a = D::variable(0.3, 0);
  Eigen::Matrix2<D> r;
  r << cos(a), -sin(a), sin(a), cos(a);
  const auto rotated =
      symmetric_eigen(Eigen::Matrix2<D>(r * Eigen::Vector2<D>(D(1), D(4)).asDiagonal() * r.transpose()));
  CHECK((std::abs(rotated.values[0].f - 1) < 1e-14 && std::abs(rotated.values[1].f - 4) < 1e-14));
  CHECK((std::abs(rotated.values[0].g[0]) < 1e-14 && std::abs(rotated.values[1].g[0]) < 1e-14));
  const D angle = atan2(rotated.vectors(1, 0), rotated.vectors(0, 0));
  CHECK(angle.g[0] == Approx(1).epsilon(1e-13));

  Eigen::Matrix2<D> umbilic;
  umbilic << D(2) + a - a.f, D(0), D(0), D(2);
  const auto equal = symmetric_eigen(umbilic);
  CHECK(equal.values[0].g[0] + equal.values[1].g[0] == Approx(1));
  for (const D& x : equal.vectors.reshaped()) CHECK((std::isfinite(x.f) && x.g[0] == 0));
}

TEST_CASE("norm: derivatives, zero, and sizes beyond squares", "[autodiff]") {
  using J = Jet2<double>;
  const Eigen::Vector3<J> v(J::variable(0, 0), J::variable(0, 1), J(3));
  const J n = norm(v);
  CHECK((n.f == 3 && n.g[0] == 0 && n.g[1] == 0));
  CHECK(n.h[0] == Approx(1.0 / 3));
  CHECK(n.h[2] == Approx(1.0 / 3));
  const J zero = norm(Eigen::Vector2<J>(J::variable(0, 0), J::variable(0, 1)));
  CHECK((zero.f == 0 && zero.g[0] == 0 && zero.h[0] == 0));
  using D = Dual<double, 1>;
  const D huge = norm(Eigen::Vector2<D>(D::variable(3e200, 0), D(4e200)));
  CHECK(huge.f == Approx(5e200));
  CHECK(huge.g[0] == Approx(0.6));
}

TEST_CASE("linear algebra: sizes that do not fit are named", "[autodiff]") {
  using D = Dual<double, 1>;
  const Eigen::MatrixX<D> a = Eigen::MatrixX<D>::Identity(3, 3), wide = Eigen::MatrixX<D>::Constant(2, 3, D(1));
  CHECK_THROWS_AS(solve(a, Eigen::VectorX<D>(Eigen::VectorX<D>::Constant(2, D(1)))), InvalidArgument);
  CHECK_THROWS_AS(solve(wide, Eigen::VectorX<D>(Eigen::VectorX<D>::Constant(2, D(1)))), InvalidArgument);
  CHECK_THROWS_AS(symmetric_eigen(wide), InvalidArgument);
}

}  // namespace linear_algebra_test
