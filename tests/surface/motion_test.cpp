#include <dsns/elastic/time_warp.hpp>
#include <dsns/sphere/rotations.hpp>
#include <dsns/surface/any_surface.hpp>
#include <dsns/surface/motion.hpp>

#include "catch.hpp"
#include "support/sphere_points.hpp"
#include "support/surfaces.hpp"

namespace motion_test {

using namespace dsns;

namespace {

template <class J>
double difference(J a, J b) {
  const auto x = detail::fields(a), y = detail::fields(b);
  double worst = 0;
  for (std::size_t k = 0; k < x.size(); ++k) worst = std::max(worst, (*x[k] - *y[k]).cwiseAbs().maxCoeff());
  return worst;
}

template <class A, class B>
double distance(const A& a, const B& b, const ChartBatch& c, double t) {
  return std::max({difference(jets(a, c, t), jets(b, c, t)), difference(tangents(a, c, t), tangents(b, c, t)),
                   difference(positions(a, c.s, t), positions(b, c.s, t)),
                   difference(velocities(a, c.s, t), velocities(b, c.s, t)),
                   difference(motion_jets(a, c, t), motion_jets(b, c, t)),
                   (a(Vec3d(c.s.col(0)), t) - b(Vec3d(c.s.col(0)), t)).norm()});
}

/// A warp that tells its slope instead of taking a differentiating scalar.
struct Square {
  double operator()(double t) const { return t * t; }
  double slope(double t) const { return 2 * t; }
};
struct WithoutSlope {
  double operator()(double t) const { return t * t; }
};
const auto square = [](const auto& t) { return t * t; };

}  // namespace

static_assert(TimeFunction<TimeWarp> && TimeFunction<Square> && TimeFunction<decltype(square)>);
static_assert(!TimeFunction<WithoutSlope>, "a warp without a derivative is refused");
static_assert(!AnimatedSurface<Animated<decltype([](double t) { return SphereOf<double>{t}; })>>,
              "a family of the number alone has no velocity");

TEST_CASE("a warp of time has the jets and motion of the composed formula", "[surface]") {
  const ChartBatch c = charts_at(test::sphere_points(5));
  const LimbedBody body = test::limbed_body();
  const auto composed = [&]<class T>(const Vec3<T>& s, const T& t) -> Vec3<T> { return body(s, T(t * t)); };
  for (const double t : {0.0, 0.37, 1.0}) {
    CHECK(distance(time_warped(body, square), composed, c, t) < 1e-12);
    CHECK(distance(time_warped(AnyAnimatedSurface(body), Square{}), composed, c, t) < 1e-12);
    CHECK(distance(time_warped(body, TimeWarp()), body, c, t) < 1e-12);
  }
}

TEST_CASE("modulated surfaces add up to the composed formula", "[surface]") {
  const ChartBatch c = charts_at(test::sphere_points(5));
  const Tube tube({4, 0.9}, 0.4);
  const Sphere sphere{1.5};
  const auto composed = [&]<class T>(const Vec3<T>& s, const T& t) -> Vec3<T> {
    const Vec3<T> a = tube(s), b = sphere(s);
    Vec3<T> p;
    for (int k = 0; k < 3; ++k) p[k] = (1.0 - t * t) * a[k] + t * t * b[k] + b[k];
    return p;
  };
  const auto blend =
      sum(modulated(tube, [](const auto& t) { return 1.0 - t * t; }), modulated(sphere, Square{}), resting(sphere));
  for (const double t : {0.0, 0.37, 1.0}) CHECK(distance(blend, composed, c, t) < 1e-12);
}

TEST_CASE("a resting surface has no velocity", "[surface]") {
  const ChartBatch c = charts_at(test::sphere_points(5));
  const auto still = resting(Tube({4, 0.9}, 0.4));
  CHECK(velocities(still, c.s, 0.3) == Mat3X::Zero(3, c.size()));
  CHECK(motion_jets(still, c, 0.3).ftu == Mat3X::Zero(3, c.size()));
  CHECK(difference(jets(still, c, 0.3), jets(Tube({4, 0.9}, 0.4), c)) == 0);
}

TEST_CASE("a family of surfaces moves with the derivative of its parameters", "[surface]") {
  const ChartBatch c = charts_at(test::sphere_points(5));
  const auto family = animated([]<class T>(const T& t) { return EllipsoidOf<T>{1.0 + t, T(1), 2.0 - t * t}; });
  constexpr double t = 0.4;  // velocity (x, 0, -2 t z)
  const Mat3X expected = Vec3d(1, 0, -2 * t).asDiagonal() * c.s;
  CHECK((velocities(family, c.s, t) - expected).cwiseAbs().maxCoeff() < 1e-15);
  const MotionJets m = motion_jets(family, c, t);
  CHECK((m.ftu - Vec3d(1, 0, -2 * t).asDiagonal() * c.e1).cwiseAbs().maxCoeff() < 1e-15);
  CHECK(gaussian_curvature(family.at(0), Vec3d::UnitZ()) == Approx(4));  // c^2 / (a^2 b^2)
  const auto turned = animated(
      []<class T>(const T& t_) { return rotated(SphereOf<T>{1.0 + t_}, rotation_exp(Vec3d(0.3, 0.2, -0.9))); });
  CHECK((velocities(turned, c.s, t) - rotation_exp(Vec3d(0.3, 0.2, -0.9)) * c.s).cwiseAbs().maxCoeff() < 1e-15);
}

}  // namespace motion_test
