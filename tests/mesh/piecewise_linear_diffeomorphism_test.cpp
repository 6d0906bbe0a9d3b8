#include <dsns/mesh/piecewise_linear_diffeomorphism.hpp>
#include <dsns/surface/adapters.hpp>
#include <dsns/surface/quadrics.hpp>

#include "catch.hpp"
#include "support/bodies.hpp"
#include "support/sphere_points.hpp"
#include "support/sphere_warps.hpp"

namespace piecewise_linear_diffeomorphism_test {

using namespace dsns;

static_assert(SphereMap<PiecewiseLinearDiffeomorphism>);
static_assert(Surface<PiecewiseLinearDiffeomorphism>);

namespace {

/// Draws points together towards the south pole: Jacobians from (1 - k)/(1 + k) to its inverse.
Mat3X moebius(const Mat3X& s, double k) {
  Mat3X y(3, s.cols());
  for (Index i = 0; i < s.cols(); ++i) {
    const double z = (s(2, i) - k) / (1 - k * s(2, i)), factor = std::sqrt(1 - k * k) / (1 - k * s(2, i));
    y.col(i) = Vec3d(factor * s(0, i), factor * s(1, i), z).normalized();
  }
  return y;
}

/// Turns each parallel about the axis, by `angle` z.
Mat3X twisted(const Mat3X& s, double angle) {
  Mat3X y(3, s.cols());
  for (Index i = 0; i < s.cols(); ++i) y.col(i) = rotation_exp(Vec3d(0, 0, angle * s(2, i))) * s.col(i);
  return y.colwise().normalized();
}

std::vector<PiecewiseLinearDiffeomorphism> maps() {
  const TriangleMesh ico = icosphere(3);
  return {PiecewiseLinearDiffeomorphism(2),
          piecewise_linear(test::turned_warp(3, 8, 10, Vec3d(0.4, -1, 0.3)), ico).map,
          {ico, moebius(ico.vertices, 0.8)},
          {ico, twisted(ico.vertices, 1.5)},
          {latitude_longitude_sphere(7, 12), moebius(latitude_longitude_sphere(7, 12).vertices, -0.7)}};
}

Mat3X some_points() {
  Mat3X s(3, 248);
  s << test::sphere_points(), test::random_unit_vectors(200, 5);
  return s;
}

}  // namespace

TEST_CASE("piecewise-linear map: images of vertices and of points of edges", "[mesh]") {
  for (const auto& gamma : maps()) {
    CHECK((gamma(gamma.vertices()) - gamma.images()).cwiseAbs().maxCoeff() < 1e-14);
    for (Index f = 0; f < gamma.faces().cols(); f += 7) {
      const int a = gamma.faces()(0, f), b = gamma.faces()(1, f);
      const Vec3d s = (0.3 * gamma.vertices().col(a) + 0.7 * gamma.vertices().col(b)).normalized();
      const Vec3d y = (0.3 * gamma.images().col(a) + 0.7 * gamma.images().col(b)).normalized();
      CHECK((gamma(s) - y).norm() < 1e-13);
    }
  }
}

TEST_CASE("piecewise-linear map: the error of a sampled map falls as the square of the edge", "[mesh]") {
  const SphereDiffeomorphism gamma = test::turned_warp(3, 8, 10, Vec3d(0.4, -1, 0.3));
  const SphereQuadrature q = fibonacci_sphere(1500);
  double coarser = 0;
  for (int level = 2; level <= 5; ++level) {
    const SampledSphereMap sampled = piecewise_linear(gamma, icosphere(level));
    const double error = angular_distance(sampled.map, gamma, q).rms;
    CHECK(sampled.error.rms == Approx(error).epsilon(0.3));
    CHECK(sampled.error.largest > sampled.error.rms);
    if (level > 2) CHECK(coarser / error == Approx(4).margin(0.3));
    coarser = error;
  }
  CHECK(coarser < 0.015 * pi / 180);
}

TEST_CASE("piecewise-linear map: the inverse brings points back", "[mesh]") {
  const Mat3X s = some_points();
  for (const auto& gamma : maps()) {
    CHECK((gamma.inverse(gamma(s)) - s).cwiseAbs().maxCoeff() < 1e-12);
    CHECK((gamma(gamma.inverse(s)) - s).cwiseAbs().maxCoeff() < 1e-12);
    CHECK((gamma.inverse()(s) - gamma.inverse(s)).cwiseAbs().maxCoeff() == 0);
    CHECK((gamma.inverse().images() - gamma.vertices()).cwiseAbs().maxCoeff() == 0);
  }
}

TEST_CASE("piecewise-linear map: the differential is that of its jets", "[mesh]") {
  const ChartBatch c = charts_at(test::random_unit_vectors(100, 8));
  for (const auto& gamma : maps()) {
    const SphereDisplacement d = gamma.displacement(c);
    CHECK((gamma(c.s) - d.y).cwiseAbs().maxCoeff() < 1e-14);
    const SurfaceTangents t = tangents(gamma, c);
    CHECK((t.f - d.y).cwiseAbs().maxCoeff() < 1e-13);
    CHECK((t.fu - d.y1).cwiseAbs().maxCoeff() < 1e-11);
    CHECK((t.fv - d.y2).cwiseAbs().maxCoeff() < 1e-11);
    for (Index i = 0; i < c.size(); ++i)
      CHECK(d.J[i] == Approx(d.y.col(i).dot(Vec3d(d.y1.col(i)).cross(Vec3d(d.y2.col(i))))).epsilon(1e-10));
  }
}

TEST_CASE("piecewise-linear map: over a face the Jacobian integrates to the image's area", "[mesh]") {
  const TriangleMesh ico = icosphere(1);
  const PiecewiseLinearDiffeomorphism gamma(ico, moebius(ico.vertices, 0.5));
  constexpr int parts = 6;
  double sum = 0;
  for (Index f = 0; f < gamma.faces().cols(); ++f) {
    Mat3 P, Y;
    for (int k = 0; k < 3; ++k) {
      P.col(k) = gamma.vertices().col(gamma.faces()(k, f));
      Y.col(k) = gamma.images().col(gamma.faces()(k, f));
    }
    double integral = 0;
    const auto add = [&](int i, int j, int turned) {
      const auto at = [&](int a, int b) -> Vec3d { return (P * Vec3d(parts - a - b, a, b)).normalized(); };
      const Vec3d p = turned ? at(i + 1, j + 1) : at(i, j), q = turned ? at(i, j + 1) : at(i + 1, j),
                  r = turned ? at(i + 1, j) : at(i, j + 1);
      const Mat3X centre = (p + q + r).normalized();
      integral += spherical_area(p, q, r) * gamma.displacement(charts_at(centre)).J[0];
    };
    for (int i = 0; i < parts; ++i)
      for (int j = 0; i + j < parts; ++j) {
        add(i, j, 0);
        if (i + j + 1 < parts) add(i, j, 1);
      }
    CHECK(integral == Approx(spherical_area(Y.col(0), Y.col(1), Y.col(2))).epsilon(0.01));
    sum += integral;
  }
  CHECK(sum == Approx(4 * pi).epsilon(0.002));
}

TEST_CASE("piecewise-linear map: the certificate bounds the Jacobian from below, closely", "[mesh]") {
  for (const auto& gamma : maps()) {
    const double bound = certify(gamma).min_jacobian, found = min_jacobian(gamma, fibonacci_sphere(20000).points);
    CHECK(bound > 0);
    CHECK(bound <= found * (1 + 1e-12));
    if (gamma.faces().cols() == icosphere(3).faces.cols()) CHECK(bound > 0.95 * found);
  }
  CHECK(certify(PiecewiseLinearDiffeomorphism(2)).points == 320);
}

TEST_CASE("piecewise-linear map: maps that fold, cover twice or turn inside out are refused", "[mesh]") {
  const TriangleMesh ico = icosphere(3);
  Mat3X folded = ico.vertices;
  folded.col(100) = (2 * folded.col(101) - folded.col(100)).normalized();
  folded.col(100).swap(folded.col(7));
  CHECK_THROWS_AS(PiecewiseLinearDiffeomorphism(ico, folded), UnusableMesh);
  CHECK_THROWS_AS(PiecewiseLinearDiffeomorphism(ico, -ico.vertices), UnusableMesh);
  const TriangleMesh grid = latitude_longitude_sphere(9, 24);
  Mat3X twice = grid.vertices;  // longitudes doubled: every triangle upright but for the poles' ring, two sheets
  for (Index i = 0; i < twice.cols(); ++i) {
    const double longitude = 2 * std::atan2(twice(1, i), twice(0, i)), r = std::hypot(twice(0, i), twice(1, i));
    twice.col(i) << r * std::cos(longitude), r * std::sin(longitude), twice(2, i);
  }
  CHECK_THROWS_AS(PiecewiseLinearDiffeomorphism(grid, twice), UnusableMesh);
  CHECK_THROWS_AS(PiecewiseLinearDiffeomorphism(ico, 2 * ico.vertices), InvalidArgument);
  CHECK_THROWS_AS(PiecewiseLinearDiffeomorphism(ico, icosphere(2).vertices), InvalidArgument);
  CHECK_THROWS_AS(PiecewiseLinearDiffeomorphism(2)(Vec3d(0, 0, 2)), InvalidArgument);
}

TEST_CASE("piecewise-linear map: compositions of all models are sampled and say how well", "[mesh]") {
  const SphereDiffeomorphism smooth = test::turned_warp(5, 4, 8, Vec3d(1, 0, 0.2));
  const PiecewiseLinearDiffeomorphism linear =
      piecewise_linear(test::turned_warp(6, 4, 8, Vec3d(0, 1, 0)), icosphere(4)).map;
  const Mat3X s = some_points();
  const auto check = [&](const SampledSphereMap& both, const Mat3X& expected) {
    CHECK(certify(both.map).holds());
    CHECK((both.map(s) - expected).colwise().norm().maxCoeff() < 2 * both.error.largest);
    CHECK(both.error.rms < 0.1 * pi / 180);
    CHECK(both.error.rms > 0);
  };
  check(compose(smooth, linear), smooth(linear(s)));
  check(compose(linear, smooth), linear(smooth(s)));
  check(compose(linear, linear), linear(linear(s)));
  const SampledSphereMap back = compose(linear.inverse(), linear);
  CHECK((back.map.images() - linear.vertices()).cwiseAbs().maxCoeff() < 1e-13);
  CHECK(back.error.largest < 1e-7);
}

TEST_CASE("piecewise-linear map: too coarse a triangulation is refused", "[mesh]") {
  const TriangleMesh ico = icosphere(4);
  const PiecewiseLinearDiffeomorphism twist(ico, twisted(ico.vertices, 4));
  CHECK_NOTHROW(piecewise_linear(twist, icosphere(3)));
  CHECK_THROWS_AS(piecewise_linear(twist, icosphere(1)), UnusableMesh);
}

TEST_CASE("piecewise-linear map: the path from the identity", "[mesh]") {
  const Mat3X s = some_points();
  for (const auto& gamma : maps()) {
    CHECK((interpolated(gamma, 0)(s) - s).cwiseAbs().maxCoeff() < 1e-12);
    CHECK((interpolated(gamma, 1)(s) - gamma(s)).cwiseAbs().maxCoeff() < 1e-12);
    CHECK(certify(interpolated(gamma, 0.5)).holds());
  }
  const TriangleMesh ico = icosphere(3);
  const Vec3d w(1.5, 2, -0.4);
  const PiecewiseLinearDiffeomorphism turn(ico, (rotation_exp(w) * ico.vertices).colwise().normalized());
  CHECK((interpolated(turn, 0.3)(s) - rotation_exp(0.3 * w) * s).cwiseAbs().maxCoeff() < 1e-12);
  CHECK_THROWS_AS(interpolated(turn, 2), InvalidArgument);
}

TEST_CASE("piecewise-linear map: a path that folds on the way is refused", "[mesh]") {
  // parallels at z = +-0.52 are turned by half a turn: half way their points meet at the poles
  const TriangleMesh ico = icosphere(4);
  const PiecewiseLinearDiffeomorphism gamma(ico, twisted(ico.vertices, 6));
  CHECK(certify(gamma).holds());
  CHECK_THROWS_AS(interpolated(gamma, 0.5), UnusableMesh);
}

TEST_CASE("piecewise-linear map: reparametrises a surface", "[mesh]") {
  const Ellipsoid body{1, 2, 3};
  const auto gamma = maps()[1];
  const auto view = reparametrized(body, gamma);
  const ChartBatch c = charts_at(test::random_unit_vectors(20, 2));
  const SurfaceJets jets = dsns::jets(view, c);
  for (Index i = 0; i < c.size(); ++i) {
    const Vec3d y = gamma(Vec3d(c.s.col(i)));
    CHECK((jets.f.col(i) - Vec3d(y[0], 2 * y[1], 3 * y[2])).norm() < 1e-12);
  }
}

}  // namespace piecewise_linear_diffeomorphism_test
