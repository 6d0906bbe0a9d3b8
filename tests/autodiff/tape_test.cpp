#include "catch.hpp"

#include <dsns/autodiff/dual.hpp>
#include <dsns/autodiff/tape.hpp>

#include <array>
#include <random>
#include <thread>
#include <utility>
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

namespace {

/// Sums of products in every shape a user may write them, copies, aliases and self references between them.
template <class T>
T sums(std::uint32_t seed, const std::array<T, 6>& inputs) {
  std::mt19937 random(seed);
  std::vector<T> v(inputs.begin(), inputs.end());
  for (int i = 0; i < 12; ++i) v.push_back(v[random() % v.size()] * (0.25 + 0.5 * double(i % 3)));
  T total(0.5), other = v[0];
  for (int round = 0; round < 12; ++round) {
    const std::size_t n = 1 + random() % 6, a = random() % (v.size() - 2 * n), b = random() % (v.size() - 2 * n);
    const std::size_t step = 1 + random() % 2;
    T s = random() % 2 == 0 ? T(0) : v[b];
    for (std::size_t k = 0; k < n; ++k) {
      switch (random() % 24) {
        case 0:
          s = s + v[a + k];  // ends a run
          break;
        case 1:
          s -= v[a + k] * v[b + k];
          break;
        case 2:
          s += s * v[a];
          break;
        case 3:
          s += s;
          break;
        case 4: {
          const T copy = s;  // both go on by themselves
          s += v[a] * v[b];
          other += copy * v[b];
          break;
        }
        case 5:
          s += -(v[a] * v[b + k]) + 1;
          break;
        case 6:
          s -= 0.5 * v[a + k];
          break;
        case 7:
          std::swap(s, other);
          break;
        case 8: {
          const T product = v[a] * v[b];  // used twice: recorded once
          s += product;
          s += product;
          break;
        }
        default:
          if (round % 3 == 0)
            s += 0.3 * v[b + step * k];
          else if (round % 3 == 1)
            s += v[a + k] * v[b + step * k];
          else
            s += v[b + step * k];
      }
    }
    s = s / (1 + s * s);
    total += round % 2 == 0 ? T(s * s) : s;
    v.push_back(std::move(s));
  }
  total -= other / 8;
  return total;
}

}  // namespace

TEMPLATE_TEST_CASE("tape: sums of products have the derivatives of forward mode", "[autodiff]", double, long double,
                   (Dual<double, 2>)) {
  using T = TestType;
  using D = Dual<T, 6>;
  Tape<T> tape;
  const auto distance = [](const T& x, const T& y) {
    if constexpr (Differentiable<T>) {
      return std::abs(x.f - y.f) + std::abs(x.g[0] - y.g[0]) + std::abs(x.g[1] - y.g[1]);
    } else {
      return double(std::abs(x - y));
    }
  };
  for (std::uint32_t seed = 0; seed < 400; ++seed) {
    INFO("seed " << seed);
    const auto recording = tape.record();
    std::array<Var<T>, 6> x;
    std::array<D, 6> d;
    for (int k = 0; k < 6; ++k) {
      T start = static_cast<T>(0.7 - 0.25 * k);
      if constexpr (Differentiable<T>) start.g = {0.5 * k - 1, 1.0};
      x[std::size_t(k)] = tape.variable(start);
      d[std::size_t(k)] = D::variable(start, k);
    }
    const Var<T> z = sums(seed, x);
    tape.backward(z);
    const D expected = sums(seed, d);
    CHECK(distance(z.f, expected.f) <= 1e-12);
    for (std::size_t k = 0; k < 6; ++k) {
      const T slope = expected.g[k];
      CHECK(distance(tape.adjoint(x[k]), slope) <= 1e-11 * std::max(1.0, std::abs(double(value(slope)))));
    }
  }
}

TEST_CASE("tape: long sums of products cost no node a term, with any strides", "[autodiff]") {
  Tape<double> tape;
  const auto recording = tape.record();
  const int n = 600;
  std::vector<Var<double>> x, y;
  for (int i = 0; i < n; ++i) x.push_back(tape.variable(std::sin(i)));
  for (int i = 0; i < n; ++i) {
    y.push_back(exp(x[std::size_t(i)]));
    y.push_back(cos(y.back()));
  }
  const std::size_t before = tape.size();
  Var<double> s = 0.0;
  for (int i = 0; i < n; ++i) s += x[std::size_t(i)] * y[std::size_t(2 * i + 1)];      // strides 1 and 2
  for (int i = 0; i < n; ++i) s -= x[std::size_t(n - 1 - i)] * y[std::size_t(2 * i)];  // strides -1 and 2
  for (int i = 0; i < n; ++i) s += (1.0 + i) * x[std::size_t(i)];
  for (int i = 0; i < n; ++i) s += y[std::size_t(2 * i)];
  tape.backward(s);
  CHECK(tape.size() - before == 1);
  for (const int k : {0, 1, 17, n - 1}) {
    const double xk = std::sin(k), e = std::exp(xk), c = std::cos(e);
    const double other = std::exp(std::sin(n - 1 - k));
    const double expected = c - xk * std::sin(e) * e - std::sin(n - 1 - k) * e - other + (1.0 + k) + e;
    CHECK(tape.adjoint(x[std::size_t(k)]) == Approx(expected).epsilon(1e-13));
  }
}

TEST_CASE("tape: a product that is used by name has an adjoint, one that is not used has none", "[autodiff]") {
  Tape<double> tape;
  const auto recording = tape.record();
  const auto x = tape.variable(3), y = tape.variable(4);
  const auto unused = x * y, product = x * y;
  Var<double> sum = product;
  sum += product;
  sum += 5 * product;
  tape.backward(sum);
  CHECK(sum.f == 84);
  CHECK(tape.adjoint(product) == 7);
  CHECK(tape.adjoint(unused) == 0);
  CHECK(tape.adjoint(x) == 28);
}

TEST_CASE("tape: a variable plus a constant has an adjoint of its own", "[autodiff]") {
  Tape<double> tape;
  const auto recording = tape.record();
  const auto x = tape.variable(3);
  const auto h = sin(x), y = h - 2.0;
  tape.backward(y * y + 5 * h);
  CHECK(tape.adjoint(y) == Approx(2 * y.f));
  CHECK(tape.adjoint(h) == Approx(2 * y.f + 5));
  Var<double> s = 0.0;
  s += x;
  tape.backward(s * x);
  CHECK((tape.adjoint(s) == 3 && tape.adjoint(x) == 6));
}

TEST_CASE("tape: what was computed and not yet used can be copied and swept whatever is active", "[autodiff]") {
  Tape<double> outer, inner;
  Var<double> late, x;
  {
    const auto recording = outer.record();
    x = outer.variable(3);
    Var<double> sum = x * x;
    sum += x * 2;
    late = x * x * x;
    {
      const auto other = inner.record();
      const Var<double> copy = sum;  // no operation: only a copy
      outer.backward(copy);
      CHECK(outer.adjoint(x) == 8);
    }
  }
  outer.backward(late);  // after the recording has ended
  CHECK(outer.adjoint(x) == 27);
}

TEST_CASE("tape: no variable before a recording, no adjoint before a sweep", "[autodiff]") {
  Tape<double> tape;
  CHECK_THROWS_AS(tape.variable(3), InvalidArgument);
  {
    const auto recording = tape.record();
    const auto x = tape.variable(3);
    tape.backward(x * x);
    CHECK(tape.adjoint(x) == 6);
  }
  const auto recording = tape.record();
  const auto x = tape.variable(7);
  CHECK_THROWS_AS(tape.adjoint(x), InvalidArgument);
}

TEST_CASE("tape: the limits of a scalar are those of its number", "[autodiff]") {
  using V = Var<double>;
  V best = std::numeric_limits<V>::max();
  for (const V& v : {V(4.0), V(2.0)})
    if (v < best) best = v;
  CHECK(best.f == 2);
  CHECK(std::numeric_limits<Dual<Dual<float>>>::epsilon() == std::numeric_limits<float>::epsilon());
}

TEST_CASE("tape: a sum that has been copied or moved from goes on alone", "[autodiff]") {
  Tape<double> tape;
  const auto recording = tape.record();
  const auto x = tape.variable(3), y = tape.variable(4);
  Var<double> a = 0.0;
  a += x * y;
  a += x * x;
  const Var<double> copy = a;
  Var<double> b = std::move(a);
  a += y * y;
  b += x * y;
  tape.backward(copy);
  CHECK((tape.adjoint(x) == 10 && tape.adjoint(y) == 3));
  tape.backward(a);
  CHECK((tape.adjoint(x) == 10 && tape.adjoint(y) == 11));
  tape.backward(b);
  CHECK((tape.adjoint(x) == 14 && tape.adjoint(y) == 6));
}

TEST_CASE("tape: sums that outlive their recording are refused", "[autodiff]") {
  Tape<double> tape;
  Var<double> sum = 0.0, product;
  {
    const auto recording = tape.record();
    const auto x = tape.variable(3);
    sum += x * x;
    sum += x * x;
    product = x * x;
  }
  const auto recording = tape.record();
  const auto x = tape.variable(2);
  CHECK_THROWS_AS(sum + 1.0 * x, InvalidArgument);
  CHECK_THROWS_AS(product * x, InvalidArgument);
  CHECK_THROWS_AS(sum += x * x, InvalidArgument);
  CHECK_THROWS_AS(sin(product), InvalidArgument);
  CHECK_THROWS_AS(tape.backward(sum), InvalidArgument);
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

TEST_CASE("tape: a chain of ten million operations needs no stack", "[autodiff]") {
  Tape<double> tape;
  const auto recording = tape.record();
  const auto x = tape.variable(0.5);
  auto y = x;
  for (int i = 0; i < 10'000'000; ++i) y = 1 / y;
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
    {
      const auto once_more = tape.record();  // on the same tape: replaces the outer one
      const auto z = tape.variable(7);
      CHECK_NOTHROW(sin(z));
    }
    CHECK_THROWS_AS(sin(x), InvalidArgument);
    CHECK_THROWS_AS(x * x + x, InvalidArgument);
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
