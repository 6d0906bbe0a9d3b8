#include "catch.hpp"
#include "support/sphere_points.hpp"

#include <dsns/elastic/registered_surface.hpp>
#include <dsns/surface/analytic.hpp>
#include <dsns/surface/any_surface.hpp>
#include <dsns/surface/harmonic.hpp>

namespace jets_test {

using namespace dsns;

namespace {

struct DoubleOnly {
  Vec3d operator()(const Vec3d& s) const { return s; }
};
struct WithMember {
  Vec3d operator()(const Vec3d& s) const { return s; }
  SurfaceJets jets(const ChartBatch& c) const {
    SurfaceJets j(c.size());
    j.f = 7 * c.s;
    return j;
  }
};

}  // namespace

namespace other {

struct WithFree {
  Vec3d operator()(const Vec3d& s) const { return s; }
};
SurfaceJets jets(const WithFree&, const ChartBatch& c) {
  SurfaceJets j(c.size());
  j.f = 9 * c.s;
  return j;
}

}  // namespace other

static_assert(Surface<Ellipsoid> && Surface<HarmonicSurface> && Surface<WithMember> && Surface<other::WithFree>);
static_assert(Surface<AtTime<LimbedBody>> && AnimatedSurface<LimbedBody> && AnimatedSurface<AnyAnimatedSurface>);
static_assert(!Surface<int> && !Surface<DoubleOnly>, "a surface without second-order jets is refused");
static_assert(!AnimatedSurface<Ellipsoid>);
static_assert(!std::is_constructible_v<RegisteredSurface<LimbedBody>, LimbedBody, Mat3, SphereDiffeomorphism>,
              "a registered surface refers to the body, so a temporary is refused");
static_assert(std::is_constructible_v<RegisteredSurface<LimbedBody>, const LimbedBody&, Mat3, SphereDiffeomorphism>);

TEST_CASE("jets come from the member, the free function or the scalar, in this order", "[surface]") {
  const ChartBatch c = charts_at(test::sphere_points());
  CHECK(jets(WithMember{}, c).f == 7 * c.s);
  CHECK(jets(other::WithFree{}, c).f == 9 * c.s);
  CHECK((jets(Ellipsoid{2, 2, 2}, c).f - 2 * c.s).norm() < 1e-14);
}

TEST_CASE("jets of an ellipsoid are its linear map of the chart", "[surface]") {
  const ChartBatch c = charts_at(test::sphere_points());
  const Eigen::DiagonalMatrix<double, 3> A(1, 2, 5);
  const SurfaceJets j = jets(Ellipsoid{1, 2, 5}, c);
  CHECK((j.fu - A * c.e1).norm() < 1e-14);
  CHECK((j.fv - A * c.e2).norm() < 1e-14);
  CHECK((j.fuu + A * c.s).norm() < 1e-14);
  CHECK(j.fuv.norm() < 1e-14);
  CHECK((j.fvv + A * c.s).norm() < 1e-14);
}

TEST_CASE("a harmonic surface has the jets of its scalar path, and projection finds it again", "[surface]") {
  Eigen::MatrixX3d coefficients(harmonic_count(5), 3);
  for (Index i = 0; i < coefficients.size(); ++i) coefficients.reshaped()[i] = std::sin(3.7 * double(i));
  const HarmonicSurface f(coefficients);
  const ChartBatch c = charts_at(test::sphere_points());
  const SurfaceJets batch = jets(f, c);
  const SurfaceTangents first = tangents(f, c);
  CHECK((first.f - batch.f).norm() + (first.fu - batch.fu).norm() + (first.fv - batch.fv).norm() < 1e-11);
  for (Index i = 0; i < c.size(); ++i) {
    const auto p = f(detail::chart_jet(c, i));
    for (int k = 0; k < 3; ++k) {
      CHECK(batch.f(k, i) == Approx(p[k].f).margin(1e-12));
      CHECK(batch.fu(k, i) == Approx(p[k].g[0]).margin(1e-12));
      CHECK(batch.fuu(k, i) == Approx(p[k].h[0]).margin(1e-11));
      CHECK(batch.fuv(k, i) == Approx(p[k].h[1]).margin(1e-11));
      CHECK(batch.fvv(k, i) == Approx(p[k].h[2]).margin(1e-11));
    }
  }
  CHECK((project_on_harmonics(f, 5).coefficients() - coefficients).norm() < 1e-12);
  CHECK((f.smoothed(3, 0).coefficients() - coefficients.topRows(16)).norm() == 0);
  CHECK(f.smoothed(5, 0.1).coefficients()(35, 0) == Approx(coefficients(35, 0) * std::exp(-3.0)));
  CHECK_THROWS_AS(HarmonicSurface(Eigen::MatrixX3d::Zero(5, 3)), InvalidArgument);
}

TEST_CASE("velocities of a formula agree with central differences", "[surface]") {
  LimbedBody body;
  body.limbs = {{Vec3d(1, 1, 0).normalized(), 6, Vec3d(1, 0, 0.2), Vec3d(0, 0.5, 0.3), 0.1}};
  body.pace = 0.4;
  const Mat3X s = test::sphere_points();
  constexpr double h = 1e-5;
  for (const double t : {0.0, 0.37, 1.0}) {
    const Mat3X difference = (positions(body, s, t + h) - positions(body, s, t - h)) / (2 * h);
    CHECK((velocities(body, s, t) - difference).cwiseAbs().maxCoeff() < 1e-8);
  }
  const AnyAnimatedSurface any(body);
  CHECK(velocities(any, s, 0.37) == velocities(body, s, 0.37));
  CHECK(jets(any, charts_at(s), 0.5).fuv == jets(at_time(body, 0.5), charts_at(s)).fuv);
}

TEST_CASE("tangents and motion jets are those of the jets and of central differences in time", "[surface]") {
  LimbedBody body;
  body.axes = {1, 0.7, 0.5};
  body.limbs = {{Vec3d(1, 1, 0).normalized(), 6, Vec3d(1, 0, 0.2), Vec3d(0, 0.5, 0.3), 0.1}};
  const AnyAnimatedSurface any(body);
  const RegisteredSurface view(body, rotation_exp(Vec3d(0.3, 0.2, -0.9)), random_diffeomorphism(2, 3, 0.08));
  const ChartBatch c = charts_at(test::sphere_points());
  const auto check = [&](const auto& surface) {
    constexpr double t = 0.3, h = 1e-5;
    const SurfaceJets j = jets(surface, c, t), after = jets(surface, c, t + h), before = jets(surface, c, t - h);
    const SurfaceTangents first = tangents(surface, c, t);
    CHECK((first.f - j.f).norm() + (first.fu - j.fu).norm() + (first.fv - j.fv).norm() < 1e-12);
    const MotionJets m = motion_jets(surface, c, t);
    CHECK((m.f - j.f).norm() + (m.fu - j.fu).norm() + (m.fv - j.fv).norm() < 1e-12);
    CHECK((m.ft - velocities(surface, c.s, t)).norm() < 1e-12);
    CHECK((m.ftu - (after.fu - before.fu) / (2 * h)).cwiseAbs().maxCoeff() < 1e-8);
    CHECK((m.ftv - (after.fv - before.fv) / (2 * h)).cwiseAbs().maxCoeff() < 1e-8);
  };
  check(body);
  check(any);
  check(view);
  const SurfaceTangents still = tangents(at_time(body, 0.3), c);
  CHECK(still.fu == tangents(body, c, 0.3).fu);
}

namespace {

/// The same formula at one point at a time and in lanes.
template <bool Lanes>
struct Wavy {
  static constexpr bool works_in_lanes = Lanes;
  template <class T>
  Vec3<T> operator()(const Vec3<T>& s, const T& t) const {
    using std::sin;
    return {s[0] * (2.0 + sin(3.0 * s[1] + t)), s[1] - t * s[2], s[2] + 0.1 * s[0] * s[0]};
  }
};

}  // namespace

TEST_CASE("a functor that works in lanes has the derivatives of one that does not, to the last point", "[surface]") {
  for (const int points : {1, 2, 3, 5, 8}) {
    const ChartBatch c = charts_at(test::sphere_points(points));
    const SurfaceJets a = jets(Wavy<true>{}, c, 0.4), b = jets(Wavy<false>{}, c, 0.4);
    for (const auto field :
         {&SurfaceJets::f, &SurfaceJets::fu, &SurfaceJets::fv, &SurfaceJets::fuu, &SurfaceJets::fuv, &SurfaceJets::fvv})
      CHECK((a.*field - b.*field).cwiseAbs().maxCoeff() < 1e-13);
    const MotionJets m = motion_jets(Wavy<true>{}, c, 0.4), n = motion_jets(Wavy<false>{}, c, 0.4);
    for (const auto field : {&MotionJets::fu, &MotionJets::ft, &MotionJets::ftu, &MotionJets::ftv})
      CHECK((m.*field - n.*field).cwiseAbs().maxCoeff() < 1e-13);
    CHECK((tangents(Wavy<true>{}, c, 0.4).fv - b.fv).cwiseAbs().maxCoeff() < 1e-13);
  }
}

TEST_CASE("a registered surface has the jets of the composed functor", "[surface]") {
  struct Composed {
    const LimbedBody& body;
    const SphereDiffeomorphism& gamma;
    Mat3 O;
    double t;
    Vec3<detail::SpatialJet> at(const Vec3<detail::SpatialJet>& s) const {
      const auto p = body(gamma(s), detail::SpatialJet(t));
      return O.cast<detail::SpatialJet>() * p;
    }
  };
  LimbedBody body;
  body.axes = {1, 0.7, 0.5};
  body.limbs = {{Vec3d(1, 1, 0.3).normalized(), 4, Vec3d(0.6, 0.1, 0.2), Vec3d(0, 0.3, 0.3), 0.1}};
  const SphereDiffeomorphism gamma = random_diffeomorphism(2, 3, 0.08);
  const TimeWarp zeta = random_warp(4, 0.5);
  const Mat3 O = rotation_exp(Vec3d(0.3, 0.2, -0.9));
  const RegisteredSurface view(body, O, gamma, zeta);
  const ChartBatch c = charts_at(test::sphere_points());
  const SurfaceJets j = jets(view, c, 0.3);
  const Composed composed{body, gamma, O, zeta(0.3)};
  double worst = 0;
  for (Index i = 0; i < c.size(); ++i) {
    const auto p = composed.at(detail::chart_jet(c, i));
    for (int k = 0; k < 3; ++k)
      worst = std::max({worst, std::abs(j.f(k, i) - p[k].f), std::abs(j.fu(k, i) - p[k].g[0]),
                        std::abs(j.fv(k, i) - p[k].g[1]), std::abs(j.fuu(k, i) - p[k].h[0]),
                        std::abs(j.fuv(k, i) - p[k].h[1]), std::abs(j.fvv(k, i) - p[k].h[2])});
  }
  CHECK(worst < 1e-12);
  constexpr double h = 1e-5;
  const Mat3X difference = (view.positions(c.s, 0.3 + h) - view.positions(c.s, 0.3 - h)) / (2 * h);
  CHECK((view.velocities(c.s, 0.3) - difference).cwiseAbs().maxCoeff() < 1e-4);  // the warp is a cubic table
}

}  // namespace jets_test
