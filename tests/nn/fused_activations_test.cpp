#include "catch.hpp"

#include <dsns/nn/activations.hpp>

#include <cmath>
#include <limits>
#include <vector>

namespace fused_activations_test {

using namespace dsns;

namespace {

struct Column {
  Eigen::ArrayXf x, y, slope;

  Column(Activation activation, const Eigen::ArrayXf& at) : x(at), y(at), slope(at.size()) {
    activate<float>(activation, y, slope);
  }
};

/// Errors in units of the last place of single precision, relative to `exact`.
double ulps(float value, double exact) {
  return std::abs(double(value) - exact) / (std::abs(exact) * double(std::numeric_limits<float>::epsilon()));
}

}  // namespace

TEST_CASE("fused activations: softplus and its slope are relatively accurate, far to the left too", "[nn]") {
  const Column c(Activation::softplus, Eigen::ArrayXf::LinSpaced(100001, -87, 90));
  double worst = 0;
  for (Eigen::Index i = 0; i < c.x.size(); ++i) {
    const double x = double(c.x[i]);
    worst = std::max({worst, ulps(c.y[i], std::log1p(std::exp(x))), ulps(c.slope[i], 1 / (1 + std::exp(-x)))});
  }
  CHECK(worst < 4);
}

TEST_CASE("fused activations: SiLU is relatively accurate, its slope to the size of its terms", "[nn]") {
  const Column c(Activation::silu, Eigen::ArrayXf::LinSpaced(100001, -80, 90));
  double worst = 0, worst_slope = 0;
  for (Eigen::Index i = 0; i < c.x.size(); ++i) {
    const double x = double(c.x[i]), s = 1 / (1 + std::exp(-x));
    if (x != 0) worst = std::max(worst, ulps(c.y[i], x * s));
    const double error = std::abs(double(c.slope[i]) - s * (1 + x * (1 - s)));
    worst_slope = std::max(worst_slope, error / (s + std::abs(x) * s * (1 - s)));
  }
  CHECK(worst < 4);
  CHECK(worst_slope < 4 * double(std::numeric_limits<float>::epsilon()));
}

TEST_CASE("fused activations: every length gives what its entries give alone", "[nn]") {
  const auto activation = GENERATE(Activation::softplus, Activation::silu);
  for (Eigen::Index n = 0; n < 40; ++n) {
    const Eigen::ArrayXf x = Eigen::ArrayXf::LinSpaced(n, -3, 2);
    const Column all(activation, x);
    for (Eigen::Index i = 0; i < n; ++i) {
      const Column one(activation, x.segment(i, 1));
      CHECK(one.y[0] == all.y[i]);
      CHECK(one.slope[0] == all.slope[i]);
    }
  }
}

TEST_CASE("fused activations: what is not finite stays so, what is huge does not overflow", "[nn]") {
  const auto activation = GENERATE(Activation::softplus, Activation::silu);
  const float infinity = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  Eigen::ArrayXf x(4);
  x << nan, infinity, 1e30f, -1e30f;
  const Column c(activation, x);
  CHECK(std::isnan(c.y[0]));
  CHECK(c.y[1] == infinity);
  CHECK(c.y[2] == 1e30f);
  CHECK(c.slope[2] == 1);
  CHECK(std::abs(c.y[3]) < 1e-7f);
  CHECK(std::abs(c.slope[3]) < 1e-6f);
}

}  // namespace fused_activations_test
