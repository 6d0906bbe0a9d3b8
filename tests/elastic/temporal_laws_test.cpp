#include "catch.hpp"

#include <dsns/elastic/geodesic.hpp>
#include <dsns/elastic/temporal_registration.hpp>

namespace temporal_laws_test {

using namespace dsns;

namespace {

Curve motion(double other) {
  Eigen::MatrixXd v(4, 257);
  for (Index k = 0; k < 257; ++k) {
    const double t = double(k) / 256;
    for (int i = 0; i < 4; ++i)
      v(i, k) = std::cos((i + 1.5 + 0.2 * other) * pi * t + 0.7 * i * i) / (i + 1) + 0.3 * std::sin(4 * pi * t + i) +
                0.2 * other * std::cos(3 * t + i);
  }
  return {Eigen::VectorXd::Zero(4), v};
}

double length_of(const Curve& a) { return squared_norm(warped_srvf(a, {}, time_grid()), time_grid()); }

}  // namespace

TEST_CASE("law: the energy is the same for the curves exchanged and the warp inverted", "[law][elastic]") {
  const std::uint64_t seed = GENERATE(1u, 2u, 3u);
  const Curve a = motion(0), b = motion(1);
  const TimeWarp warp = random_time_warp(seed, 0.4, 1.9);
  CHECK(elastic_energy(a, b, warp) == Approx(elastic_energy(b, a, inverse(warp))).epsilon(1e-6));
  // Against the integral over the first's own time, of which it is a substitution.
  const TimeGrid grid = time_grid(4000);
  const double direct = squared_norm(warped_srvf(a, {}, grid) - warped_srvf(b, warp, grid), grid);
  CHECK(elastic_energy(a, b, warp) == Approx(direct).epsilon(1e-5));
}

TEST_CASE("law: the distance is symmetric", "[law][elastic]") {
  const double other = GENERATE(0.3, 1.0, 2.0);
  const Curve a = motion(0), b = warped(motion(other), random_time_warp(5, 0.5, 1.7));
  const TemporalResult there = register_temporally(a, b), back = register_temporally(b, a);
  CHECK(there.summary.energy_after == back.summary.energy_after);
  CHECK(distance(there.warp, inverse(back.warp)) < 1e-5);
  CHECK(CurveGeodesic(a, b, there.warp).distance() == Approx(CurveGeodesic(b, a, back.warp).distance()).epsilon(1e-6));
}

TEST_CASE("law: a warped copy is at distance zero", "[law][elastic]") {
  const std::uint64_t seed = GENERATE(1u, 2u, 3u);
  const Curve a = motion(0), b = warped(a, random_time_warp(seed, 0.3, 2));
  CHECK(elastic_energy(a, b, TimeWarp()) > 0.01 * length_of(a));
  CHECK(register_temporally(a, b).summary.energy_after < 1e-6 * length_of(a));
}

TEST_CASE("law: a common warp changes no distance", "[law][elastic]") {
  const Curve a = motion(0), b = motion(1);
  const double energy = register_temporally(a, b).summary.energy_after;
  const TimeWarp common = random_time_warp(GENERATE(1u, 2u), 0.5, 1.7);
  const Curve a2 = warped(a, common), b2 = warped(b, common);
  CHECK(elastic_energy(a2, b2, TimeWarp()) == Approx(elastic_energy(a, b, TimeWarp())).epsilon(1e-5));
  CHECK(std::sqrt(register_temporally(a2, b2).summary.energy_after) == Approx(std::sqrt(energy)).epsilon(1e-4));
}

TEST_CASE("law: the SRVF and its inverse are a round trip", "[law][elastic]") {
  const TimeGrid grid = time_grid();
  const TimeWarp warp = random_time_warp(GENERATE(1u, 2u, 3u), 0.5, 1.7);
  const Curve a = motion(0);
  const Eigen::MatrixXd q = warped_srvf(a, warp, grid);
  const Eigen::MatrixXd again = warped_srvf(curve_of_srvf(a.start(), q), {}, grid);
  CHECK((q - again).norm() < 1e-12 * q.norm());
  CHECK((curve_of_srvf(a.start(), q).end() - a.end()).norm() < 1e-4);
}

}  // namespace temporal_laws_test
