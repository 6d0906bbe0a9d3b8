#include "catch.hpp"

#include <dsns/elastic/temporal_registration.hpp>

namespace temporal_registration_test {

using namespace dsns;

namespace {

Eigen::VectorXd velocity(double t) {
  Eigen::VectorXd v(5);
  for (int k = 0; k < 5; ++k)
    v[k] = std::cos((k + 1) * pi * t + 0.7 * k * k) / std::sqrt(k + 1.0) + 0.3 * std::sin(2 * pi * t * (k % 3 + 1));
  return v;
}

/// The curve of that velocity along a warp, exact at its nodes.
Curve curve(const TimeWarp& warp) {
  constexpr Index n = 129;
  Eigen::MatrixXd v(5, n);
  for (Index k = 0; k < n; ++k) {
    const double t = double(k) / (n - 1);
    v.col(k) = velocity(warp(t)) * warp.slope(t);
  }
  return {Eigen::VectorXd::Zero(5), v};
}

TemporalOptions quick_options() {
  TemporalOptions o;
  o.grid = 100;
  o.cosines = {8, 16};
  return o;
}

}  // namespace

TEST_CASE("a known warp of time is recovered", "[elastic]") {
  const std::uint64_t seed = GENERATE(1u, 2u, 3u, 4u);
  const TimeWarp warp = random_warp(seed, 0.5);
  const TemporalResult r = register_temporally(curve({}), curve(warp), quick_options());
  INFO("the warp is " << distance(warp, {}) << ", missed by " << distance(r.warp, inverse(warp)));
  CHECK(distance(r.warp, inverse(warp)) < 1e-3);
  CHECK(r.summary.energy_after < 1e-3 * r.summary.energy_before);
  CHECK(r.summary.min_slope > 0.1);
}

TEST_CASE("a strong warp is recovered with the default options", "[elastic]") {
  const TimeWarp warp = random_warp(3, 1.0);
  CHECK(distance(register_temporally(curve({}), curve(warp)).warp, inverse(warp)) < 2e-3);
}

TEST_CASE("a curve is registered to itself, and to a resting one, by the identity", "[elastic]") {
  const Curve rest(Eigen::VectorXd::Zero(5), Eigen::MatrixXd::Zero(5, 9));
  CHECK(distance(register_temporally(curve({}), curve({}), quick_options()).warp, {}) == 0);
  CHECK(distance(register_temporally(rest, rest, quick_options()).warp, {}) == 0);
  const TemporalResult r = register_temporally(curve({}), rest, quick_options());
  CHECK(r.summary.energy_after <= r.summary.energy_before);
  CHECK(distance(r.warp, {}) < 1e-12);
}

TEST_CASE("a warp that nearly stops the clock and then hurries is recovered", "[elastic]") {
  const std::uint64_t seed = GENERATE(1u, 2u, 3u);
  const TimeWarp warp = random_time_warp(seed, 0.03, 4);
  const Curve first = curve({});
  CHECK(distance(register_temporally(first, warped(first, warp)).warp, inverse(warp)) < 1e-3);
}

TEST_CASE("what a warp costs pulls it to the identity by the closed form", "[elastic]") {
  // On the line q1 = sqrt(f), q2 = 1 and the cost p N (1 - sqrt(zeta'))^2 leave |sqrt(f) - sqrt(zeta')|^2 + p N |1 -
  // sqrt(zeta')|^2, least for zeta' proportional to (sqrt(f) + p N)^2. Both lengths are 1: N = 1.
  constexpr Index n = 201;
  Eigen::MatrixXd f(1, n);
  for (Index k = 0; k < n; ++k) f(0, k) = 1 + 0.6 * std::cos(2 * pi * double(k) / (n - 1));
  const Curve first(Eigen::VectorXd::Zero(1), f), second(Eigen::VectorXd::Zero(1), Eigen::MatrixXd::Ones(1, 9));
  TemporalOptions options;
  options.ridge = 0;
  options.penalty = GENERATE(0.0, 0.5, 3.0);
  const Eigen::ArrayXd root = f.row(0).transpose().array().sqrt() + options.penalty;
  const TimeWarp expected = TimeWarp::from_log_slope(2 * root.log());
  CHECK(distance(register_temporally(first, second, options).warp, expected) < 2e-5);
}

TEST_CASE("noise is not aligned where warps cost something", "[elastic]") {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  const auto noisy = [&] {
    Eigen::MatrixXd v(5, 65);
    for (Index k = 0; k < 65; ++k) {
      v.col(k) = velocity(double(k) / 64);
      for (Index i = 0; i < 5; ++i) v(i, k) += 0.15 * normal(random);
    }
    return Curve(Eigen::VectorXd::Zero(5), v);
  };
  const Curve a = noisy(), b = noisy();
  TemporalOptions options;
  const TemporalResult free = register_temporally(a, b, options);
  options.penalty = 3;
  const TemporalResult priced = register_temporally(a, b, options);
  CHECK(free.summary.min_slope < 0.7);
  CHECK(priced.summary.min_slope > 0.8);
  CHECK(distance(priced.warp, {}) < distance(free.warp, {}));
  CHECK(priced.summary.energy_after > free.summary.energy_after);
}

TEST_CASE("a motion cut off at 70 % is found in the whole one, from either side", "[elastic]") {
  const TimeWarp pace = random_time_warp(4, 0.6, 1.5);
  Eigen::MatrixXd v(5, 257);
  for (Index k = 0; k < 257; ++k) {
    const double t = double(k) / 256;
    v.col(k) = 0.7 * pace.slope(t) * velocity(0.7 * pace(t));
  }
  const Curve whole = curve({}), part(Eigen::VectorXd::Zero(5), v);
  TemporalOptions options;
  options.alignment = TemporalAlignment::partial;
  const TemporalResult a = register_temporally(part, whole, options), b = register_temporally(whole, part, options);
  CHECK(a.second.length == Approx(0.7).epsilon(1e-3));
  CHECK(a.first.length == 1);
  CHECK(distance(a.warp, pace) < 1e-3);
  CHECK(b.first.length == Approx(0.7).epsilon(1e-3));
  CHECK(b.second.length == 1);
  CHECK(distance(b.warp, inverse(pace)) < 1e-3);
  CHECK(b.first_time(0.5) == Approx(0.7 * pace(b.second_time(0.5))).epsilon(2e-3));

  options.alignment = TemporalAlignment::whole;
  const TemporalSummary summary = register_temporally(whole, part, options).summary;
  CHECK(summary.energy_after < summary.energy_before);
  CHECK(summary.advice.find("partial") == 0);
  options.search_grid = 0;
  CHECK(register_temporally(whole, part, options).summary.advice.empty());
}

TEST_CASE("whole motions of one pace stay whole in partial alignment", "[elastic]") {
  TemporalOptions options;
  options.alignment = TemporalAlignment::partial;
  const TimeWarp warp = random_time_warp(6, 0.5, 1.7);
  const TemporalResult r = register_temporally(curve({}), warped(curve({}), warp), options);
  CHECK(r.first.length == Approx(1).epsilon(1e-3));
  CHECK(r.second.length == Approx(1).epsilon(1e-3));
  CHECK(distance(r.warp, inverse(warp)) < 1e-3);
}

namespace {

/// A closed motion, `passes` times around from a phase.
Curve around(double phase, double passes, const TimeWarp& pace = {}) {
  Eigen::MatrixXd v(4, 513);
  for (Index k = 0; k < 513; ++k) {
    const double s = double(k) / 512, t = 2 * pi * (phase + passes * pace(s));
    v.col(k) << std::cos(t), std::sin(t) + 0.4 * std::cos(2 * t + 1), 0.5 * std::sin(3 * t), 0.3 * std::cos(2 * t);
    v.col(k) *= passes * pace.slope(s);
  }
  return {Eigen::VectorXd::Zero(4), v};
}

}  // namespace

TEST_CASE("a cycle that starts a third late is met at its phase", "[elastic]") {
  const TimeWarp pace = random_time_warp(8, 0.6, 1.5);
  const Curve first = around(0, 1, pace), second = around(1.0 / 3, 1);
  TemporalOptions options;
  options.alignment = TemporalAlignment::cyclic;
  const TemporalResult r = register_temporally(first, second, options);
  CHECK(r.second.begin == Approx(2.0 / 3).epsilon(1e-3));
  CHECK(r.second.length == 1);
  CHECK(distance(r.warp, pace) < 1e-3);
  CHECK(r.summary.energy_after < 1e-5 * r.summary.norm);

  const TemporalSummary summary = register_temporally(first, second).summary;
  CHECK(summary.energy_after > 0.05 * summary.norm);
  CHECK(summary.advice.find("cyclic") == 0);
}

TEST_CASE("two cycles are met with one, and one with two", "[elastic]") {
  TemporalOptions options;
  options.alignment = TemporalAlignment::cyclic;
  const Curve once = around(0, 1), twice = around(0, 2);
  const TemporalResult half = register_temporally(once, twice, options),
                       two = register_temporally(twice, once, options);
  CHECK(half.second.length == 0.5);
  CHECK(half.summary.energy_after < 1e-5 * half.summary.norm);
  CHECK(two.second.length == 2);
  CHECK(two.summary.energy_after < 1e-5 * two.summary.norm);
  CHECK(distance(two.warp, {}) < 1e-3);
  options.passes = 1;
  CHECK(register_temporally(once, twice, options).second.length == 1);
}

TEST_CASE("a step to slopes beyond what numbers hold is not taken, and is no error", "[elastic]") {
  const TemporalOptions options;
  const Curve first = curve({});
  const detail::TemporalProblem problem(first, first, detail::FreeWindow::none, 0, options);
  const auto steep = [](double c) { return detail::TemporalState{Eigen::VectorXd::Constant(1, c)}; };
  CHECK(problem.allowed(steep(1)));
  CHECK_FALSE(problem.allowed(steep(3)));
  CHECK_FALSE(problem.allowed(steep(50)));
  CHECK_FALSE(problem.allowed(steep(std::numeric_limits<double>::quiet_NaN())));
}

TEST_CASE("options out of their ranges are refused", "[elastic]") {
  TemporalOptions options;
  options.penalty = -1;
  CHECK_THROWS_AS(register_temporally(curve({}), curve({}), options), InvalidArgument);
  options = {};
  options.min_share = 0;
  CHECK_THROWS_AS(register_temporally(curve({}), curve({}), options), InvalidArgument);
  options = {};
  options.cosines.clear();
  CHECK_THROWS_AS(register_temporally(curve({}), curve({}), options), InvalidArgument);
}

TEST_CASE("curves of different dimensions are refused", "[elastic]") {
  const Curve flat(Eigen::VectorXd::Zero(2), Eigen::MatrixXd::Zero(2, 9));
  CHECK_THROWS_AS(register_temporally(flat, curve({})), InvalidArgument);
}

}  // namespace temporal_registration_test
