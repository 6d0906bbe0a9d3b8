#include "catch.hpp"

#include <dsns/stats/karcher_mean.hpp>

namespace karcher_mean_test {

using namespace dsns;

namespace {

Curve warped(const TimeWarp& warp, double size) {
  constexpr Index n = 129;
  Eigen::MatrixXd v(3, n);
  for (Index k = 0; k < n; ++k) {
    const double t = double(k) / (n - 1), z = warp(t);
    v.col(k) << std::cos(3 * z), std::sin(5 * z + 1), 0.5 * std::cos(7 * z);
    v.col(k) *= size * warp.slope(t);
  }
  return {Eigen::Vector3d(0, size, 0), v};
}

}  // namespace

TEST_CASE("copies of one curve under known warps are brought together and centred", "[stats]") {
  std::vector<Curve> curves;
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) curves.push_back(warped(random_warp(seed, 0.4), 1));
  KarcherOptions options;
  options.temporal.grid = 100;
  options.temporal.cosines = {8, 16};
  options.iterations = 4;
  const KarcherMean mean = karcher_mean(curves, options);
  const auto& energy = mean.summary.energy;
  INFO("energy from " << energy.front() << " to " << energy.back());
  CHECK(energy.back() < 1e-3 * energy.front());
  for (std::size_t k = 1; k < energy.size(); ++k) CHECK(energy[k] <= energy[k - 1]);
  CHECK(mean.summary.min_slope > 0);
  CHECK(distance(karcher_mean(mean.warps), {}) < 1e-3);
}

TEST_CASE("the mean of one curve is the curve", "[stats]") {
  const std::vector<Curve> one{warped(random_warp(5, 0.3), 1)};
  const KarcherMean mean = karcher_mean(one);
  const TimeGrid grid = time_grid();
  CHECK(squared_norm(mean.q - warped_srvf(one[0], {}, grid), grid) < 1e-12);
  CHECK(mean.start == one[0].start());
  CHECK(mean.summary.converged);
  CHECK_THROWS_AS(karcher_mean(std::vector<Curve>{}), InvalidArgument);
}

TEST_CASE("the mean of two sizes of one motion is between them", "[stats]") {
  const std::vector<Curve> two{warped({}, 1), warped({}, 2)};
  const KarcherMean mean = karcher_mean(two);
  CHECK(mean.start.y() == Approx(1.5));
  const TimeGrid grid = time_grid();
  const double a = squared_norm(warped_srvf(two[0], {}, grid), grid);
  // q scales with the root of the size: the mean's length is ((1 + sqrt 2) / 2)^2 of the first's
  CHECK(squared_norm(mean.q, grid) == Approx(a * std::pow((1 + std::sqrt(2.0)) / 2, 2)).epsilon(1e-3));
}

TEST_CASE("a weight of three counts like three copies, a weight of 0 not at all", "[stats]") {
  const TimeGrid grid = time_grid();
  const Curve a = warped({}, 1), b = warped(random_warp(2, 0.3), 1.2), c = warped(random_warp(3, 0.3), 5);
  KarcherOptions weighted;
  weighted.weights = {3, 1, 0};
  const KarcherMean by_weight = karcher_mean(std::vector{a, b, c}, weighted),
                    by_copies = karcher_mean(std::vector{a, a, a, b});
  CHECK(squared_norm(by_weight.q - by_copies.q, grid) < 1e-8 * squared_norm(by_copies.q, grid));
  CHECK((by_weight.start - by_copies.start).norm() < 1e-12);
  CHECK(by_weight.summary.energy.back() == Approx(by_copies.summary.energy.back()).epsilon(1e-4));
  weighted.weights = {1, 1};
  CHECK_THROWS_AS(karcher_mean(std::vector{a, b, c}, weighted), InvalidArgument);
  weighted.weights = {1, 1, -1};
  CHECK_THROWS_AS(karcher_mean(std::vector{a, b, c}, weighted), InvalidArgument);
}

TEST_CASE("an outlier moves the mean, and hardly the median", "[stats]") {
  std::vector<Curve> curves;
  for (const double size : {0.98, 0.99, 1.0, 1.01, 1.02, 4.0}) curves.push_back(warped({}, size));
  KarcherOptions options;
  options.centre = KarcherCentre::median;
  const KarcherMean mean = karcher_mean(curves), median = karcher_mean(curves, options);
  CHECK(mean.start.y() == Approx(1.5));
  // On a line, the median of six sizes is between the third and the fourth; here q goes with the root of the size.
  CHECK(median.start.y() > 0.99);
  CHECK(median.start.y() < 1.02);
  const auto& energy = median.summary.energy;
  for (std::size_t k = 1; k < energy.size(); ++k) CHECK(energy[k] <= energy[k - 1]);
}

TEST_CASE("one more curve changes the mean as if all were averaged anew", "[stats]") {
  const TimeGrid grid = time_grid();
  std::vector<Curve> curves;
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u, 5u})
    curves.push_back(warped(random_warp(seed, 0.3), 1 + 0.1 * double(seed)));
  const Curve last = curves.back();
  const KarcherMean all = karcher_mean(curves);
  curves.pop_back();
  const KarcherMean one_more = with_one_more(karcher_mean(curves), last);
  CHECK(one_more.warps.size() == 5);
  CHECK(squared_norm(one_more.q - all.q, grid) < 1e-5 * squared_norm(all.q, grid));
  CHECK((one_more.start - all.start).norm() < 1e-12);
  CHECK(one_more.summary.energy.back() == Approx(all.summary.energy.back()).epsilon(0.01));
  CHECK(distance(karcher_mean(one_more.warps), {}) < 1e-3);
  CHECK_THROWS_AS(with_one_more(all, Curve(Eigen::VectorXd::Zero(2), Eigen::MatrixXd::Zero(2, 3))), InvalidArgument);
}

}  // namespace karcher_mean_test
