#include "catch.hpp"

#include <dsns/autodiff/dual.hpp>
#include <dsns/autodiff/tape.hpp>

#include <random>
#include <thread>
#include <vector>

namespace tape_test {

using namespace dsns;

namespace {

template <class T>
T program(std::uint32_t seed, const T& x, const T& y) {
  using std::cos, std::exp, std::hypot;
  std::mt19937 random(seed);
  T r[3] = {x, y, T(0.25)};
  for (int step = 0; step < 30; ++step) {
    T& a = r[random() % 3];
    const T b = r[random() % 3];
    switch (random() % 6) {
      case 0:
        a += b;
        break;
      case 1:
        a = cos(a) * b - 1;
        break;
      case 2:
        a = 2 / (2 + a * b * a * b);
        break;
      case 3:
        a -= a * b / 4;
        break;
      case 4:
        a = hypot(a, 1 + b);
        break;
      default:
        a = exp(-sqr(a)) + 3 * b;
        break;
    }
    a = a / (1 + sqr(a));
  }
  return r[0] - r[1] * r[2];
}

}  // namespace

TEST_CASE("tape: random programs have the derivatives of forward mode", "[autodiff]") {
  using D = Dual<double, 2>;
  Tape<double> tape;
  for (std::uint32_t seed = 0; seed < 200; ++seed) {
    INFO("seed " << seed);
    const auto recording = tape.record();
    const auto x = tape.variable(0.8), y = tape.variable(-0.6);
    const auto z = program(seed, x, y);
    tape.backward(z);
    const D d = program(seed, D::variable(0.8, 0), D::variable(-0.6, 1));
    CHECK(std::abs(z.f - d.f) <= 1e-14);  // the compiler may fuse a product with a sum in one and not in the other
    CHECK(std::abs(tape.adjoint(x) - d.g[0]) <= 1e-13 * std::max(1.0, std::abs(d.g[0])));
    CHECK(std::abs(tape.adjoint(y) - d.g[1]) <= 1e-13 * std::max(1.0, std::abs(d.g[1])));
  }
}

TEST_CASE("tape: a shared graph of depth 1000 costs what it holds", "[autodiff]") {
  Tape<double> tape;
  const auto recording = tape.record();
  const auto x = tape.variable(1);
  auto y = x;
  for (int i = 0; i < 1000; ++i) y = y + y;  // 2^1000 paths
  tape.backward(y);
  CHECK(tape.size() == 1001);
  CHECK(tape.adjoint(x) == std::ldexp(1.0, 1000));
}

TEST_CASE("tape: a chain of a million operations needs no stack", "[autodiff]") {
  Tape<double> tape;
  const auto recording = tape.record();
  const auto x = tape.variable(0.5);
  auto y = x;
  for (int i = 0; i < 1'000'000; ++i) y = 1 / y;
  tape.backward(y);
  CHECK(y.f == Approx(0.5));
  CHECK(tape.adjoint(x) == Approx(1));
}

TEST_CASE("tape: constants leave no trace", "[autodiff]") {
  Tape<double> tape;
  const auto recording = tape.record();
  const Var<double> c(3.0);
  const auto d = sin(c) * 2 + c / 4;
  CHECK(tape.size() == 0);
  tape.backward(d);
  const auto x = tape.variable(1);
  tape.backward(x + d);
  CHECK(tape.adjoint(x) == 1);
  CHECK(tape.adjoint(c) == 0);
}

TEST_CASE("tape: several sweeps of one recording do not add up", "[autodiff]") {
  Tape<double> tape;
  const auto recording = tape.record();
  const auto x = tape.variable(3);
  const auto a = x * x, b = a * x;
  tape.backward(b);
  CHECK(tape.adjoint(x) == 27);
  tape.backward(a, 2.0);
  CHECK(tape.adjoint(x) == 12);
  CHECK(tape.adjoint(b) == 0);
  CHECK_THROWS_AS(tape.adjoint(b + 1.0 / x), InvalidArgument);  // recorded after the sweep
}

TEST_CASE("tape: variables of an ended, replaced or foreign recording are refused", "[autodiff]") {
  Tape<double> tape, other;
  Var<double> old;
  {
    const auto recording = tape.record();
    old = tape.variable(1);
    CHECK_NOTHROW(sin(old));
  }
  CHECK_THROWS_AS(sin(old), InvalidArgument);
  {
    const auto recording = tape.record();
    const auto x = tape.variable(2);
    CHECK_THROWS_AS(old + x, InvalidArgument);
    CHECK_THROWS_AS(cos(old), InvalidArgument);
    CHECK_THROWS_AS(tape.backward(old), InvalidArgument);
    CHECK_THROWS_AS(tape.adjoint(old), InvalidArgument);
    {
      const auto inner = other.record();
      CHECK_THROWS_AS(sin(x), InvalidArgument);
      const auto y = other.variable(5);
      CHECK_THROWS_AS(x * y, InvalidArgument);
    }
    CHECK_NOTHROW(sin(x));  // the outer recording is active again
  }
}

TEST_CASE("tape: two threads record on a tape each", "[autodiff]") {
  std::vector<double> slopes(2);
  const auto work = [&](std::size_t k) {
    Tape<double> tape;
    for (int repeat = 0; repeat < 100; ++repeat) {
      const auto recording = tape.record();
      const auto x = tape.variable(double(k) + 1);
      auto y = x;
      for (int i = 0; i < 50; ++i) y = sin(y) + x;
      tape.backward(y);
      slopes[k] = tape.adjoint(x);
    }
  };
  {
    const std::jthread other(work, std::size_t(1));
    work(0);
  }
  for (std::size_t k = 0; k < 2; ++k) {
    auto x = Dual<double>::variable(double(k) + 1, 0), y = x;
    for (int i = 0; i < 50; ++i) y = sin(y) + x;
    CHECK(slopes[k] == Approx(y.g[0]).epsilon(1e-13));
  }
}

TEST_CASE("tape: a gradient within a gradient", "[autodiff]") {
  // f(x) = x^3: the inner tape gives f', the outer one f''.
  Tape<double> outer;
  const auto outer_recording = outer.record();
  const auto x = outer.variable(2);
  Tape<Var<double>> inner;
  const auto inner_recording = inner.record();
  const auto y = inner.variable(x);
  inner.backward(y * y * y);
  const Var<double> slope = inner.adjoint(y);
  outer.backward(slope);
  CHECK(slope.f == 12);
  CHECK(outer.adjoint(x) == 12);
}

}  // namespace tape_test
