#include "catch.hpp"

#include <dsns/autodiff/dual.hpp>
#include <dsns/autodiff/jet2.hpp>
#include <dsns/autodiff/tape.hpp>

#include <algorithm>
#include <cmath>

namespace binary_functions_test {

using namespace dsns;

namespace {

/// All first and second derivatives of a function of two variables.
struct Derivatives2 {
  double f, fx, fy, fxx, fxy, fyy;
};

template <class Function>
void check_binary(const Function& function, double x, double y, const Derivatives2& expected) {
  INFO("at " << x << ", " << y);
  const auto close = [](double found, double wanted) {
    CHECK(std::abs(found - wanted) <= 1e-13 * std::max(1.0, std::abs(wanted)));
  };
  using J = Jet2<double, 2>;
  const J jet = function(J::variable(x, 0), J::variable(y, 1));
  close(jet.f, expected.f);
  close(jet.g[0], expected.fx);
  close(jet.g[1], expected.fy);
  close(jet.h[0], expected.fxx);
  close(jet.h[1], expected.fxy);
  close(jet.h[2], expected.fyy);

  using D = Dual<Dual<double, 2>, 2>;
  const D nested =
      function(D::variable(Dual<double, 2>::variable(x, 0), 0), D::variable(Dual<double, 2>::variable(y, 1), 1));
  close(nested.g[0].g[0], expected.fxx);
  close(nested.g[0].g[1], expected.fxy);
  close(nested.g[1].g[0], expected.fxy);
  close(nested.g[1].g[1], expected.fyy);

  const J left = function(J::variable(x, 0), y), right = function(x, J::variable(y, 1));  // one argument passive
  close(left.f, expected.f);
  close(left.g[0], expected.fx);
  close(left.g[1], 0);
  close(left.h[0], expected.fxx);
  close(right.g[0], 0);
  close(right.g[1], expected.fy);
  close(right.h[2], expected.fyy);

  Tape<double> tape;
  const auto recording = tape.record();
  const auto u = tape.variable(x), v = tape.variable(y);
  tape.backward(function(u, v));
  close(tape.adjoint(u), expected.fx);
  close(tape.adjoint(v), expected.fy);
  tape.backward(function(u, y));
  close(tape.adjoint(u), expected.fx);
  tape.backward(function(x, v));
  close(tape.adjoint(v), expected.fy);
}

}  // namespace

TEST_CASE("functions: pow in all active and passive combinations", "[autodiff]") {
  const auto function = [](const auto& x, const auto& y) {
    using std::pow;
    return pow(x, y);
  };
  for (const double x : {0.3, 1.0, 2.5})
    for (const double y : {-1.5, 0.0, 0.5, 1.0, 2.0, 3.25}) {
      const double f = std::pow(x, y), l = std::log(x);
      check_binary(function, x, y, {f, y * f / x, f * l, y * (y - 1) * f / (x * x), f / x * (1 + y * l), f * l * l});
    }
  const auto power = pow(Jet2<double, 1>::variable(-2, 0), 3);
  CHECK(power.f == -8);
  CHECK(power.g[0] == 12);
  CHECK(power.h[0] == -12);
}

TEST_CASE("functions: hypot and atan2 in all four quadrants", "[autodiff]") {
  const auto length = [](const auto& x, const auto& y) {
    using std::hypot;
    return hypot(x, y);
  };
  const auto angle = [](const auto& y, const auto& x) {
    using std::atan2;
    return atan2(y, x);
  };
  for (const double x : {-2.0, 0.0, 0.5})
    for (const double y : {-1.5, 0.75}) {
      const double r = std::hypot(x, y), r2 = r * r, r3 = r * r * r;
      check_binary(length, x, y, {r, x / r, y / r, y * y / r3, -x * y / r3, x * x / r3});
      check_binary(angle, y, x,
                   {std::atan2(y, x), x / r2, -y / r2, -2 * x * y / (r2 * r2), (y * y - x * x) / (r2 * r2),
                    2 * x * y / (r2 * r2)});
    }
  const double huge = 1e200;  // x^2 overflows
  CHECK(hypot(Dual<double>::variable(3 * huge, 0), 4 * huge).g[0] == Approx(0.6));
  CHECK(atan2(Dual<double>::variable(3 * huge, 0), 4 * huge).g[0] * huge == Approx(0.16));
}

TEST_CASE("functions: an active exponent nested at zero keeps its derivative", "[autodiff]") {
  // d/dp of d/dx x^p is x^(p - 1) (1 + p log x): 1 / x at p = 0, although d/dx x^0 = 0.
  using D = Dual<double, 1>;
  const auto y = pow(Dual<D, 1>::variable(2.0, 0), D::variable(0, 0));
  CHECK(y.g[0].f == 0);
  CHECK(y.g[0].g[0] == Approx(0.5));
}

}  // namespace binary_functions_test
