// The table of docs/autodiff.md, row by row.
#include "catch.hpp"

#include <dsns/autodiff/dual.hpp>
#include <dsns/autodiff/jet2.hpp>
#include <dsns/autodiff/tape.hpp>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace conventions_test {

using namespace dsns;

namespace {

constexpr double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
constexpr double pi = 3.14159265358979323846, ln2 = 0.69314718055994530942;

bool same(double a, double b) {
  return (std::isnan(a) && std::isnan(b)) || a == b || std::abs(a - b) <= 1e-15 * std::abs(b);
}

/// Value, slope, second derivative.
struct Row {
  std::string name;
  double x;
  std::array<double, 3> expected;
};
template <class F>
void check(const std::vector<Row>& rows, const F& f) {
  for (const auto& [name, x, expected] : rows) {
    INFO(name << " at " << x);
    const auto jet = f(Jet2<double, 2>::variable(x, 0));
    CHECK(same(jet.f, expected[0]));
    CHECK(same(jet.g[0], expected[1]));
    CHECK(same(jet.h[0], expected[2]));
    CHECK((jet.g[1] == 0 && jet.h[1] == 0 && jet.h[2] == 0));  // the other variable stands still
    const auto dual = f(Dual<double, 3>::variable(x, 1));
    CHECK((dual.g[0] == 0 && same(dual.g[1], expected[1]) && dual.g[2] == 0));
    Tape<double> tape;
    const auto recording = tape.record();
    const auto v = tape.variable(x);
    const auto y = f(v);
    tape.backward(y);
    CHECK(same(y.f, expected[0]));
    CHECK(same(tape.adjoint(v), expected[1]));
  }
}

/// Value, slopes in x and y, second derivatives xx, xy, yy.
struct Pair {
  double x, y;
  std::array<double, 6> expected;
};
template <class F>
void check(const std::string& name, const std::vector<Pair>& pairs, const F& f) {
  using J = Jet2<double, 2>;
  for (const auto& [x, y, expected] : pairs) {
    INFO(name << " at " << x << ", " << y);
    const auto jet = f(J::variable(x, 0), J::variable(y, 1));
    const double found[] = {jet.f, jet.g[0], jet.g[1], jet.h[0], jet.h[1], jet.h[2]};
    for (std::size_t k = 0; k < 6; ++k) {
      INFO("entry " << k << ": " << found[k] << ", expected " << expected[k]);
      CHECK(same(found[k], expected[k]));
    }
    Tape<double> tape;
    const auto recording = tape.record();
    const auto u = tape.variable(x), v = tape.variable(y);
    const auto w = f(u, v);
    tape.backward(w);
    CHECK(same(w.f, expected[0]));
    CHECK(same(tape.adjoint(u), expected[1]));
    CHECK(same(tape.adjoint(v), expected[2]));
  }
}

}  // namespace

TEST_CASE("conventions: functions of one argument at their special points", "[autodiff]") {
  check({{"abs", 0, {0, 0, 0}}, {"abs", -0.0, {0, 0, 0}}, {"abs", -3, {3, -1, 0}}},
        [](const auto& x) { return abs(x); });
  check({{"sqrt", 0, {0, inf, -inf}}}, [](const auto& x) { return sqrt(x); });
  check({{"cbrt", 0, {0, inf, -inf}}}, [](const auto& x) { return cbrt(x); });
  check({{"log", 0, {-inf, inf, -inf}}}, [](const auto& x) { return log(x); });
  check({{"log1p", -1, {-inf, inf, -inf}}}, [](const auto& x) { return log1p(x); });
  check({{"expm1", 1e-20, {1e-20, 1, 1}}}, [](const auto& x) { return expm1(x); });
  check({{"tanh", 1000, {1, 0, 0}}, {"tanh", -1000, {-1, 0, 0}}}, [](const auto& x) { return tanh(x); });
  check({{"asin", 1, {pi / 2, inf, inf}}}, [](const auto& x) { return asin(x); });
  check({{"acos", 1, {0, -inf, -inf}}}, [](const auto& x) { return acos(x); });
  check({{"acosh", 1, {0, inf, -inf}}}, [](const auto& x) { return acosh(x); });
  check({{"atanh", 1, {inf, inf, inf}}}, [](const auto& x) { return atanh(x); });
  check({{"erf", 30, {1, 0, 0}}}, [](const auto& x) { return erf(x); });
  check({{"softplus", 800, {800, 1, 0}}, {"softplus", -800, {0, 0, 0}}}, [](const auto& x) { return softplus(x); });
  check({{"sigmoid", 800, {1, 0, 0}}, {"sigmoid", -800, {0, 0, 0}}}, [](const auto& x) { return sigmoid(x); });
  check({{"silu", 800, {800, 1, 0}}, {"silu", -800, {0, 0, 0}}}, [](const auto& x) { return silu(x); });
}

TEST_CASE("conventions: powers with a constant exponent or base", "[autodiff]") {
  const auto to_the = [](double c) { return [c](const auto& x) { return pow(x, c); }; };
  check({{"x^0", 0, {1, 0, 0}}, {"x^0", -2, {1, 0, 0}}}, to_the(0));
  check({{"x^1", 0, {0, 1, 0}}}, to_the(1));
  check({{"x^2", 0, {0, 0, 2}}, {"x^2", -2, {4, -4, 2}}}, to_the(2));
  check({{"x^3", 0, {0, 0, 0}}, {"x^3", -2, {-8, 12, -12}}}, to_the(3));
  check({{"x^0.5", 0, {0, inf, -inf}}, {"x^0.5", -2, {nan, nan, nan}}}, to_the(0.5));
  check({{"x^-1", 0, {inf, -inf, inf}}}, to_the(-1));
  check({{"0^y", 0, {1, 0, 0}}, {"0^y", 1, {0, 0, 0}}, {"0^y", 2, {0, 0, 0}}, {"0^y", -1, {inf, -inf, inf}}},
        [](const auto& y) { return pow(0, y); });
  check({{"(-2)^y", 2, {4, nan, nan}}}, [](const auto& y) { return pow(-2, y); });
}

TEST_CASE("conventions: pow, hypot, atan2, min and max of two variables", "[autodiff]") {
  check("pow",
        {{0, 0, {1, 0, 0, 0, nan, 0}},
         {0, 1, {0, 1, 0, 0, -inf, 0}},
         {0, 2, {0, 0, 0, 2, 0, 0}},
         {0, 0.5, {0, inf, 0, -inf, -inf, 0}},
         {0, -1, {inf, -inf, -inf, inf, inf, inf}},
         {-2, 2, {4, -4, nan, 2, nan, nan}},
         {-2, 3, {-8, 12, nan, -12, nan, nan}},
         {-2, 0.5, {nan, nan, nan, nan, nan, nan}},
         {2, 0, {1, 0, ln2, 0, 0.5, ln2 * ln2}}},
        [](const auto& x, const auto& y) { return pow(x, y); });
  check("hypot",
        {{0, 0, {0, 0, 0, 0, 0, 0}}, {3, 0, {3, 1, 0, 0, 0, 1.0 / 3}}, {3, -4, {5, 0.6, -0.8, 0.128, 0.096, 0.072}}},
        [](const auto& x, const auto& y) { return hypot(x, y); });
  check("atan2", {{0, 0, {0, 0, 0, 0, 0, 0}}, {0, -1, {pi, -1, 0, 0, -1, 0}}, {-0.0, -1, {-pi, -1, 0, 0, -1, 0}}},
        [](const auto& y, const auto& x) { return atan2(y, x); });
  check("min",
        {{1, 1, {1, 1, 0, 0, 0, 0}},
         {2, 1, {1, 0, 1, 0, 0, 0}},
         {nan, 1, {nan, 1, 0, 0, 0, 0}},
         {1, nan, {1, 1, 0, 0, 0, 0}}},
        [](const auto& x, const auto& y) { return min(x, y); });
  check("max",
        {{1, 1, {1, 1, 0, 0, 0, 0}},
         {2, 1, {2, 1, 0, 0, 0, 0}},
         {nan, 1, {nan, 1, 0, 0, 0, 0}},
         {1, nan, {1, 1, 0, 0, 0, 0}}},
        [](const auto& x, const auto& y) { return max(x, y); });
}

}  // namespace conventions_test
