#include <dsns/geometry/curvature.hpp>

#include "catch.hpp"
#include "support/bodies.hpp"
#include "support/sphere_points.hpp"
#include "support/surfaces.hpp"

namespace analytic_test {

using namespace dsns;

namespace {

/// The point of a chart at (u, v).
Vec3d in_chart(const ChartBatch& c, Index i, double u, double v) {
  const double angle = std::hypot(u, v), sinc = angle == 0 ? 1 : std::sin(angle) / angle;
  return std::cos(angle) * c.s.col(i) + sinc * (u * c.e1.col(i) + v * c.e2.col(i));
}

/// The surface's formula without its promise to work in lanes.
template <class S>
struct PointByPoint {
  const S& surface;
  template <class T>
  Vec3<T> operator()(const Vec3<T>& s) const {
    return surface(s);
  }
};
template <class F>
struct MovingPointByPoint {
  const F& surface;
  template <class T>
  Vec3<T> operator()(const Vec3<T>& s, const T& t) const {
    return surface(s, t);
  }
};

double difference(const SurfaceJets& a, const SurfaceJets& b) {
  double worst = 0;
  for (const auto field :
       {&SurfaceJets::f, &SurfaceJets::fu, &SurfaceJets::fv, &SurfaceJets::fuu, &SurfaceJets::fuv, &SurfaceJets::fvv})
    worst = std::max(worst, (a.*field - b.*field).cwiseAbs().maxCoeff());
  return worst;
}

}  // namespace

static_assert(!AnimatedSurface<Tube> && !AnimatedSurface<StarShaped> && !Surface<LimbedBody>);
static_assert(AnimatedSurface<decltype(resting(Sphere{}))> && !Surface<decltype(resting(Sphere{}))>);

TEST_CASE("jets of every analytic surface are its derivatives, in lanes and one point at a time", "[surface][law]") {
  const ChartBatch c = charts_at(test::sphere_points(13));
  test::for_each_surface([&](const std::string& name, const auto& surface) {
    INFO(name);
    const SurfaceJets j = jets(surface, c);
    CHECK(difference(j, jets(PointByPoint<std::decay_t<decltype(surface)>>{surface}, c)) < 1e-11);
    CHECK((j.f - positions(surface, c.s)).cwiseAbs().maxCoeff() < 1e-13);
    const SurfaceTangents first = tangents(surface, c);
    CHECK(std::max((first.fu - j.fu).cwiseAbs().maxCoeff(), (first.fv - j.fv).cwiseAbs().maxCoeff()) < 1e-13);
    constexpr double h = 1e-4;
    double slope = 0, bend = 0;
    for (Index i = 0; i < c.size(); ++i) {
      const auto at = [&](double u, double v) -> Vec3d { return surface(in_chart(c, i, u, v)); };
      slope = std::max({slope, (j.fu.col(i) - (at(h, 0) - at(-h, 0)) / (2 * h)).norm(),
                        (j.fv.col(i) - (at(0, h) - at(0, -h)) / (2 * h)).norm()});
      bend = std::max({bend, (j.fuu.col(i) - (at(h, 0) - 2 * at(0, 0) + at(-h, 0)) / (h * h)).norm(),
                       (j.fvv.col(i) - (at(0, h) - 2 * at(0, 0) + at(0, -h)) / (h * h)).norm(),
                       (j.fuv.col(i) - (at(h, h) - at(h, -h) - at(-h, h) + at(-h, -h)) / (4 * h * h)).norm()});
    }
    CHECK(slope < 1e-6);
    CHECK(bend < 1e-5);
  });
}

TEST_CASE("the curvature of every analytic surface is its closed form, at the poles and everywhere", "[surface][law]") {
  Mat3X s(3, 348);
  s << test::sphere_points(200), test::random_unit_vectors(140, 3);
  test::for_each_surface([&](const std::string& name, const auto& surface) {
    INFO(name);
    const Curvature c = curvature(surface, s);
    const double largest = (4 * c.mean.array().square() - 2 * c.gaussian.array()).maxCoeff();  // k1^2 + k2^2
    double worst_gaussian = 0, worst_mean = 0;
    for (Index i = 0; i < s.cols(); ++i) {
      // Relative to the principal curvatures there, as K and H have zeros; superquadrics have points flat in all directions.
      const double K = gaussian_curvature(surface, s.col(i)), H = mean_curvature(surface, s.col(i));
      const double squares = 4 * H * H - 2 * K + 1e-4 * largest;
      worst_gaussian = std::max(worst_gaussian, std::abs(c.gaussian[i] - K) / squares);
      worst_mean = std::max(worst_mean, std::abs(c.mean[i] - H) / std::sqrt(squares));
    }
    CHECK(worst_gaussian < 1e-11);
    CHECK(worst_mean < 1e-11);
  });
}

TEST_CASE("every analytic surface is immersed with outward normals, a tube also near its ends", "[surface][law]") {
  Mat3X s(3, 0);
  for (const double colatitude : {0.0, 1e-8, 1e-4, 0.01, 0.1, 0.5, 1.0, 1.3, 1.57, 1.9, 2.4, 3.0, 3.14, pi - 1e-6, pi})
    for (int k = 0; k < 40; ++k) {
      s.conservativeResize(3, s.cols() + 1);
      s.rightCols<1>() = spherical_point(colatitude, 2 * pi * k / 40).normalized();
    }
  test::for_each_surface([&](const std::string& name, const auto& surface) {
    INFO(name);
    const SurfaceTangents t = tangents(surface, charts_at(s));
    double least = 1e300, least_towards_s = 1e300;
    for (Index i = 0; i < s.cols(); ++i) {
      const Vec3d n = Vec3d(t.fu.col(i)).cross(Vec3d(t.fv.col(i)));
      least = std::min(least, n.norm());
      least_towards_s = std::min(least_towards_s, n.dot(s.col(i)));
    }
    CHECK(least > 0.05);
    if (name.find("tube") == std::string::npos) CHECK(least_towards_s > 0);  // star-shaped about the origin
  });
}

TEST_CASE("a straight tube has the curvatures of a cylinder in the middle and of a ball at its ends", "[surface]") {
  constexpr double r = 0.25;
  const Tube tube({4, 0}, r, 8);  // flatness = length / (2 radius)
  CHECK(gaussian_curvature(tube, Vec3d::UnitX()) == Approx(0).margin(1e-12));
  CHECK(mean_curvature(tube, Vec3d::UnitY()) == Approx(1 / (2 * r)));
  for (const Vec3d& end : {Vec3d(0, 0, 1), Vec3d(0, 0, -1)}) {
    CHECK(tube(end) == 2 * end);
    CHECK(gaussian_curvature(tube, end) == Approx(1 / (r * r)));
    CHECK(mean_curvature(tube, end) == Approx(1 / r));
  }
}

TEST_CASE("a bent tube has the curvatures of a torus in the middle", "[surface]") {
  constexpr double r = 0.4, bend = 0.9;
  const Tube tube({4, bend}, r, 3);
  for (const double angle : {0.0, 0.7, 2.0, pi}) {  // K = -bend cos / (r (1 - bend r cos)), the inner side at angle 0
    const Vec3d s(std::cos(angle), std::sin(angle), 0);
    const double across = -bend * std::cos(angle) / (1 - bend * r * std::cos(angle));
    CHECK(gaussian_curvature(tube, s) == Approx(across / r).margin(1e-12));
    CHECK(mean_curvature(tube, s) == Approx((1 / r + across) / 2));
  }
  const double w = 2, half_turn = bend * w;  // the end of the arc
  const Vec3d end((1 - std::cos(half_turn)) / bend, 0, std::sin(half_turn) / bend);
  CHECK((tube(Vec3d(0, 0, 1)) - end).norm() < 1e-14);
}

TEST_CASE("a superquadric satisfies its equation and is flat where the axes meet it", "[surface]") {
  const Superquadric q({1, 1.5, 0.7}, 6);
  const Mat3X s = test::random_unit_vectors(30, 5);
  for (Index i = 0; i < s.cols(); ++i) {
    const Vec3d p = q(Vec3d(s.col(i))).cwiseQuotient(q.axes());
    CHECK(p.array().pow(6).sum() == Approx(1).epsilon(1e-13));
  }
  CHECK(gaussian_curvature(q, Vec3d::UnitX()) == 0);
  CHECK(mean_curvature(q, Vec3d::UnitX()) == 0);
  const Vec3d diagonal = Vec3d::Ones().normalized();
  CHECK(q(diagonal).cwiseQuotient(q.axes()).x() == Approx(std::pow(3, -1.0 / 6)));
}

TEST_CASE("the radius of a star-shaped surface is proved positive", "[surface]") {
  const StarShaped body = test::star_shaped();
  const Mat3X p = positions(body, test::random_unit_vectors(2000, 9));
  CHECK(body.least_radius() > 0.3);
  CHECK(p.colwise().norm().minCoeff() >= body.least_radius());
  CHECK(p.colwise().norm().minCoeff() < body.least_radius() + 0.2);
  Eigen::VectorXd ball(1);
  ball << 2 * std::sqrt(4 * pi);
  CHECK(StarShaped(ball).least_radius() == Approx(2));
  Eigen::VectorXd c = body.coefficients();
  c[0] = 0.1;
  CHECK_THROWS_AS(StarShaped(c), InvalidArgument);
  CHECK_THROWS_AS(StarShaped(Eigen::VectorXd::Ones(5)), InvalidArgument);
  CHECK_THROWS_AS(StarShaped(Eigen::VectorXd()), InvalidArgument);
}

TEST_CASE("surfaces that would not be smooth or immersed are refused", "[surface]") {
  CHECK_THROWS_AS(Superquadric({1, 1, 1}, 3), InvalidArgument);
  CHECK_THROWS_AS(Superquadric({1, 1, 1}, 0), InvalidArgument);
  CHECK_THROWS_AS(Tube({2, 3}, 0.4), InvalidArgument);
  CHECK_THROWS_AS(Tube({2, -3}, 0.4), InvalidArgument);
  CHECK_THROWS_AS(Tube({-2, 0}, 0.4), InvalidArgument);
  CHECK_THROWS_AS(Tube({2, 0}, 0), InvalidArgument);
  CHECK_THROWS_AS(Tube({2, 0}, 0.4, 0), InvalidArgument);
}

TEST_CASE("motion of every analytic surface agrees with central differences", "[surface][law]") {
  const ChartBatch c = charts_at(test::sphere_points(13));
  const double t = GENERATE(0.3, 0.9);  // 0.3: the tube is straight
  constexpr double h = 1e-5;
  test::for_each_moving_surface([&](const std::string& name, const auto& surface) {
    INFO(name << " at " << t);
    static_assert(AnimatedSurface<std::decay_t<decltype(surface)>>);
    const SurfaceJets j = jets(surface, c, t), after = jets(surface, c, t + h), before = jets(surface, c, t - h);
    const SurfaceTangents first = tangents(surface, c, t);
    const MotionJets m = motion_jets(surface, c, t);
    CHECK((j.f - positions(surface, c.s, t)).norm() < 1e-12);
    CHECK((first.f - j.f).norm() + (first.fu - j.fu).norm() + (first.fv - j.fv).norm() < 1e-12);
    CHECK((m.f - j.f).norm() + (m.fu - j.fu).norm() + (m.fv - j.fv).norm() < 1e-12);
    CHECK((m.ft - velocities(surface, c.s, t)).norm() < 1e-12);
    CHECK((m.ft - (after.f - before.f) / (2 * h)).cwiseAbs().maxCoeff() < 1e-8);
    CHECK((m.ftu - (after.fu - before.fu) / (2 * h)).cwiseAbs().maxCoeff() < 1e-8);
    CHECK((m.ftv - (after.fv - before.fv) / (2 * h)).cwiseAbs().maxCoeff() < 1e-8);
    CHECK(difference(jets(at_time(surface, t), c), j) == 0);
    if constexpr (requires { surface.at(t); }) {
      const auto at_rest = surface.at(t);
      CHECK(difference(jets(at_rest, c), j) < 1e-12);
    }
    if constexpr (requires { surface(Vec3<detail::MotionDual>(), detail::MotionDual()); }) {
      const MotionJets slow = motion_jets(MovingPointByPoint<std::decay_t<decltype(surface)>>{surface}, c, t);
      CHECK((slow.ftu - m.ftu).cwiseAbs().maxCoeff() + (slow.ftv - m.ftv).cwiseAbs().maxCoeff() < 1e-12);
    }
  });
}

}  // namespace analytic_test
