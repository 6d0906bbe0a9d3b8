#include "catch.hpp"

#include <dsns/autodiff/dual.hpp>
#include <dsns/autodiff/jet2.hpp>
#include <dsns/autodiff/tape.hpp>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

namespace functions_test {

using namespace dsns;

namespace {

using Long = long double;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// Value, derivative and second derivative of a function of one variable.
struct Derivatives {
  Long f, d, d2;
};

template <class T>
constexpr Long ulps() {
  return 64 * static_cast<Long>(std::numeric_limits<T>::epsilon());
}

template <class T>
void check_close(T found, Long expected, Long scale, Long tolerance) {
  const Long error = std::abs(static_cast<Long>(found) - expected);
  CHECK(double(error) <= double(tolerance * std::max(std::abs(expected), scale)));
}

/// Every way of differentiating `function` at x against the closed forms; `scale` is the size that rounding refers to.
template <class T, class Function>
void check_modes(const Function& function, T x, const Derivatives& expected, Long scale) {
  const Long tolerance = ulps<T>();
  using D = Dual<T, 1>;
  using V = Var<T>;
  const auto first = function(D::variable(x, 0));
  check_close(first.f, expected.f, scale, tolerance);
  check_close(first.g[0], expected.d, scale, tolerance);

  const auto jet = function(Jet2<T, 1>::variable(x, 0));
  check_close(jet.f, expected.f, scale, tolerance);
  check_close(jet.g[0], expected.d, scale, tolerance);
  check_close(jet.h[0], expected.d2, scale, tolerance);

  const auto nested = function(Dual<D, 1>::variable(D::variable(x, 0), 0));
  check_close(nested.f.g[0], expected.d, scale, tolerance);
  check_close(nested.g[0].f, expected.d, scale, tolerance);
  check_close(nested.g[0].g[0], expected.d2, scale, tolerance);

  {
    Tape<T> tape;
    const auto recording = tape.record();
    const V v = tape.variable(x), y = function(v);
    tape.backward(y);
    check_close(y.f, expected.f, scale, tolerance);
    check_close(tape.adjoint(v), expected.d, scale, tolerance);
  }
  {
    Tape<D> tape;  // the tangent of the gradient
    const auto recording = tape.record();
    const auto v = tape.variable(D::variable(x, 0));
    tape.backward(function(v));
    check_close(tape.adjoint(v).f, expected.d, scale, tolerance);
    check_close(tape.adjoint(v).g[0], expected.d2, scale, tolerance);
  }
  {
    Tape<T> tape;  // the gradient of the tangent
    const auto recording = tape.record();
    const V v = tape.variable(x);
    const auto y = function(Dual<V, 1>::variable(v, 0));
    tape.backward(y.g[0]);
    check_close(y.g[0].f, expected.d, scale, tolerance);
    check_close(tape.adjoint(v), expected.d2, scale, tolerance);
  }
}

template <class Function, class Closed>
void check_unary(const std::string& name, const Function& function, const Closed& closed,
                 const std::vector<double>& points) {
  for (const double x : points) {
    INFO(name << " at " << x);
    // A float argument is exact in all three types, so that each is judged by its own rounding only.
    const float at = static_cast<float>(x);
    const Derivatives expected = closed(Long(at));
    const Long scale = std::min(Long(1), std::max({std::abs(expected.f), std::abs(expected.d), std::abs(expected.d2)}));
    check_modes(function, static_cast<double>(at), expected, scale);
    check_modes(function, Long(at), expected, scale);
    check_modes(function, at, expected, scale);
  }
}

}  // namespace

TEST_CASE("functions: exponentials and logarithms have their closed derivatives in every mode", "[autodiff]") {
  check_unary(
      "exp", [](const auto& x) { return exp(x); },
      [](Long x) {
        return Derivatives{std::exp(x), std::exp(x), std::exp(x)};
      },
      {-3, -0.5, 0, 0.7, 4});
  check_unary(
      "expm1", [](const auto& x) { return expm1(x); },
      [](Long x) {
        return Derivatives{std::expm1(x), std::exp(x), std::exp(x)};
      },
      {-3, -1e-6, 0, 1e-6, 2});
  check_unary(
      "exp2", [](const auto& x) { return exp2(x); },
      [](Long x) {
        const Long l = std::numbers::ln2_v<Long>;
        return Derivatives{std::exp2(x), l * std::exp2(x), l * l * std::exp2(x)};
      },
      {-2, 0, 1.5});
  check_unary(
      "log", [](const auto& x) { return log(x); },
      [](Long x) {
        return Derivatives{std::log(x), 1 / x, -1 / (x * x)};
      },
      {0.25, 1, 7});
  check_unary(
      "log1p", [](const auto& x) { return log1p(x); },
      [](Long x) {
        return Derivatives{std::log1p(x), 1 / (1 + x), -1 / ((1 + x) * (1 + x))};
      },
      {-0.5, 1e-6, 0, 3});
  check_unary(
      "log2", [](const auto& x) { return log2(x); },
      [](Long x) {
        const Long l = std::numbers::log2e_v<Long>;
        return Derivatives{std::log2(x), l / x, -l / (x * x)};
      },
      {0.25, 3});
  check_unary(
      "log10", [](const auto& x) { return log10(x); },
      [](Long x) {
        const Long l = std::numbers::log10e_v<Long>;
        return Derivatives{std::log10(x), l / x, -l / (x * x)};
      },
      {0.25, 3});
}

TEST_CASE("functions: trigonometric and hyperbolic functions have their closed derivatives in every mode",
          "[autodiff]") {
  const std::vector<double> points{-1.2, -0.1, 0, 0.3, 1.4};
  check_unary(
      "sin", [](const auto& x) { return sin(x); },
      [](Long x) {
        return Derivatives{std::sin(x), std::cos(x), -std::sin(x)};
      },
      points);
  check_unary(
      "cos", [](const auto& x) { return cos(x); },
      [](Long x) {
        return Derivatives{std::cos(x), -std::sin(x), -std::cos(x)};
      },
      points);
  check_unary(
      "tan", [](const auto& x) { return tan(x); },
      [](Long x) {
        const Long c = std::cos(x);
        return Derivatives{std::tan(x), 1 / (c * c), 2 * std::tan(x) / (c * c)};
      },
      {-1, 0, 0.5});
  const std::vector<double> inside{-0.75, 0, 0.5};
  check_unary(
      "asin", [](const auto& x) { return asin(x); },
      [](Long x) {
        return Derivatives{std::asin(x), 1 / std::sqrt(1 - x * x), x / std::pow(1 - x * x, 1.5L)};
      },
      inside);
  check_unary(
      "acos", [](const auto& x) { return acos(x); },
      [](Long x) {
        return Derivatives{std::acos(x), -1 / std::sqrt(1 - x * x), -x / std::pow(1 - x * x, 1.5L)};
      },
      inside);
  check_unary(
      "atan", [](const auto& x) { return atan(x); },
      [](Long x) {
        return Derivatives{std::atan(x), 1 / (1 + x * x), -2 * x / std::pow(1 + x * x, 2.0L)};
      },
      points);
  check_unary(
      "sinh", [](const auto& x) { return sinh(x); },
      [](Long x) {
        return Derivatives{std::sinh(x), std::cosh(x), std::sinh(x)};
      },
      points);
  check_unary(
      "cosh", [](const auto& x) { return cosh(x); },
      [](Long x) {
        return Derivatives{std::cosh(x), std::sinh(x), std::cosh(x)};
      },
      points);
  check_unary(
      "tanh", [](const auto& x) { return tanh(x); },
      [](Long x) {
        const Long c = std::cosh(x);
        return Derivatives{std::tanh(x), 1 / (c * c), -2 * std::tanh(x) / (c * c)};
      },
      points);
  check_unary(
      "asinh", [](const auto& x) { return asinh(x); },
      [](Long x) {
        return Derivatives{std::asinh(x), 1 / std::sqrt(1 + x * x), -x / std::pow(1 + x * x, 1.5L)};
      },
      points);
  check_unary(
      "acosh", [](const auto& x) { return acosh(x); },
      [](Long x) {
        return Derivatives{std::acosh(x), 1 / std::sqrt(x * x - 1), -x / std::pow(x * x - 1, 1.5L)};
      },
      {1.5, 4});
  check_unary(
      "atanh", [](const auto& x) { return atanh(x); },
      [](Long x) {
        return Derivatives{std::atanh(x), 1 / (1 - x * x), 2 * x / std::pow(1 - x * x, 2.0L)};
      },
      inside);
}

TEST_CASE("functions: roots, squares and the error function have their closed derivatives in every mode",
          "[autodiff]") {
  check_unary(
      "sqrt", [](const auto& x) { return sqrt(x); },
      [](Long x) {
        return Derivatives{std::sqrt(x), 0.5L / std::sqrt(x), -0.25L / std::pow(x, 1.5L)};
      },
      {0.25, 2, 9});
  check_unary(
      "cbrt", [](const auto& x) { return cbrt(x); },
      [](Long x) {
        const Long c = std::cbrt(x);
        return Derivatives{c, 1 / (3 * c * c), -2 / (9 * c * c * c * c * c)};
      },
      {-2, 0.5, 8});
  check_unary(
      "sqr", [](const auto& x) { return sqr(x); },
      [](Long x) {
        return Derivatives{x * x, 2 * x, 2};
      },
      {-2, 0, 3});
  check_unary(
      "abs", [](const auto& x) { return abs(x); },
      [](Long x) {
        return Derivatives{std::abs(x), x > 0 ? 1.0L : -1.0L, 0};
      },
      {-2, 3});
  check_unary(
      "erf", [](const auto& x) { return erf(x); },
      [](Long x) {
        const Long d = 2 / std::sqrt(std::numbers::pi_v<Long>) * std::exp(-x * x);
        return Derivatives{std::erf(x), d, -2 * x * d};
      },
      {-1, 0, 0.5, 2});
  check_unary(
      "erfc", [](const auto& x) { return erfc(x); },
      [](Long x) {
        const Long d = -2 / std::sqrt(std::numbers::pi_v<Long>) * std::exp(-x * x);
        return Derivatives{std::erfc(x), d, -2 * x * d};
      },
      {-1, 0, 0.5, 4});
  check_unary(
      "1 / x", [](const auto& x) { return 1 / x; },
      [](Long x) {
        return Derivatives{1 / x, -1 / (x * x), 2 / (x * x * x)};
      },
      {-2, 0.5});
}

TEST_CASE("functions: softplus, sigmoid and silu are exact in the tails", "[autodiff]") {
  const std::vector<double> points{-80, -30, -2, -1e-3, 0, 0.5, 3, 30, 80};
  const auto sigma = [](Long x) { return 1 / (1 + std::exp(-x)); };
  check_unary(
      "sigmoid", [](const auto& x) { return sigmoid(x); },
      [&](Long x) {
        const Long s = sigma(x), r = sigma(-x);
        return Derivatives{s, s * r, s * r * (r - s)};
      },
      points);
  check_unary(
      "softplus", [](const auto& x) { return softplus(x); },
      [&](Long x) {
        return Derivatives{x > 0 ? x + std::log1p(std::exp(-x)) : std::log1p(std::exp(x)), sigma(x),
                           sigma(x) * sigma(-x)};
      },
      points);
  check_unary(
      "silu", [](const auto& x) { return silu(x); },
      [&](Long x) {
        const Long s = sigma(x), r = sigma(-x);
        return Derivatives{x * s, s + x * s * r, s * r * (2 + x * (r - s))};
      },
      points);

  for (const double x : {-800.0, 800.0}) {
    INFO(x);
    const auto y = softplus(Jet2<double, 1>::variable(x, 0));
    CHECK(y.f == std::max(x, 0.0));
    CHECK(y.g[0] == (x > 0 ? 1.0 : 0.0));
    CHECK(y.h[0] == 0.0);
  }
}

TEST_CASE("functions: rounding has no slope", "[autodiff]") {
  const auto flat = [](const auto& rounded, const auto& standard) {
    for (const double x : {-2.5, -1.2, -0.0, 0.5, 1.5, 3.0})
      check_modes(rounded, x, Derivatives{Long(standard(x)), 0, 0}, 1);
  };
  flat([](const auto& x) { return floor(x); }, [](double x) { return std::floor(x); });
  flat([](const auto& x) { return ceil(x); }, [](double x) { return std::ceil(x); });
  flat([](const auto& x) { return trunc(x); }, [](double x) { return std::trunc(x); });
  flat([](const auto& x) { return round(x); }, [](double x) { return std::round(x); });
  flat([](const auto& x) { return rint(x); }, [](double x) { return std::rint(x); });
  flat([](const auto& x) { return nearbyint(x); }, [](double x) { return std::nearbyint(x); });
}

TEST_CASE("functions: the written conventions where there is no derivative", "[autodiff]") {
  using J = Jet2<double, 2>;
  const J x0 = J::variable(0, 0), y0 = J::variable(0, 1);
  for (const J& y : {abs(x0), hypot(x0, y0), atan2(y0, x0)}) {
    CHECK(y.f == 0);
    for (const double d : y.g) CHECK(d == 0);
    for (const double d : y.h) CHECK(d == 0);
  }
  CHECK(sqrt(x0).g[0] == infinity);
  CHECK(cbrt(x0).g[0] == infinity);

  SECTION("pow at zero") {
    const J constant = pow(x0, 0), line = pow(x0, 1), parabola = pow(x0, 2), cubic = pow(x0, 3);
    CHECK((constant.f == 1 && constant.g[0] == 0 && constant.h[0] == 0));
    CHECK((line.f == 0 && line.g[0] == 1 && line.h[0] == 0));
    CHECK((parabola.f == 0 && parabola.g[0] == 0 && parabola.h[0] == 2));
    CHECK((cubic.f == 0 && cubic.g[0] == 0 && cubic.h[0] == 0));
    const J both = pow(x0, y0), exponent = pow(0.0, y0), positive = pow(x0, J::variable(2, 1));
    CHECK((both.f == 1 && both.g[0] == 0 && both.g[1] == 0));
    CHECK((exponent.f == 1 && exponent.g[1] == 0));
    CHECK((positive.f == 0 && positive.g[0] == 0 && positive.g[1] == 0 && positive.h[0] == 2));
  }
  SECTION("pow of a negative base") {
    const J constant_exponent = pow(J::variable(-2, 0), J(2.0));
    CHECK((constant_exponent.f == 4 && constant_exponent.g[0] == -4 && constant_exponent.h[0] == 2));
    const J active_exponent = pow(J::variable(-2, 0), J::variable(2, 1));
    CHECK(active_exponent.f == 4);
    CHECK(std::isnan(active_exponent.g[1]));
    Tape<double> tape;
    const auto recording = tape.record();
    const auto x = tape.variable(-2), y = tape.variable(2);
    tape.backward(pow(x, y));
    CHECK(tape.adjoint(x) == -4);
    CHECK(std::isnan(tape.adjoint(y)));
  }
  SECTION("min and max take the first argument of a tie") {
    const J a = J::variable(1, 0), b = J::variable(1, 1);
    CHECK((min(a, b).g[0] == 1 && max(a, b).g[0] == 1));
    CHECK((min(a, 1).g[0] == 1 && max(1, a).g[0] == 0));
    CHECK((min(J::variable(2, 0), b).g[1] == 1 && max(J::variable(2, 0), b).g[0] == 1));
  }
  SECTION("NaN and infinity go through") {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    CHECK(isnan(sin(J(nan))));
    CHECK(std::isnan(abs(J(nan)).f));
    CHECK(isinf(exp(J(1000.0))));
    CHECK_FALSE(isfinite(log(x0)));
    CHECK(isfinite(x0));
  }
}

}  // namespace functions_test
