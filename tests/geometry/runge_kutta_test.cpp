#include "catch.hpp"

#include <dsns/geometry/runge_kutta.hpp>

namespace runge_kutta_test {

using namespace dsns;

namespace {

using State = Eigen::Vector2d;

State turning(const State& y) { return {-y[1], y[0]}; }
/// y' = y^2 with y(0) = 1 is 1 / (1 - t), in both components.
State blowing_up(const State& y) { return y.cwiseAbs2(); }

const auto as_it_is = [](const State& y) { return y; };

}  // namespace

TEST_CASE("one step has the order eight, its error estimate seven", "[geometry]") {
  const auto errors = [](double h) {
    const auto step = detail::trial_step<2>(blowing_up, State(State::Ones()), h);
    const double exact = 1 / (1 - h);
    return Eigen::Vector2d(std::abs(step.y[0] - exact), std::abs(step.y[0] - step.error[0] - exact));
  };
  const Eigen::Vector2d ratio = errors(0.16).cwiseQuotient(errors(0.08));
  CHECK(std::log2(ratio[0]) > 8.5);  // the local error has one order more
  CHECK(std::log2(ratio[1]) > 7.5);
  CHECK(std::log2(ratio[1]) < 9);
}

TEST_CASE("a turn of a circle is closed to the tolerance, and wanted times are met", "[geometry]") {
  const Eigen::VectorXd times = Eigen::VectorXd::LinSpaced(9, 0, 2 * pi);
  for (const double tolerance : {1e-8, 1e-13}) {
    int arrived = 0;
    const RungeKuttaSummary summary =
        integrate_steps<2>(turning, as_it_is, State(1, 0), times, {tolerance, 1000}, [&](Index i, const State& y) {
          CHECK((y - State(std::cos(times[i]), std::sin(times[i]))).norm() < 100 * tolerance);
          ++arrived;
        });
    CHECK(arrived == 9);
    CHECK(summary.converged);
    CHECK(summary.steps >= 8);
    CHECK(summary.steps < 60);
  }
}

TEST_CASE("steps shrink before a pole, and the integration stops at max_steps", "[geometry]") {
  double end = 0;
  const Eigen::VectorXd near = Eigen::VectorXd::Constant(1, 0.999), beyond = Eigen::VectorXd::Constant(1, 1.1);
  const auto summary = integrate_steps<2>(blowing_up, as_it_is, State(1, 1), near, {1e-12, 1000},
                                          [&](Index, const State& y) { end = y[0]; });
  CHECK(summary.converged);
  CHECK(end == Approx(1000).epsilon(1e-7));
  int arrived = 0;
  const auto failed = integrate_steps<2>(blowing_up, as_it_is, State(1, 1), beyond, {1e-12, 50},
                                         [&](Index, const State&) { ++arrived; });
  CHECK(!failed.converged);
  CHECK(failed.steps + failed.rejected == 50);
  CHECK(arrived == 0);
}

TEST_CASE("what a step conserves is kept by the projection", "[geometry]") {
  const auto on_circle = [](const State& y) { return State(y.normalized()); };
  const Eigen::VectorXd far = Eigen::VectorXd::Constant(1, 1000);
  double radius = 0;
  integrate_steps<2>(turning, on_circle, State(1, 0), far, {1e-6, 10000},
                     [&](Index, const State& y) { radius = y.norm(); });
  CHECK(radius == Approx(1).epsilon(1e-15));
}

}  // namespace runge_kutta_test
