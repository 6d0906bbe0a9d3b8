#include "catch.hpp"

#include <dsns/autodiff/dual.hpp>
#include <dsns/autodiff/jet2.hpp>
#include <dsns/autodiff/tape.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

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

TEST_CASE("functions: remainders, signs and differences", "[autodiff]") {
  const auto floating = [](const auto& x, const auto& y) {
    using std::fmod;
    return fmod(x, y);
  };
  const auto nearest = [](const auto& x, const auto& y) {
    using std::remainder;
    return remainder(x, y);
  };
  for (const double x : {7.3, -7.3, 0.4})
    for (const double y : {2.0, -2.0, 0.7}) {
      check_binary(floating, x, y, {std::fmod(x, y), 1, -std::trunc(x / y), 0, 0, 0});
      check_binary(nearest, x, y, {std::remainder(x, y), 1, -std::nearbyint(x / y), 0, 0, 0});
    }
  const auto signed_as = [](const auto& x, const auto& y) {
    using std::copysign;
    return copysign(x, y);
  };
  for (const double x : {3.0, -3.0})
    for (const double y : {2.0, -0.0})
      check_binary(signed_as, x, y, {std::copysign(x, y), std::copysign(1.0, x) * std::copysign(1.0, y), 0, 0, 0, 0});
  check_binary(signed_as, 0.0, -1.0, {0, 0, 0, 0, 0, 0});
  const auto difference = [](const auto& x, const auto& y) {
    using std::fdim;
    return fdim(x, y);
  };
  check_binary(difference, 3, 2, {1, 1, -1, 0, 0, 0});
  check_binary(difference, 2, 3, {0, 0, 0, 0, 0, 0});
  check_binary(difference, 2, 2, {0, 0, 0, 0, 0, 0});
  CHECK(isnan(difference(Jet2<double, 1>(1.0), Jet2<double, 1>(std::nan("")))));
}

TEST_CASE("functions: x y + z rounded once, and the length of three numbers", "[autodiff]") {
  // In two of three arguments at a time, the third a constant.
  const double x = 0.3, y = -1.7, z = 0.9;
  const auto fused = [](const auto& a, const auto& b, const auto& c) {
    using std::fma;
    return fma(a, b, c);
  };
  const auto length = [](const auto& a, const auto& b, const auto& c) {
    using std::hypot;
    return hypot(a, b, c);
  };
  const double r = std::hypot(x, y, z), r3 = r * r * r;
  using J = Jet2<double, 3>;
  const auto check = [](const J& found, const std::array<double, 10>& expected) {
    CHECK(found.f == Approx(expected[0]).epsilon(1e-15));
    for (std::size_t k = 0; k < 3; ++k) CHECK(found.g[k] == Approx(expected[1 + k]).epsilon(1e-14).margin(1e-16));
    for (std::size_t k = 0; k < 6; ++k) CHECK(found.h[k] == Approx(expected[4 + k]).epsilon(1e-14).margin(1e-16));
  };
  const auto jets = [](const auto& f, double a, double b, double c) {
    return f(J::variable(a, 0), J::variable(b, 1), J::variable(c, 2));
  };
  check(jets(fused, x, y, z), {std::fma(x, y, z), y, x, 1, 0, 1, 0, 0, 0, 0});
  check(jets(length, x, y, z), {r, x / r, y / r, z / r, (r * r - x * x) / r3, -x * y / r3, -x * z / r3,
                                (r * r - y * y) / r3, -y * z / r3, (r * r - z * z) / r3});
  check(jets(length, 0, 0, -2), {2, 0, 0, -1, 0.5, 0, 0, 0.5, 0, 0});
  check(jets(length, 0, 0, 0), {});
  CHECK(fused(Jet2<double, 1>(1 + 1e-9), Jet2<double, 1>(1 - 1e-9), Jet2<double, 1>(-1.0)).f ==
        std::fma(1 + 1e-9, 1 - 1e-9, -1.0));
  CHECK(jets(length, 3e200, 0, 4e200).g[2] == Approx(0.8));
  CHECK(jets(length, 3e-200, 0, 4e-200).g[2] == Approx(0.8));
  const J far = jets(length, 1, -std::numeric_limits<double>::infinity(), 2);
  CHECK((isinf(far) && far.g[0] == 0 && far.g[1] == -1 && far.g[2] == 0));

  const J one = length(J::variable(x, 0), y, z), two = fused(2, J::variable(y, 1), J::variable(z, 2));
  CHECK((one.f == r && one.g[0] == Approx(x / r) && one.g[1] == 0));
  CHECK((two.f == 2 * y + z && two.g[1] == 2 && two.g[2] == 1));
  CHECK(fused(1, x, Dual<Dual<double>>(z)).f.f == Approx(x + z));
  CHECK(length(Dual<double>(x), y, Dual<Dual<double>>(z)).f.f == r);

  Tape<double> tape;
  const auto recording = tape.record();
  const auto a = tape.variable(x), b = tape.variable(y), c = tape.variable(z);
  tape.backward(length(a, b, c) + fused(a, b, c));
  CHECK(tape.adjoint(a) == Approx(x / r + y));
  CHECK(tape.adjoint(b) == Approx(y / r + x));
  CHECK(tape.adjoint(c) == Approx(z / r + 1));
  const auto zero = tape.variable(0);
  tape.backward(length(zero, zero, zero));
  CHECK(tape.adjoint(zero) == 0);
}

TEST_CASE("functions: an active exponent nested at zero keeps its derivative", "[autodiff]") {
  // d/dp of d/dx x^p is x^(p - 1) (1 + p log x): 1 / x at p = 0, although d/dx x^0 = 0.
  using D = Dual<double, 1>;
  const auto y = pow(Dual<D, 1>::variable(2.0, 0), D::variable(0, 0));
  CHECK(y.g[0].f == 0);
  CHECK(y.g[0].g[0] == Approx(0.5));
}

}  // namespace binary_functions_test
