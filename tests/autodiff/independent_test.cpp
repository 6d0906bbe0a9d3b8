// Derivatives against two methods that know nothing of ours: the complex step, exact to rounding where a function is
// analytic, and central differences.
#include "catch.hpp"

#include <dsns/autodiff/dual.hpp>
#include <dsns/autodiff/jet2.hpp>

#include <cmath>
#include <complex>
#include <string>

namespace independent_test {

using namespace dsns;

namespace {

using C = std::complex<double>;

template <class F>
void check(const std::string& name, const F& f, std::initializer_list<double> points, bool analytic = true) {
  for (const double x : points) {
    INFO(name << " at " << x);
    const auto jet = f(Jet2<double, 1>::variable(x, 0));
    CHECK(f(Dual<double, 1>::variable(x, 0)).g[0] == Approx(jet.g[0]).epsilon(1e-15));
    const double h = 1e-4 * std::max(1.0, std::abs(x));
    const auto value = [&](double at) { return f(Jet2<double, 1>::variable(at, 0)).f; };
    const auto slope = [&](double at) { return f(Jet2<double, 1>::variable(at, 0)).g[0]; };
    CHECK(jet.g[0] == Approx((8 * (value(x + h) - value(x - h)) - (value(x + 2 * h) - value(x - 2 * h))) / (12 * h))
                          .epsilon(1e-9)
                          .margin(1e-10));
    CHECK(jet.h[0] == Approx((8 * (slope(x + h) - slope(x - h)) - (slope(x + 2 * h) - slope(x - 2 * h))) / (12 * h))
                          .epsilon(1e-9)
                          .margin(1e-10));
    if constexpr (std::is_invocable_v<F, C>) {
      if (analytic) CHECK(jet.g[0] == Approx(f(C(x, 1e-200)).imag() / 1e-200).epsilon(1e-13).margin(1e-15));
    }
  }
}

// clang-format off
#define FUNCTION(name) check(#name, [](const auto& x) { using std::name; return name(x); },
#define REAL_FUNCTION(name) check(#name, [](const auto& x) requires(!std::is_same_v<std::decay_t<decltype(x)>, C>) { using std::name; return name(x); },
// clang-format on

}  // namespace

TEST_CASE("independent: every function against the complex step and central differences", "[autodiff]") {
  FUNCTION(exp){-3.0, 0.2, 4.0});
  FUNCTION(log){0.05, 1.0, 30.0});
  FUNCTION(log10){0.05, 1.0, 30.0});
  FUNCTION(sqrt){0.05, 1.0, 30.0});
  FUNCTION(sin){-2.0, 0.1, 9.0});
  FUNCTION(cos){-2.0, 0.1, 9.0});
  FUNCTION(tan){-1.0, 0.1, 1.2});
  FUNCTION(sinh){-2.0, 0.1, 3.0});
  FUNCTION(cosh){-2.0, 0.1, 3.0});
  FUNCTION(tanh){-2.0, 0.1, 3.0});
  REAL_FUNCTION(asin){-0.8, 0.1, 0.7});
  REAL_FUNCTION(acos){-0.8, 0.1, 0.7});
  REAL_FUNCTION(atan){-3.0, 0.1, 0.7});
  REAL_FUNCTION(asinh){-3.0, 0.1, 0.7});
  REAL_FUNCTION(acosh){1.2, 3.0});
  REAL_FUNCTION(atanh){-0.8, 0.1, 0.7});
  REAL_FUNCTION(cbrt){-3.0, 0.1, 0.7});
  REAL_FUNCTION(exp2){-3.0, 0.1, 4.0});
  REAL_FUNCTION(expm1){-3.0, 0.1, 4.0});
  REAL_FUNCTION(log1p){-0.5, 0.1, 4.0});
  REAL_FUNCTION(log2){0.05, 1.0, 30.0});
  REAL_FUNCTION(erf){-1.5, 0.1, 2.0});
  REAL_FUNCTION(erfc){-1.5, 0.1, 2.0});
  REAL_FUNCTION(abs){-1.5, 2.0});
  check("softplus", [](const Differentiable auto& x) { return softplus(x); }, {-30.0, -0.4, 0.3, 30.0});
  check("sigmoid", [](const Differentiable auto& x) { return sigmoid(x); }, {-30.0, -0.4, 0.3, 30.0});
  check("silu", [](const Differentiable auto& x) { return silu(x); }, {-30.0, -0.4, 0.3, 30.0});
  check("powers",
        [](const auto& x) {
          using std::pow;
          return pow(x, 3.5) + pow(1.7, x);
        },
        {0.3, 2.0});
  check("x^x", [](const Differentiable auto& x) { return pow(x, x); }, {0.3, 2.0});
  check("hypot, atan2", [](const Differentiable auto& x) { return hypot(x, 2 - x) + atan2(x, 1 + x); }, {-0.3, 2.0});
  check("hypot of three", [](const Differentiable auto& x) { return hypot(x, 2 - x, x * x); }, {-0.3, 0.0, 2.0});
  check("fma, fmod, remainder, fdim, copysign",
        [](const Differentiable auto& x) {
          return fma(x, x, sin(x)) + fmod(x * x, 0.7) - remainder(3.0, x) + fdim(x, exp(-x)) * copysign(x, -x);
        },
        {-0.3, 1.9});
  check("a program",
        [](const auto& x) {
          using std::exp, std::sin, std::sqrt;
          auto y = sin(x) / (2.0 + x * x);
          for (int i = 0; i < 5; ++i) y = exp(-y * x) - sqrt(1.0 + y * y) / 3.0;
          return y;
        },
        {-0.2, 0.2, 2.0});
}

}  // namespace independent_test
