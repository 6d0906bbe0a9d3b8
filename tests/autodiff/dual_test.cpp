#include "catch.hpp"

#include <dsns/autodiff/dual.hpp>
#include <dsns/autodiff/jet2.hpp>

#include <random>
#include <string>
#include <type_traits>

namespace dual_test {

using namespace dsns;

static_assert(std::is_trivially_default_constructible_v<Dual<double, 3>>, "arrays of duals cost nothing to make");
static_assert(std::is_trivially_copyable_v<Jet2<Dual<float, 2>, 2>>);
static_assert(PassiveFor<int, Dual<double>> && PassiveFor<Dual<double>, Dual<Dual<double>>>);
static_assert(!PassiveFor<Dual<double>, Dual<double>> && !PassiveFor<Dual<Dual<double>>, Dual<double>>);
static_assert(!std::is_constructible_v<Dual<double>, std::string>);
static_assert(!std::is_convertible_v<Dual<double>, double>, "derivatives are not dropped silently");
static_assert(std::is_same_v<Passive<Dual<Jet2<float>>>, float>);

TEST_CASE("dual: arithmetic with constants of every kind on either side", "[autodiff]") {
  using D = Dual<double, 2>;
  const D x = D::variable(3, 0), y = D::variable(2, 1);
  const D r = (x * y + 1 - 2.0f * x) / (y - 0.5) - 4 / x + -y * 2 + x / 4;
  CHECK(r.f == Approx(1.0 / 1.5 - 4.0 / 3 - 4 + 0.75));
  CHECK(r.g[0] == Approx(0.0 / 1.5 + 4.0 / 9 + 0.25));
  CHECK(r.g[1] == Approx(3 / 1.5 - 1.0 / (1.5 * 1.5) - 2));

  D s = x;
  s += y;
  s *= s;  // an operand that is its own result
  s -= 1;
  s /= y;
  CHECK(s.f == 12);
  CHECK(s.g[0] == 5);
  CHECK(s.g[1] == Approx(5.0 - 6));
}

TEST_CASE("dual: comparisons see values only", "[autodiff]") {
  using D = Dual<double, 1>;
  const D a = D::variable(1, 0), b(1.0);
  CHECK(a == b);
  CHECK(a <= b);
  CHECK_FALSE(a < b);
  CHECK(a != 2);
  CHECK(0.5 < a);
  CHECK(a > -1);
}

TEST_CASE("dual: nested perturbations are not confused", "[autodiff]") {
  // d/dx of x d/dy (x + y) is 1; a shared perturbation would give 2.
  using D = Dual<double, 1>;
  const D x = D::variable(1, 0);
  const auto inner = [&](const D& at) {
    const auto y = Dual<D, 1>::variable(at, 0);
    return (x + y).g[0];
  };
  const D outer = x * inner(x);
  CHECK(outer.f == 1);
  CHECK(outer.g[0] == 1);
}

TEST_CASE("jet2: the quotient has the second derivatives of its closed form", "[autodiff]") {
  using J = Jet2<double, 2>;
  const double u = 0.7, v = 1.3;
  const J q = J::variable(u, 0) / J::variable(v, 1);
  CHECK(q.f == Approx(u / v));
  CHECK(q.g[0] == Approx(1 / v));
  CHECK(q.g[1] == Approx(-u / (v * v)));
  CHECK(std::abs(q.hessian(0, 0)) < 1e-16);
  CHECK(q.hessian(0, 1) == Approx(-1 / (v * v)));
  CHECK(q.hessian(1, 0) == q.hessian(0, 1));
  CHECK(q.hessian(1, 1) == Approx(2 * u / (v * v * v)));
}

TEST_CASE("jet2: packed index of three variables", "[autodiff]") {
  using J = Jet2<double, 3>;
  const J x = J::variable(1, 0), y = J::variable(2, 1), z = J::variable(3, 2);
  const J p = 2 * x * x + 3 * x * y + 5 * x * z + 7 * y * y + 11 * y * z + 13 * z * z;
  const double expected[3][3] = {{4, 3, 5}, {3, 14, 11}, {5, 11, 26}};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) CHECK(p.hessian(i, j) == expected[i][j]);
}

namespace {

/// A random straight-line program over sums, products, quotients and functions; intermediates are shared, overwritten.
template <class T>
T random_program(std::uint32_t seed, const T& x, const T& y) {
  using std::atan, std::exp, std::sin, std::sqrt;
  std::mt19937 random(seed);
  T r[4] = {x, y, x * y, T(1.5)};
  for (int step = 0; step < 25; ++step) {
    T& a = r[random() % 4];
    const T b = r[random() % 4];
    switch (random() % 8) {
      case 0:
        a += b;
        break;
      case 1:
        a = sin(a) * b;
        break;
      case 2:
        a = a / (1 + b * b);
        break;
      case 3:
        a -= 0.5 * b;
        break;
      case 4:
        a = sqrt(1 + a * a);
        break;
      case 5:
        a = exp(-(a * a)) + b;
        break;
      case 6:
        a *= atan(a);
        break;
      default:
        a = softplus(a) - sigmoid(b);
        break;
    }
  }
  return r[0] + r[1] * r[2] - r[3];
}

}  // namespace

TEST_CASE("jet2 and nested duals agree on random programs, and with central differences", "[autodiff]") {
  using J = Jet2<double, 2>;
  using D = Dual<double, 2>;
  using DD = Dual<D, 2>;
  const double x = 0.8, y = -0.6;
  for (std::uint32_t seed = 0; seed < 200; ++seed) {
    INFO("seed " << seed);
    const J j = random_program(seed, J::variable(x, 0), J::variable(y, 1));
    const DD d = random_program(seed, DD::variable(D::variable(x, 0), 0), DD::variable(D::variable(y, 1), 1));
    const double scale = std::max({1.0, std::abs(j.f), std::abs(j.h[0]), std::abs(j.h[1]), std::abs(j.h[2])});
    CHECK(std::abs(j.f - d.f.f) <= 1e-13 * scale);
    CHECK(std::abs(j.g[0] - d.g[0].f) <= 1e-12 * scale);
    CHECK(std::abs(j.h[0] - d.g[0].g[0]) <= 1e-11 * scale);
    CHECK(std::abs(j.h[1] - d.g[1].g[0]) <= 1e-11 * scale);
    CHECK(std::abs(j.h[2] - d.g[1].g[1]) <= 1e-11 * scale);
    const double h = 1e-6;
    const double difference = (random_program(seed, x + h, y) - random_program(seed, x - h, y)) / (2 * h);
    CHECK(std::abs(j.g[0] - difference) <= 1e-6 * scale);
  }
}

}  // namespace dual_test
