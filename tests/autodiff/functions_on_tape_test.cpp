#include "catch.hpp"

#include <dsns/autodiff/functions_on_tape.hpp>

#include <cmath>
#include <vector>

namespace functions_on_tape_test {

using namespace dsns;

namespace {

const auto small = [](const auto& a, const auto& b, const auto& c) { return sin(a * b) / (1 + c * c) - b; };

}  // namespace

TEST_CASE("preaccumulate: one to five arguments, the derivatives of the plain tape in fewer places", "[autodiff]") {
  Tape<double> tape;
  const auto recording = tape.record();
  const auto x = tape.variable(0.3), y = tape.variable(-1.2), z = tape.variable(0.8);
  const auto plain = small(x, y, z);
  const std::size_t before = tape.size();
  const auto local = preaccumulate(small, x, y, z);
  CHECK(tape.size() - before == 3);
  CHECK(local.f == plain.f);
  tape.backward(plain);
  const double slopes[] = {tape.adjoint(x), tape.adjoint(y), tape.adjoint(z)};
  tape.backward(local);
  CHECK(tape.adjoint(x) == Approx(slopes[0]).epsilon(1e-14));
  CHECK(tape.adjoint(y) == Approx(slopes[1]).epsilon(1e-14));
  CHECK(tape.adjoint(z) == Approx(slopes[2]).epsilon(1e-14));

  tape.backward(preaccumulate([](const auto& a) { return exp(a); }, x));
  CHECK(tape.adjoint(x) == Approx(std::exp(0.3)));
  tape.backward(preaccumulate([](const auto& a, const auto& b) { return a * b; }, x, x));
  CHECK(tape.adjoint(x) == Approx(0.6));
  tape.backward(preaccumulate(
      [](const auto& a, const auto& b, const auto& c, const auto& d, const auto& e) { return a * b * c * d * e; }, x, y,
      z, y, y));
  CHECK(tape.adjoint(x) == Approx(-1.2 * -1.2 * -1.2 * 0.8));
  CHECK(tape.adjoint(y) == Approx(3 * 1.44 * 0.3 * 0.8));
}

TEST_CASE("preaccumulate: constants among the arguments, and second order", "[autodiff]") {
  using D = Dual<double, 1>;
  Tape<D> tape;
  const auto recording = tape.record();
  const auto x = tape.variable(D::variable(0.7, 0));
  const auto y = preaccumulate([](const auto& a, const auto& b) { return a * a * b; }, x, Var<D>(2.0));
  tape.backward(y);
  CHECK(tape.adjoint(x).f == Approx(2.8));
  CHECK(tape.adjoint(x).g[0] == Approx(4));
}

TEST_CASE("checkpoint: the same derivatives, and a tape that does not grow with the segment", "[autodiff]") {
  const auto segment = [](const auto& v) {
    auto w = v;
    for (int i = 0; i < 200; ++i) {
      w[0] = sin(w[0]) + 0.1 * w[1];
      w[1] = w[1] * cos(w[0]);
    }
    return w;
  };
  Tape<double> tape;
  const auto gradient = [&](bool checkpointed) {
    const auto recording = tape.record();
    const std::vector<Var<double>> x{tape.variable(0.4), tape.variable(1.3)};
    std::vector<Var<double>> w = x;
    for (int k = 0; k < 3; ++k) w = checkpointed ? checkpoint(segment, w) : segment(w);
    tape.backward(w[0] * w[1]);
    return std::array<double, 3>{tape.adjoint(x[0]), tape.adjoint(x[1]), double(tape.size())};
  };
  const auto plain = gradient(false), short_tape = gradient(true);
  CHECK(short_tape[0] == Approx(plain[0]).epsilon(1e-12));
  CHECK(short_tape[1] == Approx(plain[1]).epsilon(1e-12));
  CHECK(plain[2] > 2000);
  CHECK(short_tape[2] < 20);
}

TEST_CASE("custom_vjp: a derivative written by hand, between recorded operations", "[autodiff]") {
  Tape<double> tape;
  const auto recording = tape.record();
  const auto a = tape.variable(0.5), b = tape.variable(2);
  const std::vector<Var<double>> x{a * b, sin(b), 3.0};  // a product not yet recorded, and a constant
  const std::vector<double> values{x[0].f * x[1].f, x[0].f + x[2].f};
  const auto y = custom_vjp(values, x, [p = x[0].f, q = x[1].f](std::span<const double> back, std::span<double> out) {
    out[0] += q * back[0] + back[1];
    out[1] += p * back[0];
    out[2] += back[1];
  });
  tape.backward(y[0] * y[1]);
  const auto dual = [](double a0, double b0, int k) {
    using D = Dual<double, 2>;
    const D u = D::variable(a0, 0), v = D::variable(b0, 1);
    const D p = u * v;
    return (p * sin(v) * (p + 3)).g[std::size_t(k)];
  };
  CHECK(tape.adjoint(a) == Approx(dual(0.5, 2, 0)).epsilon(1e-14));
  CHECK(tape.adjoint(b) == Approx(dual(0.5, 2, 1)).epsilon(1e-14));

  const std::vector<Var<double>> constants{1.0, 2.0};
  const auto c =
      custom_vjp(values, constants, [](std::span<const double>, std::span<double>) { FAIL("nobody depends on it"); });
  CHECK(c[0].f == values[0]);
  tape.backward(c[0] + a);
  CHECK(tape.adjoint(a) == 1);
}

}  // namespace functions_on_tape_test
