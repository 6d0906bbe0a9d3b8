#include "catch.hpp"

#include <dsns/autodiff/dual.hpp>
#include <dsns/autodiff/jet2.hpp>
#include <dsns/nn/activations.hpp>

#include <limits>

namespace activations_test {

using namespace dsns;

TEMPLATE_TEST_CASE("activations: columns equal the scalar path with derivatives up to the third", "[nn]", float,
                   double) {
  using T = TestType;
  const auto activation = GENERATE(Activation::softplus, Activation::silu, Activation::tanh, Activation::sine);
  const T tolerance = 8 * std::numeric_limits<T>::epsilon();
  Eigen::ArrayX<T> x = Eigen::ArrayX<T>::LinSpaced(401, T(-60), T(60));
  x.head(4) << T(-800), T(800), T(0), T(1e-4);
  Eigen::ArrayX<T> y = x, slope(x.size()), y2 = x, slope2(x.size()), bend(x.size());
  Eigen::ArrayX<T> y3 = x, slope3(x.size()), bend3(x.size()), third(x.size());
  activate<T>(activation, y, slope);
  activate<T>(activation, y2, slope2, bend);
  activate<T>(activation, y3, slope3, bend3, third);
  T worst = 0;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    using Third = Dual<Jet2<T, 1>, 1>;
    const Third jet3 = activate(activation, Third::variable(Jet2<T, 1>::variable(x[i], 0), 0));
    const auto& jet = jet3.f;
    const T scale = std::max(T(1), std::abs(x[i]));
    const T errors[] = {y[i] - jet.f,         slope[i] - jet.g[0], y2[i] - jet.f,
                        slope2[i] - jet.g[0], bend[i] - jet.h[0],  y3[i] - jet.f,
                        slope3[i] - jet.g[0], bend3[i] - jet.h[0], third[i] - jet3.g[0].h[0]};
    for (const T error : errors) worst = std::abs(error) / scale > worst ? std::abs(error) / scale : worst;
    CHECK(std::isfinite(y[i] + slope[i] + bend[i] + third[i]));
  }
  CHECK(worst <= tolerance);
}

}  // namespace activations_test
