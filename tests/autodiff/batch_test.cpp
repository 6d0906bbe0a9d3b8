#include "catch.hpp"

#include <dsns/autodiff/batch.hpp>
#include <dsns/autodiff/dual.hpp>
#include <dsns/autodiff/jet2.hpp>
#include <dsns/autodiff/tape.hpp>

#include <array>
#include <cmath>
#include <limits>
#include <tuple>

namespace batch_test {

using namespace dsns;

namespace {

// Every function, at arguments where it is smooth, at its special points and beside them.
#define UNARY(name)   \
  [](const auto& x) { \
    using std::name;  \
    return name(x);   \
  }
const std::tuple functions{UNARY(sin),
                           UNARY(cos),
                           UNARY(tan),
                           UNARY(exp),
                           UNARY(expm1),
                           UNARY(exp2),
                           UNARY(log),
                           UNARY(log1p),
                           UNARY(log2),
                           UNARY(log10),
                           UNARY(sqrt),
                           UNARY(cbrt),
                           UNARY(asin),
                           UNARY(acos),
                           UNARY(atan),
                           UNARY(sinh),
                           UNARY(cosh),
                           UNARY(tanh),
                           UNARY(asinh),
                           UNARY(acosh),
                           UNARY(atanh),
                           UNARY(erf),
                           UNARY(erfc),
                           UNARY(floor),
                           UNARY(ceil),
                           UNARY(trunc),
                           UNARY(round),
                           UNARY(rint),
                           UNARY(nearbyint),
                           UNARY(abs),
                           [](const auto& x) { return softplus(x); },
                           [](const auto& x) { return sigmoid(x); },
                           [](const auto& x) { return silu(x); },
                           [](const auto& x) { return sqr(x); },
                           [](const auto& x) {
                             using std::pow;
                             return pow(x, 3);
                           },
                           [](const auto& x) {
                             using std::pow;
                             return pow(x, 0.5);
                           },
                           [](const auto& x) {
                             using std::pow;
                             return pow(2, x);
                           },
                           [](const auto& x) {
                             using std::pow;
                             return pow(x, x);
                           },
                           [](const auto& x) {
                             using std::hypot;
                             return hypot(x, 2 * x);
                           },
                           [](const auto& x) {
                             using std::atan2;
                             return atan2(x, x - 1);
                           },
                           [](const auto& x) {
                             using std::min;
                             return min(x, x * x);
                           },
                           [](const auto& x) {
                             using std::max;
                             return max(x, x * x);
                           },
                           [](const auto& x) { return fmin(x, x * x) + fdim(x, 0.2 * x * x) - fmax(x, 1 - x); },
                           [](const auto& x) { return fmod(x, 0.6) + remainder(x, x * x + 0.3); },
                           [](const auto& x) { return copysign(x, 1 - x) + fma(x, x, x); },
                           [](const auto& x) { return hypot(x, 0.5, x * x); },
                           [](const auto& x) { return 2 / x - x / 3 + (1 - x) * x; }};
#undef UNARY

bool same(double a, double b) {
  return (std::isnan(a) && std::isnan(b)) || a == b ||
         std::abs(a - b) <= 1e-14 * std::max({1.0, std::abs(a), std::abs(b)});
}

template <int L, class Functions>
void compare(const Functions& all) {
  using B = Batch<double, L>;
  const std::array<double, 16> points{0.3, -0.7, 1.4, 2.6, 0, 1, -1, 0.01, 0.5, 3, -2.5, 0.9, 20, -20, 0.999, 1.0001};
  std::apply(
      [&](const auto&... f) {
        int number = 0;
        const auto check = [&](const auto& g) {
          INFO("function " << number++);
          for (std::size_t first = 0; first < points.size(); first += L) {
            const B x = B::load(&points[first]);
            const auto dual = g(Dual<B, 2>::variable(x, 1));
            const auto jet = g(Jet2<B, 2>::variable(x, 0));
            const auto nested = g(Dual<Dual<B, 1>, 1>(Dual<B, 1>::variable(x, 0), {Dual<B, 1>(B(1))}));
            Tape<B> tape;
            const auto recording = tape.record();
            const auto v = tape.variable(x);
            const auto y = g(v);
            tape.backward(y);
            const B slope = tape.adjoint(v);
            for (int k = 0; k < L; ++k) {
              const double p = points[first + std::size_t(k)];
              INFO("at " << p);
              const auto expected = g(Jet2<double, 2>::variable(p, 0));
              CHECK(same(dual.f[k], expected.f));
              CHECK(same(dual.g[1][k], expected.g[0]));
              CHECK(same(jet.f[k], expected.f));
              CHECK(same(jet.g[0][k], expected.g[0]));
              CHECK(same(jet.h[0][k], expected.h[0]));
              if (std::isfinite(expected.h[0])) CHECK(same(nested.g[0].g[0][k], expected.h[0]));
              CHECK(same(y.f[k], expected.f));
              if (std::isfinite(expected.g[0])) CHECK(same(slope[k], expected.g[0]));
            }
          }
        };
        (check(f), ...);
      },
      all);
}

}  // namespace

TEST_CASE("batch: every lane has the derivatives of a number", "[autodiff]") {
  const std::tuple some{[](const auto& x) { return sin(x) * cos(x) / exp(x); },
                        [](const auto& x) { return log(x * x + 1); }};
  compare<2>(some);
  compare<4>(functions);
  compare<8>(some);
}

TEST_CASE("batch: floats, masks and selection", "[autodiff]") {
  using B = Batch<float, 4>;
  const std::array<float, 4> numbers{1, -2, 3, std::numeric_limits<float>::quiet_NaN()};
  const B x = B::load(numbers.data());
  const auto positive = x > 0;
  CHECK((positive[0] && !positive[1] && positive[2] && !positive[3]));
  CHECK((any(positive) && !all(positive) && all(positive || !positive)));
  CHECK(select(positive, x, B(0))[1] == 0);
  CHECK(sin(Dual<B, 3>::variable(x, 2)).g[2][1] == Approx(std::cos(-2.0f)));
  std::array<float, 4> out{};
  (x * 2).store(out.data());
  CHECK((out[0] == 2 && out[1] == -4));
}

}  // namespace batch_test
