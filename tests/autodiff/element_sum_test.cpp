#include "catch.hpp"

#include <dsns/autodiff/element_sum.hpp>
#include <dsns/autodiff/gradient.hpp>

#include <vector>

namespace element_sum_test {

using namespace dsns;

namespace {

const auto bending = [](const auto& x) { return sqr(sin(x[0]) * x[1] - x[2]) + exp(x[0] * x[2]); };

const std::vector<ElementSum<3>::Element> triples{{0, 1, 2}, {4, 2, 1}, {3, 4, 0}, {1, 2, 0}, {2, 3, 4}};

}  // namespace

TEST_CASE("element sum: value, gradient and Hessian are those of the whole function", "[autodiff]") {
  const Eigen::VectorXd x = (Eigen::VectorXd(5) << 0.3, -0.7, 0.9, 0.2, -0.4).finished();
  const ElementSum<3> sum(5, triples);
  const auto whole = [](const auto& v) {
    using V = typename std::decay_t<decltype(v)>::Scalar;
    V s(0);
    for (const auto& e : triples) s += bending(std::array<V, 3>{v[e[0]], v[e[1]], v[e[2]]});
    return s;
  };
  auto r = sum.second_order(bending, x);
  for (int repeat = 0; repeat < 2; ++repeat) {
    CHECK(r.value == Approx(whole(x)).epsilon(1e-14));
    CHECK(r.gradient.isApprox(gradient(whole, wrt(x), at(x)), 1e-13));
    CHECK(Eigen::MatrixXd(r.hessian).isApprox(hessian(whole, wrt(x), at(x)), 1e-13));
    sum.second_order(bending, x, r);  // once more into the same memory
  }
}

TEST_CASE("element sum: variables without an element, and wrong arguments", "[autodiff]") {
  const ElementSum<2> sum(4, {{0, 2}});
  const auto r = sum.second_order([](const auto& x) { return x[0] * x[1]; }, Eigen::Vector4d(1, 2, 3, 4));
  CHECK(r.gradient == Eigen::Vector4d(3, 0, 1, 0));
  CHECK(r.hessian.nonZeros() == 4);
  CHECK(r.hessian.coeff(0, 2) == 1);
  CHECK_THROWS_AS(ElementSum<2>(4, {{0, 4}}), InvalidArgument);
  CHECK_THROWS_AS(ElementSum<2>(4, {{-1, 0}}), InvalidArgument);
  CHECK_THROWS_AS(ElementSum<2>(4, {{1, 1}}), InvalidArgument);
  CHECK_THROWS_AS(sum.second_order([](const auto& x) { return x[0]; }, Eigen::Vector3d(1, 2, 3)), InvalidArgument);
}

}  // namespace element_sum_test
