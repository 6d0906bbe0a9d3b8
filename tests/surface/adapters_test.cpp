#include <dsns/sphere/diffeomorphism.hpp>
#include <dsns/surface/adapters.hpp>
#include <dsns/surface/any_surface.hpp>
#include <dsns/surface/harmonic.hpp>

#include "catch.hpp"
#include "support/sphere_points.hpp"
#include "support/surfaces.hpp"

namespace adapters_test {

using namespace dsns;

namespace {

/// scale R f(gamma(s)) + b as one formula of any scalar, for resting and moving f.
template <class F>
struct Composed {
  const F& f;
  const SphereDiffeomorphism& gamma;
  Mat3 R;
  double scale;
  Vec3d b;
  template <class T, class... Time>
  Vec3<T> operator()(const Vec3<T>& s, const Time&... t) const {
    const Vec3<T> p = f(gamma(s), t...);
    Vec3<T> q;
    for (int k = 0; k < 3; ++k) q[k] = scale * (R(k, 0) * p[0] + R(k, 1) * p[1] + R(k, 2) * p[2]) + b[k];
    return q;
  }
};

const Mat3& turn() {
  static const Mat3 R = rotation_exp(Vec3d(0.3, 0.2, -0.9));
  return R;
}
const SphereDiffeomorphism& warp() {
  static const SphereDiffeomorphism gamma = random_diffeomorphism(2, 3, 0.08);
  return gamma;
}

template <class J>
double difference(J a, J b) {
  const auto x = detail::fields(a), y = detail::fields(b);
  double worst = 0;
  for (std::size_t k = 0; k < x.size(); ++k) worst = std::max(worst, (*x[k] - *y[k]).cwiseAbs().maxCoeff());
  return worst;
}

/// All that is asked of two resting surfaces, or of two moving ones at a time.
template <class A, class B, class... Time>
double distance(const A& a, const B& b, const ChartBatch& c, Time... t) {
  double worst =
      std::max({difference(jets(a, c, t...), jets(b, c, t...)), difference(tangents(a, c, t...), tangents(b, c, t...)),
                difference(positions(a, c.s, t...), positions(b, c.s, t...))});
  for (Index i = 0; i < c.size(); ++i)
    worst = std::max(worst, (a(Vec3d(c.s.col(i)), t...) - b(Vec3d(c.s.col(i)), t...)).norm());
  if constexpr (sizeof...(Time) > 0)
    worst = std::max({worst, difference(velocities(a, c.s, t...), velocities(b, c.s, t...)),
                      difference(motion_jets(a, c, t...), motion_jets(b, c, t...))});
  return worst;
}

/// A surface that can only be asked for batches beyond its values, and counts how often it is asked for one point.
struct BatchOnly {
  LimbedBody body = test::limbed_body();
  mutable int points = 0;
  Vec3d operator()(const Vec3d& s, double t) const {
    ++points;
    return body(s, t);
  }
  Mat3X positions(const Mat3X& s, double t) const { return dsns::positions(body, s, t); }
  Mat3X velocities(const Mat3X& s, double t) const { return dsns::velocities(body, s, t); }
  SurfaceJets jets(const ChartBatch& c, double t) const { return dsns::jets(body, c, t); }
  SurfaceTangents tangents(const ChartBatch& c, double t) const { return dsns::tangents(body, c, t); }
  MotionJets motion_jets(const ChartBatch& c, double t) const { return dsns::motion_jets(body, c, t); }
};

struct NotASurface {};

template <class S>
concept CanBeRotated = requires(const S& s) {
  rotated(s, Mat3());
};
template <class... S>
concept CanBeAdded = requires(const S&... s) {
  { jets(sum(s...), ChartBatch()) } -> std::same_as<SurfaceJets>;
};

}  // namespace

using RotatedEllipsoid = decltype(rotated(Ellipsoid{}, Mat3()));
using RotatedBody = decltype(rotated(LimbedBody{}, Mat3()));
static_assert(Surface<RotatedEllipsoid> && !AnimatedSurface<RotatedEllipsoid>);
static_assert(AnimatedSurface<RotatedBody> && !Surface<RotatedBody>);
static_assert(Surface<SphereDiffeomorphism>, "a map of the sphere is a surface");
static_assert(CanBeRotated<Tube> && !CanBeRotated<NotASurface> && !CanBeRotated<Mat3X>);
static_assert(CanBeAdded<Tube, Sphere> && !CanBeAdded<Tube, LimbedBody>, "rest and motion are not added");
static_assert(std::is_same_v<decltype(scaled(std::declval<const Tube&>(), 2.0)), Transformed<const Tube&>>);
static_assert(std::is_same_v<decltype(scaled(std::declval<Tube>(), 2.0)), Transformed<Tube>>);

TEST_CASE("adapted surfaces have the values and jets of the composed formula", "[surface][law]") {
  const ChartBatch c = charts_at(test::sphere_points(13));
  const Vec3d b(0.5, -1, 2);
  test::for_each_surface([&](const std::string& name, const auto& surface) {
    INFO(name);
    const Composed<std::decay_t<decltype(surface)>> composed{surface, warp(), turn(), 0.6, b};
    CHECK(distance(translated(scaled(rotated(reparametrized(surface, warp()), turn()), 0.6), b), composed, c) < 1e-12);
  });
}

TEST_CASE("adapted moving surfaces have the jets and motion of the composed formula", "[surface][law]") {
  const ChartBatch c = charts_at(test::sphere_points(5));
  const LimbedBody body = test::limbed_body();
  const Vec3d b(0.5, -1, 2);
  const Composed<LimbedBody> composed{body, warp(), turn(), 0.6, b};
  const BatchOnly batches;
  const AnyAnimatedSurface any(body);
  const auto adapt = [&](const auto& f) {
    return translated(scaled(rotated(reparametrized(f, warp()), turn()), 0.6), b);
  };
  for (const double t : {0.0, 0.37, 1.0}) {
    CHECK(distance(adapt(body), composed, c, t) < 1e-12);
    CHECK(distance(adapt(any), composed, c, t) < 1e-12);
    CHECK(difference(jets(adapt(batches), c, t), jets(composed, c, t)) < 1e-12);
    CHECK(difference(tangents(adapt(batches), c, t), tangents(composed, c, t)) < 1e-12);
    CHECK(difference(motion_jets(adapt(batches), c, t), motion_jets(composed, c, t)) < 1e-12);
    CHECK(difference(positions(adapt(batches), c.s, t), positions(composed, c.s, t)) < 1e-12);
    CHECK(difference(velocities(adapt(batches), c.s, t), velocities(composed, c.s, t)) < 1e-12);
  }
  CHECK(batches.points == 0);
}

TEST_CASE("a sum has the jets and motion of its terms' sum", "[surface]") {
  const ChartBatch c = charts_at(test::sphere_points(5));
  const Tube tube({4, 0.9}, 0.4);
  const Ellipsoid ellipsoid{1, 2, 5};
  const auto mixed = [&]<class T>(const Vec3<T>& s) -> Vec3<T> {
    const Vec3<T> a = tube(s), b = ellipsoid(s);
    return {0.3 * a[0] + 0.7 * b[0], 0.3 * a[1] + 0.7 * b[1], 0.3 * a[2] + 0.7 * b[2]};
  };
  CHECK(distance(sum(scaled(tube, 0.3), scaled(ellipsoid, 0.7)), mixed, c) < 1e-13);
  CHECK(distance(sum(tube), tube, c) == 0);

  Eigen::MatrixX3d coefficients(9, 3);
  for (Index i = 0; i < coefficients.size(); ++i) coefficients.reshaped()[i] = std::sin(3.7 * double(i));
  const HarmonicSurface harmonic(coefficients);  // batches beside formulas
  CHECK(distance(
            sum(harmonic, tube, harmonic),
            [&]<class T>(const Vec3<T>& s) -> Vec3<T> {
              const Vec3<T> h = harmonic(s);
              return tube(s) + h + h;
            },
            c) < 1e-12);

  const LimbedBody body = test::limbed_body();
  const auto twice = [&]<class T>(const Vec3<T>& s, const T& t) -> Vec3<T> { return body(s, t) + body(s, t); };
  CHECK(distance(sum(body, AnyAnimatedSurface(body)), twice, c, 0.4) < 1e-12);
}

TEST_CASE("any functor that maps the sphere to itself reparametrises", "[surface]") {
  const ChartBatch c = charts_at(test::sphere_points());
  const Ellipsoid ellipsoid{1, 2, 5};
  const auto squeeze = []<class T>(const Vec3<T>& s) -> Vec3<T> {
    using std::sqrt;
    const T length = sqrt(s[0] * s[0] + s[1] * s[1] + 4.0 * s[2] * s[2]);
    return {s[0] / length, s[1] / length, 2.0 * s[2] / length};
  };
  const auto composed = [&]<class T>(const Vec3<T>& s) -> Vec3<T> { return ellipsoid(squeeze(s)); };
  CHECK(distance(reparametrized(ellipsoid, squeeze), composed, c) < 1e-12);
  const auto twice = [&]<class T>(const Vec3<T>& s) -> Vec3<T> { return ellipsoid(squeeze(squeeze(s))); };
  CHECK(distance(reparametrized(reparametrized(ellipsoid, squeeze), squeeze), twice, c) < 1e-12);
  CHECK(distance(reparametrized(ellipsoid, SphereDiffeomorphism()), ellipsoid, c) < 1e-13);
}

TEST_CASE("a map that leaves the sphere is refused", "[surface]") {
  const Mat3X s = test::sphere_points();
  const auto view = reparametrized(Sphere{}, Ellipsoid{1, 1, 1.1});
  CHECK_THROWS_AS(positions(view, s), InvalidArgument);
  CHECK_THROWS_AS(jets(view, charts_at(s)), InvalidArgument);
  CHECK_THROWS_AS(tangents(view, charts_at(s)), InvalidArgument);
}

TEST_CASE("adapters refer to surfaces that have names and keep temporaries", "[surface]") {
  Ellipsoid named{1, 1, 1};
  const auto view = scaled(named, 2.0);
  auto kept = scaled(Ellipsoid{1, 1, 1}, 2.0);
  named.c = 3;
  CHECK(view(Vec3d(0, 0, 1)) == Vec3d(0, 0, 6));
  CHECK(kept(Vec3d(0, 0, 1)) == Vec3d(0, 0, 2));
  kept = scaled(Ellipsoid{1, 1, 4}, 2.0);
  CHECK(kept(Vec3d(0, 0, 1)) == Vec3d(0, 0, 8));
  const auto still = at_time(rotated(test::limbed_body(), turn()), 0.3);
  CHECK((still(Vec3d(0, 0, 1)) - turn() * test::limbed_body()(Vec3d(0, 0, 1), 0.3)).norm() < 1e-15);
}

}  // namespace adapters_test
