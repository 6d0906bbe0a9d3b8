#include "catch.hpp"
#include "support/sphere_points.hpp"

#include <dsns/autodiff/jet2.hpp>
#include <dsns/sphere/harmonics.hpp>
#include <dsns/surface/jets.hpp>

namespace harmonics_test {

using namespace dsns;

namespace {

/// The poles, points so near them that z rounds to 1 or powers of x + iy underflow, and points in general position.
Mat3X hard_points() {
  const Mat3X s = test::sphere_points(20);
  Mat3X all(3, s.cols() + 7);
  all.leftCols(s.cols()) = s;
  all.rightCols(7) << 1e-160, 0, 1e-300, 1e-8, 1.5e-8, 1e-3, 1,  //
      0, 1e-160, 1e-308, 0, -1e-320, 1e-4, 1e-160,               //
      1, -1, 1, 1 - 1e-16, -1, -1, 1e-160;
  for (Index i = s.cols(); i < all.cols(); ++i) all.col(i).normalize();
  return all;
}

/// Y_lm by the textbook's sines and cosines of angles, in long double: the associated Legendre functions, normalised, by the
/// recurrence in l from sin^m, and dY/dcolatitude, dY/dlongitude from them. Not for the poles themselves.
struct Textbook {
  std::vector<long double> y, colatitude, longitude;
  Textbook(const Vec3d& point, int degree) {
    const Eigen::Matrix<long double, 3, 1> s = point.cast<long double>().normalized();
    const long double sine = std::hypot(s.x(), s.y()), v = std::atan2(s.y(), s.x()), four_pi = 16 * std::atan(1.0L);
    const auto count = std::size_t(harmonic_count(degree));
    y.resize(count);
    colatitude.resize(count);
    longitude.resize(count);
    std::vector<long double> p(std::size_t(degree + 1)), below(p.size());
    long double diagonal = 1 / std::sqrt(four_pi);
    for (int m = 0; m <= degree; ++m) {
      if (m > 0) diagonal *= sine * std::sqrt((2.0L * m + 1) / (2.0L * m));
      long double p0 = 0, p1 = diagonal;
      for (int l = m; l <= degree; ++l) {
        const long double n = l, o = m, factor = m > 0 ? std::sqrt(2.0L) : 1;
        // sin dP_lm/du = l z P_lm - sqrt((2l + 1)(l^2 - m^2)/(2l - 1)) P_(l-1)m
        const long double fall = l > m ? std::sqrt((2 * n + 1) * (n * n - o * o) / (2 * n - 1)) * p0 : 0;
        const long double du = factor * (n * s.z() * p1 - fall) / sine;
        const auto middle = std::size_t(l) * std::size_t(l) + std::size_t(l), step = std::size_t(m);
        y[middle - step] = factor * p1 * std::sin(o * v);
        colatitude[middle - step] = du * std::sin(o * v);
        longitude[middle - step] = factor * p1 * o * std::cos(o * v) / sine;
        y[middle + step] = factor * p1 * std::cos(o * v);
        colatitude[middle + step] = du * std::cos(o * v);
        longitude[middle + step] = -factor * p1 * o * std::sin(o * v) / sine;
        const long double a = std::sqrt((2 * n + 3) * (2 * n + 1) / ((n + 1 - o) * (n + 1 + o)));
        const long double b =
            l > m ? std::sqrt((2 * n + 3) * (n - o) * (n + o) / ((2 * n - 1) * (n + 1 - o) * (n + 1 + o))) : 0;
        const long double p2 = a * s.z() * p1 - b * p0;
        p0 = p1;
        p1 = p2;
      }
    }
  }
};

}  // namespace

TEST_CASE("harmonics are orthonormal", "[sphere]") {
  const int degree = GENERATE(0, 1, 12);
  const SphereQuadrature q = sphere_quadrature(degree + 1);
  const Eigen::MatrixXd y = harmonics(q.points, degree);
  const Eigen::MatrixXd gram = y.transpose() * q.weights.asDiagonal() * y;
  CHECK((gram - Eigen::MatrixXd::Identity(gram.rows(), gram.cols())).cwiseAbs().maxCoeff() < 1e-13);
}

TEST_CASE("zonal and sectoral harmonics of degree 128 are orthonormal", "[sphere]") {
  // All 16641 at once are a matrix of gigabytes; of one order those of all degrees tell whether the recurrence holds.
  constexpr int degree = 128;
  const GaussLegendre rule = gauss_legendre(degree + 1);
  Mat3X meridian = Mat3X::Zero(3, rule.nodes.size());
  meridian.row(2) = rule.nodes.transpose();
  meridian.row(0) = (1 - rule.nodes.array().square()).sqrt().matrix().transpose();
  const Eigen::MatrixXd y = harmonics(meridian, degree);
  for (const int m : {0, 1, 17, 64, 127, 128}) {
    Eigen::MatrixXd order(y.rows(), degree - m + 1);
    for (int l = m; l <= degree; ++l) order.col(l - m) = y.col(Index(l) * l + l + m);
    const Eigen::MatrixXd gram = (m > 0 ? pi : 2 * pi) * order.transpose() * rule.weights.asDiagonal() * order;
    CHECK((gram - Eigen::MatrixXd::Identity(gram.rows(), gram.cols())).cwiseAbs().maxCoeff() < 1e-12);
  }
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

TEST_CASE("harmonics of degree 128 and their gradients agree with long double, also near the poles", "[sphere]") {
  constexpr int degree = 128;
  const Mat3X s = hard_points();
  const ChartBatch c = charts_at(s);
  const HarmonicTangents h = harmonic_tangents(c, degree);
  double value = 0, slope = 0;
  for (Index i = 0; i < c.size(); ++i) {
    const Vec3d p = c.s.col(i);
    const double sine = std::hypot(p.x(), p.y());
    if (sine < 1e-12) continue;  // the textbook divides by it, and loses as many digits of the slopes
    const Textbook expected(p, degree);
    const Vec3d e_u = Vec3d(p.x() * p.z() / sine, p.y() * p.z() / sine, -sine), e_v(-p.y() / sine, p.x() / sine, 0);
    for (Index k = 0; k < h.y.cols(); ++k) {
      const Vec3d g = h.yu(i, k) * c.e1.col(i) + h.yv(i, k) * c.e2.col(i);
      const auto at = std::size_t(k);
      value = std::max(value, std::abs(h.y(i, k) - double(expected.y[at])));
      if (sine > 1e-4)
        slope = std::max({slope, std::abs(g.dot(e_u) - double(expected.colatitude[at])),
                          std::abs(g.dot(e_v) - double(expected.longitude[at]))});
    }
  }
  CHECK(value < 1e-11);
  CHECK(slope < 1e-9);
}

TEST_CASE("the addition theorem holds with first and second derivatives at degree 128, also at the poles", "[sphere]") {
  // sum_m Y_lm(s) Y_lm(t) = (2l + 1)/(4 pi) P_l(s . t); at t = s: sums of squares, of gradients and of Hessians
  constexpr int degree = 128;
  const ChartBatch c = charts_at(hard_points());
  const HarmonicJets h = harmonic_jets(c, degree);
  double worst = 0;
  for (const Eigen::MatrixXd* m : {&h.y, &h.yu, &h.yv, &h.yuu, &h.yuv, &h.yvv}) REQUIRE(m->allFinite());
  for (int l = 0; l <= degree; ++l) {
    const Index first = Index(l) * l, size = 2 * l + 1;
    const double n = double(l) * (l + 1), scale = double(size) / (4 * pi);
    const auto of = [&](const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) -> Eigen::VectorXd {
      return a.middleCols(first, size).cwiseProduct(b.middleCols(first, size)).rowwise().sum() / scale;
    };
    const auto compare = [&](const Eigen::VectorXd& found, double expected, double unit) {
      worst = std::max(worst, (found.array() - expected).abs().maxCoeff() / unit);
    };
    const double unit = std::max(n, 1.0), square = unit * unit;
    compare(of(h.y, h.y), 1, 1);
    compare(of(h.y, h.yu), 0, std::sqrt(unit));
    compare(of(h.yu, h.yu), n / 2, unit);  // P_l'(1) = l(l + 1)/2
    compare(of(h.yv, h.yv), n / 2, unit);
    compare(of(h.yu, h.yv), 0, unit);
    compare(of(h.y, h.yuu), -n / 2, unit);
    compare(of(h.yuu, h.yvv), n * (n + 2) / 8,
            square);  // of Y = sqrt(.) P_l(cos d): P_l = 1 - n d^2/4 + (3 n^2 - 2 n) d^4/192
    compare(of(h.yuu, h.yuu), n * (3 * n - 2) / 8, square);
    compare(of(h.yuv, h.yuv), n * (n - 2) / 8, square);
  }
  CHECK(worst < 1e-11);
}

TEST_CASE("the addition theorem holds between points", "[sphere]") {
  constexpr int degree = 128;
  const Mat3X s = hard_points();
  const Eigen::MatrixXd y = harmonics(s, degree);
  double worst = 0;
  for (Index i = 0; i < s.cols(); ++i)
    for (Index j = 0; j < s.cols(); ++j) {
      const double x = std::clamp(s.col(i).dot(s.col(j)), -1.0, 1.0);
      double below = 0, p = 1;
      for (int l = 0; l <= degree; ++l) {
        const Index first = Index(l) * l, size = 2 * l + 1;
        const double sum = y.row(i).segment(first, size).dot(y.row(j).segment(first, size));
        worst = std::max(worst, std::abs(sum * 4 * pi / double(size) - p));
        const double above = ((2 * l + 1) * x * p - l * below) / (l + 1);
        below = p;
        p = above;
      }
    }
  CHECK(worst < 1e-11);
}

TEST_CASE("harmonic derivatives agree with second-order jets, also at the poles", "[sphere]") {
  const int degree = GENERATE(0, 1, 2, 9, 40);
  const ChartBatch c = charts_at(hard_points());
  const HarmonicJets h = harmonic_jets(c, degree);
  double first = 0, second = 0, value = 0;
  for (Index i = 0; i < c.size(); ++i) {
    const auto y = harmonics(detail::chart_jet(c, i), degree);
    for (Index k = 0; k < y.size(); ++k) {
      value = std::max(value, std::abs(h.y(i, k) - y[k].f));
      first = std::max({first, std::abs(h.yu(i, k) - y[k].g[0]), std::abs(h.yv(i, k) - y[k].g[1])});
      second = std::max({second, std::abs(h.yuu(i, k) - y[k].h[0]), std::abs(h.yuv(i, k) - y[k].h[1]),
                         std::abs(h.yvv(i, k) - y[k].h[2])});
    }
  }
  const double n = degree + 1;
  CHECK(value < 1e-14 * n);
  CHECK(first < 1e-14 * n * n);
  CHECK(second < 1e-14 * n * n * n);
}

TEST_CASE("harmonics of any number of points, storage order and scalar are the same", "[sphere]") {
  using ByPoint = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  using FloatByPoint = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  constexpr int degree = 5;
  const ChartBatch all = charts_at(fibonacci_sphere(75).points);
  const HarmonicJets h = harmonic_jets(all, degree);
  for (const Index n : {0, 1, 3, 7, 8, 9, 33, 75}) {
    const ChartBatch c{all.s.leftCols(n), all.e1.leftCols(n), all.e2.leftCols(n)};
    const HarmonicJets some = harmonic_jets(c, degree, harmonic_jets(all, 2));
    CHECK(some.y == h.y.topRows(n));  // to the bit, whichever lanes the points are in
    CHECK(some.yvv == h.yvv.topRows(n));
    CHECK((harmonics(c.s, degree) - h.y.topRows(n)).norm() < 1e-13);
    CHECK((harmonic_tangents(c, degree).yv - h.yv.topRows(n)).norm() < 1e-12);
    const HarmonicJetsOf<ByPoint> rows = harmonic_jets<ByPoint>(c, degree);
    CHECK((rows.yu - h.yu.topRows(n)).norm() < 1e-12);
    CHECK((rows.yuv - h.yuv.topRows(n)).norm() < 1e-11);
    const HarmonicJetsOf<FloatByPoint> floats = harmonic_jets<FloatByPoint>(c, degree);
    CHECK((floats.yuu.cast<double>() - h.yuu.topRows(n)).norm() <= 2e-6 * (1 + h.yuu.norm()));
    CHECK((harmonics<Eigen::MatrixXf>(c.s, degree).cast<double>() - h.y.topRows(n)).norm() <= 1e-6 * (1 + h.y.norm()));
  }
  CHECK_THROWS_AS(harmonic_jets(all, -1), InvalidArgument);
}

TEST_CASE("sums of harmonics are the products with the basis", "[sphere]") {
  const int degree = GENERATE(0, 1, 6, 30);
  for (const Index n : {0, 1, 8, 27}) {
    const ChartBatch c = charts_at(hard_points().leftCols(n));
    const Eigen::MatrixX2d k = Eigen::MatrixX2d::Random(harmonic_count(degree), 2);
    const HarmonicJets h = harmonic_jets(c, degree);
    const FunctionJets<2> f = harmonic_sum_jets<2>(k, c);
    const double unit = 1e-14 * (degree + 1) * (degree + 1), n2 = degree * (degree + 1.0);
    CHECK((f.f.transpose() - h.y * k).norm() <= 10 * unit);
    CHECK((f.fu.transpose() - h.yu * k).norm() <= 10 * unit * (1 + degree));
    CHECK((f.fv.transpose() - h.yv * k).norm() <= 10 * unit * (1 + degree));
    CHECK((f.fuu.transpose() - h.yuu * k).norm() <= 10 * unit * (1 + n2));
    CHECK((f.fuv.transpose() - h.yuv * k).norm() <= 10 * unit * (1 + n2));
    CHECK((f.fvv.transpose() - h.yvv * k).norm() <= 10 * unit * (1 + n2));
    CHECK((harmonic_sum<2>(k, c.s) - f.f).norm() <= unit);
    CHECK((harmonic_sum_tangents<2>(k, c).fv - f.fv).norm() <= unit * (1 + degree));
  }
  CHECK_THROWS_AS(harmonic_sum<1>(Eigen::VectorXd::Zero(5), Mat3X(3, 0)), InvalidArgument);
}

TEST_CASE("coefficients come back from values at a quadrature", "[sphere]") {
  const Eigen::MatrixX2d k = Eigen::MatrixX2d::Random(harmonic_count(12), 2);
  const SphereQuadrature q = sphere_quadrature(13);
  const FunctionValues<2> values = harmonic_sum<2>(k, q.points);
  CHECK((harmonic_coefficients<2>(values, q, 12) - k).norm() < 1e-12);
  CHECK((harmonic_coefficients<2>(values, q, 4) - k.topRows(25)).norm() < 1e-12);
  CHECK_THROWS_AS(harmonic_coefficients<2>(values.leftCols(3), q, 4), InvalidArgument);
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
