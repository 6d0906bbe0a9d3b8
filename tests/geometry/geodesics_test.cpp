#include "catch.hpp"
#include "support/smooth_surfaces.hpp"
#include "support/sphere_points.hpp"

#include <dsns/geometry/geodesics.hpp>

namespace geodesics_test {

using namespace dsns;

namespace {

constexpr double degree = pi / 180;

/// Unit vector and directions at a geographic latitude and longitude of a spheroid (a, a, b), radians.
struct Geographic {
  Vec3d s, north, east;

  Geographic(const Ellipsoid& e, double latitude, double longitude) {
    const double parametric = std::atan(e.c / e.a * std::tan(latitude));
    s = spherical_point(pi / 2 - parametric, longitude).normalized();
    north = {-std::sin(latitude) * std::cos(longitude), -std::sin(latitude) * std::sin(longitude), std::cos(latitude)};
    east = {-std::sin(longitude), std::cos(longitude), 0};
  }
};

}  // namespace

TEST_CASE("geodesics of round spheres are great circles with Jacobi field r sin(l / r)", "[geometry]") {
  const double r = 2;
  const ChartBatch c = charts_at(test::sphere_points(6));
  for (Index i = 0; i < c.size(); ++i) {
    const Vec3d s = c.s.col(i), along = 0.6 * c.e1.col(i) - 0.8 * c.e2.col(i);
    const Geodesic g = geodesic(Ellipsoid{r, r, r}, s, along, 9);  // past the antipode at 2 pi
    REQUIRE(g.summary.converged);
    double worst = 0;
    for (Index k = 0; k < g.size(); ++k) {
      const double x = g.lengths[k] / r;
      const Vec3d here = std::cos(x) * s + std::sin(x) * along, tangent = std::cos(x) * along - std::sin(x) * s;
      worst = std::max({worst, (g.s.col(k) - here).norm(), (g.points.col(k) - r * here).norm(),
                        (g.tangents.col(k) - tangent).norm(), std::abs(g.jacobi[k] - r * std::sin(x))});
    }
    CHECK(worst < 1e-11);
    CHECK(conjugate_points(g) == 1);
  }
}

TEST_CASE("the direct problem on WGS84 has its published solution", "[geometry]") {
  // Karney 2013, Algorithms for geodesics, table 2
  const double a = 6378137, f = 1 / 298.257223563;
  const Ellipsoid earth{a, a, a * (1 - f)};
  const Geographic start(earth, 40 * degree, 0);
  const Vec3d direction = std::cos(30 * degree) * start.north + std::sin(30 * degree) * start.east;
  const Geodesic g = geodesic(earth, start.s, direction, 1e7);
  const Vec3d end = g.s.rightCols<1>(), tangent = g.tangents.rightCols<1>();
  const double longitude = std::atan2(end.y(), end.x());
  const double latitude = std::atan(std::tan(std::asin(end.z())) / (1 - f));
  const Geographic at(earth, latitude, longitude);
  CHECK(std::abs(latitude / degree - 41.79331020506) < 2e-11);
  CHECK(std::abs(longitude / degree - 137.84490004377) < 2e-11);
  CHECK(std::abs(std::atan2(tangent.dot(at.east), tangent.dot(at.north)) / degree - 149.09016931807) < 2e-11);
}

TEST_CASE("Clairaut's relation holds on spheroids", "[geometry]") {
  for (const Ellipsoid& e : {Ellipsoid{1, 1, 3}, Ellipsoid{2, 2, 0.5}})
    for (const Vec3d& s : {Vec3d(1, 0, 0), Vec3d(0.6, 0, -0.8), Vec3d(1e-4, 0, 1).normalized()}) {
      const Geodesic g = geodesic(e, s, Vec3d(0.3, 1, 0.7), 12);
      REQUIRE(g.summary.converged);
      // rho times the sine of the azimuth: the tangent's moment about the axis
      const Eigen::RowVectorXd moment =
          g.points.row(0).cwiseProduct(g.tangents.row(1)) - g.points.row(1).cwiseProduct(g.tangents.row(0));
      CHECK((moment.array() - moment[0]).abs().maxCoeff() < 1e-10);
    }
}

TEST_CASE("Joachimsthal's integral is constant on ellipsoids", "[geometry]") {
  // |D x|^2 <T, D T> with D = diag(1/a^2, 1/b^2, 1/c^2)
  const Ellipsoid e{1, 2, 3};
  const Eigen::DiagonalMatrix<double, 3> D(1, 1 / 4.0, 1 / 9.0);
  const Mat3X s = test::sphere_points(4);
  for (Index i = 0; i < s.cols(); ++i) {
    const Geodesic g = geodesic(e, s.col(i), Vec3d(0.3, 1, 0.7), 15);
    const Eigen::RowVectorXd integral =
        (D * g.points).colwise().squaredNorm().cwiseProduct(g.tangents.cwiseProduct(D * g.tangents).colwise().sum());
    CHECK((integral.array() / integral[0] - 1).abs().maxCoeff() < 1e-10);
  }
}

TEST_CASE("geodesics have unit speed, turn only with the surface, and come back", "[law]") {
  GeodesicOptions options;
  options.samples = 9;
  constexpr double length = 0.08, h = length / 8;
  const Mat3X s = test::sphere_points(2);
  test::visit_smooth_surfaces([&](const std::string& name, const test::AnySurface& surface) {
    INFO(name);
    for (const Index i : {0, 3, 6, 8, 9}) {
      const Geodesic g = geodesic(surface, s.col(i), Vec3d(0.5, 0.7, 0.3), length, options);
      REQUIRE(g.summary.converged);
      const auto derivative = [&](const Mat3X& x) -> Vec3d {  // at the middle, of order eight
        return (x.col(0) - x.col(8)) / (280 * h) + (x.col(7) - x.col(1)) * (4 / (105 * h)) +
               (x.col(2) - x.col(6)) / (5 * h) + (x.col(5) - x.col(3)) * (4 / (5 * h));
      };
      CHECK((derivative(g.points) - g.tangents.col(4)).norm() < 1e-6);
      const Vec3d turn = derivative(g.tangents);
      const Vec3d n = unit_normals(tangents(surface, charts_at(g.s.col(4)))).col(0);
      CHECK((turn - n * n.dot(turn)).norm() < 1e-5);
      const Geodesic back = geodesic(surface, g.s.col(8), -g.tangents.col(8), length, options);
      CHECK((back.points.col(8) - g.points.col(0)).norm() < 1e-11);
      CHECK((back.tangents.col(8) + g.tangents.col(0)).norm() < 1e-10);
      CHECK(back.jacobi[8] == Approx(g.jacobi[8]).epsilon(1e-9));  // the reciprocity of Jacobi fields
    }
  });
}

TEST_CASE("the Jacobi field is the distance of a neighbour, by angle", "[law]") {
  GeodesicOptions options;
  options.samples = 5;
  const auto check = [&](const std::string& name, const auto& surface) {
    INFO(name);
    const Vec3d s = Vec3d(0.3, -0.5, 0.8).normalized();
    const ChartBatch c = charts_at(s);
    const Vec3d n = unit_normals(tangents(surface, c)).col(0);
    const Vec3d along = Vec3d(tangents(surface, c).fu.col(0)).normalized();
    constexpr double angle = 1e-4;
    const auto leaving = [&](double by) {
      return geodesic(surface, s, std::cos(by) * along + std::sin(by) * n.cross(along), 3, options);
    };
    const Geodesic middle = leaving(0), left = leaving(angle), right = leaving(-angle);
    for (Index i = 0; i < 5; ++i) {
      const Vec3d conormal =
          unit_normals(tangents(surface, charts_at(middle.s.col(i)))).col(0).cross(Vec3d(middle.tangents.col(i)));
      const double spread = conormal.dot(left.points.col(i) - right.points.col(i)) / (2 * angle);
      CHECK(middle.jacobi[i] == Approx(spread).epsilon(1e-5).margin(1e-6));
    }
  };
  check("ellipsoid", Ellipsoid{1, 1.5, 0.7});
  check("two limbs", test::StillBody{});
  check("harmonics", test::bumpy_harmonics());
}

TEST_CASE("a geodesic is the same in every unit of length and every parametrisation", "[law]") {
  const Vec3d s = Vec3d(1, 2, -1).normalized(), direction(1, 0, 0.4);
  const Geodesic a = geodesic(Ellipsoid{1, 2, 3}, s, direction, 4),
                 b = geodesic(Ellipsoid{1e6, 2e6, 3e6}, s, direction, 4e6);
  CHECK((a.s - b.s).cwiseAbs().maxCoeff() < 1e-12);
  CHECK((1e6 * a.jacobi - b.jacobi).cwiseAbs().maxCoeff() < 1e-5);
  const LimbedBody body = test::two_limbs();
  const SphereDiffeomorphism gamma = random_diffeomorphism(6, 3, 0.08);
  const RegisteredSurface moved(body, Mat3::Identity(), gamma);
  const Geodesic c = geodesic(at_time(moved, 0.4), s, direction, 2),
                 d = geodesic(at_time(body, 0.4), gamma(s).normalized(), direction, 2);
  CHECK((c.points - d.points).cwiseAbs().maxCoeff() < 1e-10);
  CHECK((c.jacobi - d.jacobi).cwiseAbs().maxCoeff() < 1e-9);
}

TEST_CASE("geodesics without length, without steps and without direction", "[geometry]") {
  const Ellipsoid e{1, 2, 3};
  const Geodesic point = geodesic(e, Vec3d::UnitX(), Vec3d(5, 1, 0), 0);
  CHECK(point.summary.converged);
  CHECK(point.size() == 65);
  CHECK((point.points.colwise() - Vec3d::UnitX()).norm() == 0);
  CHECK((point.tangents.col(0) - Vec3d::UnitY()).norm() < 1e-15);
  CHECK(point.jacobi.norm() == 0);
  GeodesicOptions few;
  few.max_steps = 20;
  const Geodesic cut = geodesic(e, Vec3d::UnitX(), Vec3d::UnitY(), 10, few);
  CHECK(!cut.summary.converged);
  CHECK(cut.size() > 1);
  CHECK(cut.size() < 65);
  CHECK(cut.points.cols() == cut.size());
  CHECK_THROWS_AS(geodesic(e, Vec3d::UnitX(), Vec3d::UnitX(), 1), InvalidArgument);
  CHECK_THROWS_AS(geodesic(e, Vec3d(2, 0, 0), Vec3d::UnitY(), 1), InvalidArgument);
  CHECK_THROWS_AS(geodesic(e, Vec3d::UnitX(), Vec3d::UnitY(), -1), InvalidArgument);
  CHECK_THROWS_AS(geodesic(Ellipsoid{0, 0, 1}, Vec3d::UnitX(), Vec3d::UnitY(), 1), DegenerateSurface);
}

}  // namespace geodesics_test
