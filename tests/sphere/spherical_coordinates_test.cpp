#include "catch.hpp"
#include "support/sphere_points.hpp"

#include <dsns/autodiff/eigen.hpp>
#include <dsns/autodiff/jet2.hpp>
#include <dsns/sphere/spherical_coordinates.hpp>
#include <dsns/surface/jets.hpp>

namespace spherical_coordinates_test {

using namespace dsns;

namespace {

using Jet = Jet2<double, 2>;

/// A function on the sphere with nothing symmetric about it.
template <class T>
T bump(const Vec3<T>& s) {
  using std::exp, std::sin;
  return exp(0.4 * s[0] - 0.7 * s[1] * s[2]) + sin(1.3 * s[2] + s[0] * s[1]);
}

SecondOrder<double> derivatives(const Jet& f) { return {f.g[0], f.g[1], f.h[0], f.h[1], f.h[2]}; }

double largest_difference(const SecondOrder<double>& a, const SecondOrder<double>& b) {
  return std::max(
      {std::abs(a.u - b.u), std::abs(a.v - b.v), std::abs(a.uu - b.uu), std::abs(a.uv - b.uv), std::abs(a.vv - b.vv)});
}

/// s(u, v) differentiated by the scalar itself.
Vec3<Jet> point_jet(const SphericalCoordinates& c) {
  const Jet u = Jet::variable(c.u, 0), v = Jet::variable(c.v, 1);
  return {sin(u) * cos(v), sin(u) * sin(v), cos(u)};
}

}  // namespace

TEST_CASE("points go to coordinates and back, also near the poles", "[sphere]") {
  const Mat3X s = test::sphere_points();
  for (Index i = 0; i < s.cols(); ++i) {
    const SphericalCoordinates c = spherical_coordinates(s.col(i));
    CHECK(angle_between(spherical_point(c.u, c.v), s.col(i)) < 1e-15);
    CHECK((c.u >= 0 && c.u <= pi && c.v > -pi - 1e-15 && c.v <= pi));
  }
  CHECK(spherical_coordinates({1e-9, 0, 1}).u == Approx(1e-9).epsilon(1e-15));  // acos(z) is 0
  CHECK(spherical_coordinates({0, 0, 1}).u == 0);
  CHECK(spherical_coordinates({0, 0, -1}).u == pi);
  CHECK(spherical_coordinates({-0.0, -0.0, -1}).v == 0);
  CHECK(spherical_coordinates({0, -2, 0}).v == -pi / 2);
  CHECK(spherical_coordinates({1e-170, 1e-170, 1}).v == Approx(pi / 4));
}

TEST_CASE("derivatives of the point in the coordinates are those of automatic differentiation", "[sphere]") {
  for (const SphericalCoordinates c :
       {SphericalCoordinates{0.0, 0.3}, {1e-7, 2.0}, {0.8, -2.2}, {pi / 2, 0.0}, {pi, 1.0}}) {
    const SphericalJet j = spherical_jet(c);
    const Vec3<Jet> p = point_jet(c);
    for (int k = 0; k < 3; ++k) {
      CHECK(j.s[k] == Approx(p[k].f).margin(1e-15));
      CHECK(largest_difference({j.su[k], j.sv[k], j.suu[k], j.suv[k], j.svv[k]}, derivatives(p[k])) < 1e-15);
    }
  }
}

TEST_CASE("charts of the coordinates have the frame s_u, s_v / sin u", "[sphere]") {
  const ChartBatch c = charts_of_coordinates(test::sphere_points());
  for (Index i = 0; i < c.size(); ++i) {
    Mat3 frame;
    frame << c.e1.col(i), c.e2.col(i), c.s.col(i);
    CHECK((frame.transpose() * frame - Mat3::Identity()).norm() < 1e-14);
    CHECK(frame.determinant() == Approx(1));
    const SphericalCoordinates at = spherical_coordinates(c.s.col(i));
    const SphericalJet j = spherical_jet(at);
    CHECK((j.su - c.e1.col(i)).norm() < 1e-14);
    CHECK((j.sv - std::sin(at.u) * c.e2.col(i)).norm() < 1e-14);
  }
  CHECK((c.e1.col(0) - Vec3d::UnitX()).norm() == 0);  // the north pole: the meridian v = 0
  CHECK((c.e1.col(1) + Vec3d::UnitX()).norm() == 0);
  CHECK_THROWS_AS(charts_of_coordinates(2 * c.s), InvalidArgument);
}

TEST_CASE("derivatives in coordinates and in charts are one another's closed form", "[sphere]") {
  const ChartBatch aligned = charts_of_coordinates(test::sphere_points()), other = charts_at(aligned.s);
  for (Index i = 0; i < aligned.size(); ++i) {
    const SphericalCoordinates c = spherical_coordinates(aligned.s.col(i));
    const SecondOrder<double> in_chart = derivatives(bump(detail::chart_jet(aligned, i)));
    const SecondOrder<double> in_coordinates = derivatives(bump(point_jet(c)));
    CHECK(largest_difference(coordinate_derivatives(in_chart, c.u), in_coordinates) < 1e-13);
    const Vec3d e = other.e1.col(i);
    const double angle = std::atan2(aligned.e2.col(i).dot(e), aligned.e1.col(i).dot(e));
    CHECK(largest_difference(turned(in_chart, angle), derivatives(bump(detail::chart_jet(other, i)))) < 1e-13);
    const double sine = std::sin(c.u);
    if (sine > 1e-3)
      CHECK(largest_difference(chart_derivatives(in_coordinates, c.u), in_chart) < 1e-14 / (sine * sine));
  }
  CHECK_THROWS_AS(chart_derivatives(SecondOrder<double>{}, 0.0), InvalidArgument);
  CHECK_THROWS_AS(chart_derivatives(SecondOrder<double>{}, pi), InvalidArgument);
}

TEST_CASE("derivatives of vectors turn as those of numbers", "[sphere]") {
  const SecondOrder<Vec3d> d{Vec3d(1, 0, 2), Vec3d(0, 3, 1), Vec3d(1, 1, 0), Vec3d(2, 0, 5), Vec3d(-1, 4, 0)};
  const SecondOrder<Vec3d> there = coordinate_derivatives(d, 0.9), back = chart_derivatives(there, 0.9);
  CHECK((back.uv - d.uv).norm() < 1e-14);
  CHECK((back.vv - d.vv).norm() < 1e-14);
  CHECK((turned(turned(d, 0.4), -0.4).uu - d.uu).norm() < 1e-14);
}

}  // namespace spherical_coordinates_test
