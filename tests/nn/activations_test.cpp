#include "catch.hpp"

#include <dsns/autodiff/jet2.hpp>
#include <dsns/nn/activations.hpp>

#include <limits>

namespace activations_test {

using namespace dsns;

TEMPLATE_TEST_CASE("activations: columns equal the scalar path with first and second derivatives", "[nn]", float,
                   double) {
  using T = TestType;
  const auto activation = GENERATE(Activation::softplus, Activation::silu, Activation::tanh);
  const T tolerance = 8 * std::numeric_limits<T>::epsilon();
  Eigen::ArrayX<T> x = Eigen::ArrayX<T>::LinSpaced(401, T(-60), T(60));
  x.head(4) << T(-800), T(800), T(0), T(1e-4);
  Eigen::ArrayX<T> y = x, slope(x.size()), y2 = x, slope2(x.size()), bend(x.size());
  activate<T>(activation, y, slope);
  activate<T>(activation, y2, slope2, bend);
  T worst = 0;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const auto jet = activate(activation, Jet2<T, 1>::variable(x[i], 0));
    const T scale = std::max(T(1), std::abs(x[i]));
    const T errors[] = {y[i] - jet.f, slope[i] - jet.g[0], y2[i] - jet.f, slope2[i] - jet.g[0], bend[i] - jet.h[0]};
    for (const T error : errors) worst = std::abs(error) / scale > worst ? std::abs(error) / scale : worst;
    CHECK(std::isfinite(y[i] + slope[i] + bend[i]));
  }
  CHECK(worst <= tolerance);
}

}  // namespace activations_test
