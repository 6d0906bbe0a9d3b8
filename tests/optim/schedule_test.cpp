#include "catch.hpp"

#include <dsns/optim/schedule.hpp>

#include <limits>

namespace schedule_test {

using namespace dsns;

namespace {

using AllSchedules = std::tuple<ConstantRate, CosineRate, LinearRate>;

}  // namespace

TEST_CASE("schedules: values by hand", "[optim]") {
  CHECK(ConstantRate{}(0.3) == 1);
  CHECK(CosineRate{}(0) == 1);
  CHECK(CosineRate{}(0.25) == Approx((1 + std::sqrt(0.5)) / 2));
  CHECK(CosineRate{}(1) == Approx(0).margin(1e-15));
  CHECK(CosineRate{0, 0.2}(0.5) == Approx(0.6));
  CHECK(LinearRate{}(0.25) == 0.75);
  CHECK(LinearRate{0.2, 0.1}(0.6) == Approx(0.55));  // half of the rest
  CHECK(LinearRate{0.2, 0.1}(1) == Approx(0.1));
  CHECK(CosineRate{0.2}(0.05) == Approx(0.25));
  CHECK(CosineRate{0.2}(0.2) == 1);
}

TEMPLATE_LIST_TEST_CASE("schedules: stay within 0 and 1, rise and then fall, without jumps", "[optim][law]",
                        AllSchedules) {
  const auto [warmup, floor] = GENERATE(table<double, double>({{0, 0}, {0.1, 0}, {0, 0.3}, {0.5, 0.1}, {1, 0}}));
  const TestType schedule = [warmup = warmup, floor = floor] {
    if constexpr (std::is_same_v<TestType, ConstantRate>)
      return warmup + floor >= 0 ? TestType{} : TestType{};
    else
      return TestType{warmup, floor};
  }();
  const double step = 1e-3;
  for (double done = 0; done <= 1.1; done += step) {  // the clock may overrun the end by a little
    const double here = schedule(done), next = schedule(done + step);
    CHECK(here >= 0);
    CHECK(here <= 1);
    CHECK(std::abs(next - here) <= 10.01 * step);
    CHECK((done + step <= warmup ? next >= here : done < warmup || next <= here));
  }
}

TEMPLATE_TEST_CASE("clip_norm: shortens what is too long and keeps its direction", "[optim]", float, double) {
  using Vector = Eigen::VectorX<TestType>;
  const Vector g = Eigen::Vector2d(3, -4).cast<TestType>();
  Vector clipped = g;
  CHECK(clip_norm<TestType>(clipped, 5) == 5);
  CHECK(clipped == g);
  CHECK(clip_norm<TestType>(clipped, 1) == 5);
  CHECK(double((clipped - g / 5).norm()) == Approx(0).margin(1e-7));
  clipped.setZero();
  CHECK(clip_norm<TestType>(clipped, 1) == 0);
  CHECK(clipped == Vector::Zero(2));
  CHECK_THROWS_AS(clip_norm<TestType>(clipped, 0), InvalidArgument);
}

TEST_CASE("clip_norm: squares beyond single precision do not make the norm infinite", "[optim]") {
  Eigen::VectorXf g = Eigen::VectorXf::Constant(4, 1e30f);
  CHECK(clip_norm<float>(g, 1) == Approx(2e30));
  CHECK(g.norm() == Approx(1));
}

}  // namespace schedule_test
