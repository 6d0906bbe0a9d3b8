// The README's ten lines: the curvature of a moving formula, and of a network that learnt it.
#include <dsns/geometry/curvature.hpp>
#include <dsns/nn/fit.hpp>
#include <dsns/sphere/quadrature.hpp>
#include <iostream>

int main() {
  // A body that moves, as a formula: a functor of a unit vector and a time, with any scalar.
  const auto body = [](const auto& s, const auto& t) {
    using std::sin;
    auto p = s;
    p[0] = p[0] * (2.0 + sin(3.0 * t));
    return p;
  };
  const dsns::Mat3X points = dsns::fibonacci_sphere(1000).points;
  std::cout << dsns::curvature(dsns::at_time(body, 0.5), points).gaussian.maxCoeff() << '\n';  // exact
  const dsns::FitOptions smooth{.encoding = {.harmonic_degree = 1}, .steps = 2000};
  const auto network = dsns::fit_neural_surface(body, smooth).surface;  // the same, learnt
  std::cout << dsns::curvature(dsns::at_time(network, 0.5), points).gaussian.maxCoeff() << '\n';
}
