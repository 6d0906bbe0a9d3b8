#include "catch.hpp"
#include "support/sphere_points.hpp"

#include <dsns/autodiff/jet2.hpp>
#include <dsns/sphere/harmonics.hpp>
#include <dsns/surface/jets.hpp>

namespace harmonics_test {

using namespace dsns;

TEST_CASE("harmonics are orthonormal", "[sphere]") {
  constexpr int degree = 12;
  const SphereQuadrature q = sphere_quadrature(degree + 1);
  const Eigen::MatrixXd y = harmonics(q.points, degree);
  const Eigen::MatrixXd gram = y.transpose() * q.weights.asDiagonal() * y;
  CHECK((gram - Eigen::MatrixXd::Identity(gram.rows(), gram.cols())).cwiseAbs().maxCoeff() < 1e-13);
}

TEST_CASE("low harmonics are the textbook's", "[sphere]") {
  const Mat3X s = test::sphere_points();
  const Eigen::MatrixXd y = harmonics(s, 2);
  const double one = std::sqrt(3 / (4 * pi)), two = std::sqrt(15 / (4 * pi));
  for (Index i = 0; i < s.cols(); ++i) {
    CHECK(y(i, 0) == Approx(std::sqrt(1 / (4 * pi))));
    CHECK(y(i, 1) == Approx(one * s(1, i)).margin(1e-15));
    CHECK(y(i, 2) == Approx(one * s(2, i)).margin(1e-15));
    CHECK(y(i, 3) == Approx(one * s(0, i)).margin(1e-15));
    CHECK(y(i, 4) == Approx(two * s(0, i) * s(1, i)).margin(1e-15));
    CHECK(y(i, 6) == Approx(std::sqrt(5 / (16 * pi)) * (3 * s(2, i) * s(2, i) - 1)).margin(1e-15));
    CHECK(y(i, 8) == Approx(two / 2 * (s(0, i) * s(0, i) - s(1, i) * s(1, i))).margin(1e-15));
  }
}

TEST_CASE("harmonic derivatives agree with second-order jets, also at the poles", "[sphere]") {
  constexpr int degree = 9;
  const ChartBatch c = charts_at(test::sphere_points());
  const HarmonicJets h = harmonic_jets(c.s, degree);
  double first = 0, second = 0, value = 0;
  for (Index i = 0; i < c.size(); ++i) {
    const auto y = harmonics(detail::chart_jet(c, i), degree);
    const Vec3d a = c.e1.col(i), b = c.e2.col(i), s = c.s.col(i);
    for (Index k = 0; k < y.size(); ++k) {
      const Vec3d g(h.dx(i, k), h.dy(i, k), h.dz(i, k));
      Mat3 H;
      H << h.dxx(i, k), h.dxy(i, k), h.dxz(i, k), h.dxy(i, k), h.dyy(i, k), h.dyz(i, k), h.dxz(i, k), h.dyz(i, k),
          h.dzz(i, k);
      value = std::max(value, std::abs(h.y(i, k) - y[k].f));
      first = std::max({first, std::abs(g.dot(a) - y[k].g[0]), std::abs(g.dot(b) - y[k].g[1])});
      second = std::max({second, std::abs(a.dot(H * a) - g.dot(s) - y[k].h[0]), std::abs(a.dot(H * b) - y[k].h[1]),
                         std::abs(b.dot(H * b) - g.dot(s) - y[k].h[2])});
    }
  }
  CHECK(value < 1e-14);
  CHECK(first < 1e-12);
  CHECK(second < 1e-11);
}

TEST_CASE("harmonics are eigenfunctions of the Laplacian of the sphere", "[sphere]") {
  constexpr int degree = 6;
  const ChartBatch c = charts_at(test::sphere_points());
  const Eigen::ArrayXd l = harmonic_degrees(degree);
  for (Index i = 0; i < c.size(); ++i) {
    const auto y = harmonics(detail::chart_jet(c, i), degree);
    for (Index k = 0; k < y.size(); ++k)
      CHECK(y[k].h[0] + y[k].h[2] == Approx(-l[k] * (l[k] + 1) * y[k].f).margin(1e-11));
  }
}

}  // namespace harmonics_test
