#include "catch.hpp"
#include "support/smooth_surfaces.hpp"
#include "support/sphere_points.hpp"

#include <dsns/geometry/geodesic_distance.hpp>

namespace geodesic_distance_test {

using namespace dsns;

namespace {

template <class S>
double distance_of(const S& surface, const Vec3d& a, const Vec3d& b) {
  const GeodesicDistance d = geodesic_distance(surface, a, b);
  CHECK(d.converged);
  CHECK(d.found >= 1);
  CHECK((surface(b) - d.path.points.rightCols<1>()).norm() < 1e-9 * d.length);
  CHECK(d.length >= (surface(b) - surface(a)).norm() - 1e-12);
  CHECK(d.length <= detail::chords(surface, detail::edge_path(surface, a, b, 3)).sum() * (1 + 1e-3));
  CHECK(conjugate_points(d.path) == 0);
  return d.length;
}

}  // namespace

TEST_CASE("distances on a round sphere are angles, from next door to the antipode", "[geometry]") {
  const Ellipsoid e{2, 2, 2};
  const Mat3X s = test::sphere_points(4);
  for (const Index i : {0, 3, 8})
    for (const Index k : {2, 7, 9}) {
      const Vec3d a = s.col(i), b = s.col(k);
      CHECK(geodesic_distance(e, a, b).length == Approx(2 * angle_between(a, b)).epsilon(1e-11));
    }
  const Vec3d a = Vec3d(1, 2, 2) / 3, beside = (a + Vec3d(1e-6, 0, 0)).normalized();
  CHECK(geodesic_distance(e, a, beside).length == Approx(2 * angle_between(a, beside)).epsilon(1e-8));
  CHECK(geodesic_distance(e, a, -a).length == Approx(2 * pi).epsilon(1e-11));
  const GeodesicDistance none = geodesic_distance(e, a, a);
  CHECK(none.converged);
  CHECK(none.length == 0);
}

TEST_CASE("the inverse of the published direct problem on WGS84", "[geometry]") {
  // Karney 2013, table 2, with parametric latitudes from tan(beta) = (1 - f) tan(phi)
  const double a = 6378137, f = 1 / 298.257223563, degree = pi / 180;
  const auto point = [&](double latitude, double longitude) {
    const double parametric = std::atan((1 - f) * std::tan(latitude * degree));
    return Vec3d(spherical_point(pi / 2 - parametric, longitude * degree).normalized());
  };
  const GeodesicDistance d =
      geodesic_distance(Ellipsoid{a, a, a * (1 - f)}, point(40, 0), point(41.79331020506, 137.84490004377));
  CHECK(d.converged);
  CHECK(d.length == Approx(1e7).epsilon(1e-12));
}

TEST_CASE("the ends of an ellipsoid's longest axis are half the smallest ellipse through them apart", "[geometry]") {
  double half = 0;  // of the ellipse with semi-axes 3 and 1; the trapezoidal rule converges geometrically
  for (int i = 0; i < 200; ++i) half += pi / 200 * std::hypot(3 * std::sin(pi * i / 200), std::cos(pi * i / 200));
  const GeodesicDistance d = geodesic_distance(Ellipsoid{1, 2, 3}, Vec3d::UnitZ(), -Vec3d::UnitZ());
  CHECK(d.length == Approx(half).epsilon(1e-11));
}

TEST_CASE("distances are symmetric and satisfy the triangle inequality", "[law]") {
  const Mat3X s = fibonacci_sphere(3).points;
  const auto check = [&](const std::string& name, const auto& surface) {
    INFO(name);
    Mat3 d = Mat3::Zero();
    for (Index i = 0; i < 3; ++i)
      for (Index k = 0; k < 3; ++k)
        if (i != k) d(i, k) = distance_of(surface, s.col(i), s.col(k));
    CHECK((d - d.transpose()).cwiseAbs().maxCoeff() < 1e-10);
    for (Index i = 0; i < 3; ++i) CHECK(d((i + 1) % 3, (i + 2) % 3) <= d.row(i).sum() + 1e-10);
  };
  check("ellipsoid", Ellipsoid{1, 1.5, 0.7});
  check("two limbs", test::StillBody{});
  check("harmonics", test::bumpy_harmonics());
}

TEST_CASE("a point of a geodesic is as far as the geodesic is long, while it is the shortest", "[law]") {
  const Ellipsoid e{1, 2, 3};
  const Geodesic g = geodesic(e, Vec3d(1, 2, -1).normalized(), Vec3d(1, 0, 0.4), 1.5);
  for (const Index i : {1, 20, 64})
    CHECK(distance_of(e, g.s.col(0), g.s.col(i)) == Approx(g.lengths[i]).epsilon(1e-10));
}

TEST_CASE("distances do not change under rotation and reparametrisation", "[law]") {
  const LimbedBody body = test::two_limbs();
  const SphereDiffeomorphism gamma = random_diffeomorphism(6, 3, 0.08);
  const RegisteredSurface moved(body, rotation_exp(Vec3d(0.7, -0.2, 0.4)), gamma);
  const Mat3X s = fibonacci_sphere(3).points, image = gamma(s);
  CHECK(geodesic_distance(at_time(moved, 0.4), s.col(0), s.col(2)).length ==
        Approx(geodesic_distance(at_time(body, 0.4), image.col(0), image.col(2)).length).epsilon(1e-9));
}

TEST_CASE("without shots a distance says that it did not converge", "[geometry]") {
  GeodesicDistanceOptions options;
  options.max_iterations = 0;
  const Vec3d a = Vec3d::UnitX(), b = Vec3d(-0.5, 1, 0.7).normalized();
  const GeodesicDistance d = geodesic_distance(Ellipsoid{1, 2, 3}, a, b, options);
  CHECK(!d.converged);
  CHECK(d.found == 0);
  CHECK(d.miss > 1e-9);
  CHECK(d.miss < 0.1);
  options.nodes = 4;
  CHECK_THROWS_AS(geodesic_distance(Ellipsoid{1, 2, 3}, a, b, options), InvalidArgument);
}

}  // namespace geodesic_distance_test
