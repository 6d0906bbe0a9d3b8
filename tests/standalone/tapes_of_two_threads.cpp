// Two threads with a tape each, to be run under the thread sanitizer. Fails by its exit status.
#include <dsns/autodiff/functions_on_tape.hpp>

#include <cmath>
#include <cstdio>
#include <thread>

namespace {

double slope(double start) {
  using namespace dsns;
  Tape<double> tape;
  double result = 0;
  for (int repeat = 0; repeat < 200; ++repeat) {
    const auto recording = tape.record();
    const auto x = tape.variable(start);
    Var<double> y = x;
    for (int i = 0; i < 100; ++i) y = sin(y) + x;
    for (int i = 0; i < 100; ++i) y += x * y;
    y = y / (1 + y * y) + preaccumulate([](const auto& a) { return exp(a) * a; }, x);
    tape.backward(y);
    result = tape.adjoint(x);
  }
  return result;
}

}  // namespace

int main() {
  double other = 0;
  std::thread thread([&] { other = slope(0.3); });
  const double here = slope(0.7);
  thread.join();
  const bool right = here == slope(0.7) && other == slope(0.3) && std::isfinite(here + other);
  std::printf("%g %g\n", here, other);
  return right ? 0 : 1;
}
