#include "catch.hpp"
#include "support/sphere_points.hpp"

#include <dsns/autodiff/eigen.hpp>
#include <dsns/autodiff/jet2.hpp>
#include <dsns/surface/radial.hpp>

namespace radial_test {

using namespace dsns;

namespace {

/// Long in one tangent direction, short in the other, of many sizes: supports from a hundredth of the sphere to most of it.
RadialBasis crooked_basis(Index n) {
  const Mat3X centres = test::sphere_points(int(n) - 8);
  RadialBasis::Metrics metrics(9, n);
  for (Index j = 0; j < n; ++j) {
    const TangentFrame frame = tangent_frame(centres.col(j));
    const double length = 0.15 + 0.2 * double(j % 7), angle = 0.7 * double(j);
    const Vec3d along = std::cos(angle) * frame.e1 + std::sin(angle) * frame.e2, across = centres.col(j).cross(along);
    metrics.col(j) = Mat3(along * along.transpose() / length + across * across.transpose() * 3 / length +
                          centres.col(j) * centres.col(j).transpose() / (2 * length))
                         .reshaped();
  }
  return RadialBasis(centres, metrics);
}

Eigen::MatrixX3d waves(Index n) {
  Eigen::MatrixX3d c(n, 3);
  for (Index i = 0; i < c.size(); ++i) c.reshaped()[i] = std::sin(3.7 * double(i) + 1);
  return c;
}

/// phi as powers of r^2 and r^5, with derivatives by the scalar; r^5 is 0 with two derivatives at the centre.
template <class T>
T expanded_kernel(const T& q) {
  using std::sqrt;
  const T even = 1.0 + q * (-28.0 / 3 + q * (70.0 + q * (140.0 + q * (35.0 / 3))));
  if (!(q > 1e-200)) return even;
  const T r = sqrt(q);
  return even - q * q * r * (448.0 / 3 + 64.0 * q);
}
/// Every function at every point, without a tree.
Vec3<Jet2<double, 2>> sum_of_all(const RadialBasis& basis, const Eigen::MatrixX3d& c, const Vec3<Jet2<double, 2>>& s) {
  using T = Jet2<double, 2>;
  Vec3<T> sum(T(0.0), T(0.0), T(0.0));
  for (Index j = 0; j < basis.size(); ++j) {
    T q(0.0);
    for (int k = 0; k < 3; ++k) {
      T x(0.0);
      for (int l = 0; l < 3; ++l) x += basis.metric(j)(k, l) * (s[l] - basis.centres()(l, j));
      q += x * x;
    }
    if (q.f >= 1) continue;
    const T phi = expanded_kernel(q);
    for (int k = 0; k < 3; ++k) sum[k] += c(j, k) * phi;
  }
  return sum;
}

/// One function whose support is a cap of chord `radius` around the north pole.
RadialSurface cap(double radius) {
  RadialBasis::Metrics metric(9, 1);
  metric.col(0) = (Mat3::Identity() / radius).reshaped();
  return RadialSurface(RadialBasis(Mat3X(Vec3d(0, 0, 1)), metric), Eigen::RowVector3d(1, 2, -3));
}

}  // namespace

TEST_CASE("sums of local functions have the jets of the scalar path, at centres and poles too", "[surface]") {
  const RadialBasis basis = crooked_basis(60);
  const Eigen::MatrixX3d c = waves(60);
  const RadialSurface f(basis, c);
  Mat3X s(3, 260);  // the centres, and points between them
  s << basis.centres(), test::sphere_points(192);
  const ChartBatch charts = charts_at(s);
  const SurfaceJets batch = jets(f, charts);
  const SurfaceTangents first = tangents(f, charts);
  const Mat3X values = positions(f, s);
  for (Index i = 0; i < charts.size(); ++i) {
    const auto p = sum_of_all(basis, c, detail::chart_jet(charts, i));
    for (int k = 0; k < 3; ++k) {
      CHECK(batch.f(k, i) == Approx(p[k].f).margin(1e-12));
      CHECK(values(k, i) == Approx(p[k].f).margin(1e-12));
      CHECK(batch.fu(k, i) == Approx(p[k].g[0]).margin(1e-10));
      CHECK(first.fu(k, i) == Approx(p[k].g[0]).margin(1e-10));
      CHECK(first.fv(k, i) == Approx(p[k].g[1]).margin(1e-10));
      CHECK(batch.fuu(k, i) == Approx(p[k].h[0]).margin(1e-8));
      CHECK(batch.fuv(k, i) == Approx(p[k].h[1]).margin(1e-8));
      CHECK(batch.fvv(k, i) == Approx(p[k].h[2]).margin(1e-8));
    }
  }
}

TEST_CASE("jets of local functions are the limits of differences in the chart", "[surface]") {
  const RadialSurface f(crooked_basis(40), waves(40));
  const ChartBatch c = charts_at(test::sphere_points());
  const SurfaceJets j = jets(f, c);
  const double h = 1e-4;
  const auto moved = [&](Index i, double u, double v) {
    const Vec3d step = u * c.e1.col(i) + v * c.e2.col(i);
    const double length = step.norm();
    return f(std::cos(length) * c.s.col(i) + std::sin(length) / length * step);
  };
  for (Index i = 0; i < c.size(); ++i) {
    const Vec3d here = f(c.s.col(i)), fu = (moved(i, h, 0) - moved(i, -h, 0)) / (2 * h),
                fvv = (moved(i, 0, h) - 2 * here + moved(i, 0, -h)) / (h * h),
                fuv = (moved(i, h, h) - moved(i, h, -h) - moved(i, -h, h) + moved(i, -h, -h)) / (4 * h * h);
    CHECK((j.fu.col(i) - fu).norm() < 1e-4 * (1 + fu.norm()));
    CHECK((j.fvv.col(i) - fvv).norm() < 1e-3 * (1 + fvv.norm()));
    CHECK((j.fuv.col(i) - fuv).norm() < 1e-3 * (1 + fuv.norm()));
  }
}

TEST_CASE("a local function is 1 at its centre, bends there by 56/3, and joins 0 with all its derivatives",
          "[surface]") {
  const double radius = 0.5;
  const RadialSurface f = cap(radius);
  const SurfaceJets centre = jets(f, charts_at(Mat3X(Vec3d(0, 0, 1))));
  CHECK((centre.f - Vec3d(1, 2, -3)).norm() == 0);
  CHECK(centre.fu.norm() == 0);
  // phi = 1 - 28/3 r^2 + ..., and the chord's square grows as u^2.
  CHECK((centre.fuu + 56.0 / 3 / (radius * radius) * Vec3d(1, 2, -3)).norm() < 1e-12);
  CHECK((centre.fvv - centre.fuu).norm() < 1e-12);

  for (const double inside : {1e-3, 1e-6, -1e-6, -0.3}) {  // of the support's edge, on the chord
    const double chord = radius * (1 - inside), angle = 2 * std::asin(chord / 2);
    const SurfaceJets j = jets(f, charts_at(Mat3X(spherical_point(angle, 0.4))));
    const double d = std::max(0.0, inside);
    CHECK(j.f.norm() <= 70 * std::pow(d, 6));
    CHECK(j.fu.norm() + j.fv.norm() <= 1e3 * std::pow(d, 5));
    CHECK(j.fuu.norm() + j.fuv.norm() + j.fvv.norm() <= 1e5 * std::pow(d, 4));
  }
}

TEST_CASE("a local function is positive inside its ellipsoid and 0 outside, whatever the tree leaves out",
          "[surface]") {
  const Index n = 200;
  const RadialBasis basis = crooked_basis(n);
  const Mat3X s = test::sphere_points(100);
  const Eigen::MatrixXd values = radial_sum<Eigen::Dynamic>(basis, Eigen::MatrixXd::Identity(n, n), s);
  for (Index i = 0; i < s.cols(); ++i)
    for (Index j = 0; j < n; ++j)
      CHECK((values(j, i) > 0) == ((basis.metric(j) * (s.col(i) - basis.centres().col(j))).norm() < 1));
}

TEST_CASE("sums of local functions do not depend on the company of a point", "[surface]") {
  const RadialSurface f(crooked_basis(80), waves(80));
  const Mat3X s = test::sphere_points(300);
  const Mat3X all = positions(f, s);
  for (Index i = 0; i < s.cols(); ++i) CHECK((f(s.col(i)) - all.col(i)).norm() < 1e-13);
  CHECK(positions(f, Mat3X(3, 0)).cols() == 0);
  CHECK(positions(RadialSurface(RadialBasis(), Eigen::MatrixX3d(0, 3)), s) == Mat3X::Zero(3, s.cols()));
}

TEST_CASE("an unusable basis of local functions is refused", "[surface]") {
  const Mat3X centre = Vec3d(0, 0, 1);
  const RadialBasis::Metrics metric = Mat3(Mat3::Identity()).reshaped();
  CHECK_THROWS_AS(RadialBasis(2 * centre, metric), InvalidArgument);
  CHECK_THROWS_AS(RadialBasis(centre, RadialBasis::Metrics(9, 2)), InvalidArgument);
  CHECK_THROWS_AS(RadialBasis(centre, RadialBasis::Metrics::Zero(9, 1)), InvalidArgument);
  CHECK_THROWS_AS(RadialSurface(RadialBasis(centre, metric), Eigen::MatrixX3d(2, 3)), InvalidArgument);
}

}  // namespace radial_test
