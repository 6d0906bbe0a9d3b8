#include "catch.hpp"
#include "support/sphere_points.hpp"

#include <dsns/autodiff/dual.hpp>
#include <dsns/geometry/galerkin.hpp>
#include <dsns/geometry/integrals.hpp>
#include <dsns/surface/analytic.hpp>

namespace galerkin_test {

using namespace dsns;

namespace {

/// The sphere mapped to itself by z -> k z in the stereographic plane, which is conformal.
struct Moebius {
  double k;
  template <class T>
  Vec3<T> operator()(const Vec3<T>& s) const {
    const T north = k * k * (1.0 + s.z()), south = 1.0 - s.z(), w = north + south;
    return {2.0 * k * s.x() / w, 2.0 * k * s.y() / w, (north - south) / w};
  }
};

}  // namespace

TEST_CASE("on spheres the mass is r^2 and the stiffness l(l + 1)", "[geometry]") {
  const double r = GENERATE(0.3, 1.0, 7.0);
  const GalerkinSystem system = galerkin_system(Ellipsoid{r, r, r}, {.degree = 8});
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(81, 81);
  const Eigen::ArrayXd l = harmonic_degrees(8);
  CHECK((system.mass / (r * r) - one).cwiseAbs().maxCoeff() < 1e-12);
  CHECK((system.stiffness - Eigen::MatrixXd((l * (l + 1)).matrix().asDiagonal())).cwiseAbs().maxCoeff() < 1e-11);
}

TEST_CASE("mass and stiffness of an ellipsoid's coordinates are integrals known otherwise", "[geometry]") {
  const Ellipsoid e{1, 1.2, 1.7};
  const GalerkinSystem system = galerkin_system(e, {.degree = 3, .nodes = 60});
  const SurfaceMeasures m = measure(e, sphere_quadrature(60));
  const double y0 = std::sqrt(1 / (4 * pi)), y1 = std::sqrt(3 / (4 * pi));
  CHECK(system.mass(0, 0) == Approx(y0 * y0 * m.area).epsilon(1e-12));
  CHECK(system.stiffness.col(0).norm() < 1e-14);
  // Half the Dirichlet energy of the position is the area: x = a x^, and x^ = Y_11 / y1, y^ = Y_1-1 / y1, z^ = Y_10 /
  // y1.
  const double energy =
      e.a * e.a * system.stiffness(3, 3) + e.b * e.b * system.stiffness(1, 1) + e.c * e.c * system.stiffness(2, 2);
  CHECK(energy / (2 * y1 * y1) == Approx(m.area).epsilon(1e-12));
}

TEST_CASE("a conformal change of the metric leaves the stiffness as it is, and changes the mass", "[geometry]") {
  const GalerkinSystem moved = galerkin_system(Moebius{1.5}, {.degree = 6, .nodes = 60});
  const Eigen::ArrayXd l = harmonic_degrees(6);
  CHECK((moved.stiffness - Eigen::MatrixXd((l * (l + 1)).matrix().asDiagonal())).cwiseAbs().maxCoeff() < 1e-11);
  CHECK(moved.mass(0, 0) == Approx(1));
  CHECK(std::abs(moved.mass(3, 3) - 1) > 0.05);
}

TEST_CASE("the system is the same with any number of threads, to the last bit", "[geometry]") {
  const Ellipsoid e{1, 2, 0.5};
  const GalerkinSystem one = galerkin_system(e, {.degree = 9}), three = galerkin_system(e, {.degree = 9, .threads = 3});
  CHECK(one.mass == three.mass);
  CHECK(one.stiffness == three.stiffness);
}

TEST_CASE("a harmonic function has its values and derivatives", "[geometry]") {
  HarmonicFunction f{2, Eigen::VectorXd::Zero(9)};
  f.coefficients[2] = std::sqrt(4 * pi / 3);  // z
  f.coefficients[0] = std::sqrt(4 * pi);
  const Mat3X s = test::sphere_points();
  CHECK((f.values(s) - (s.row(2).array() + 1).matrix().transpose()).cwiseAbs().maxCoeff() < 1e-14);
  const Vec3d p = s.col(20), e = tangent_frame(p).e2;
  Vec3<Dual<double, 1>> x;
  for (int k = 0; k < 3; ++k) {
    x[k].f = p[k];
    x[k].g[0] = e[k];
  }
  CHECK(f(x).f == Approx(1 + p.z()));
  CHECK(f(x).g[0] == Approx(e.z()));
}

TEST_CASE("too few nodes, negative degrees and crushed surfaces are refused", "[geometry]") {
  CHECK_THROWS_AS(galerkin_system(Ellipsoid{}, {.degree = -1}), InvalidArgument);
  CHECK_THROWS_AS(galerkin_system(Ellipsoid{}, {.degree = 8, .nodes = 8}), InvalidArgument);
  CHECK_THROWS_AS(galerkin_system(Ellipsoid{0, 0, 1}, {.degree = 2}), DegenerateSurface);
}

}  // namespace galerkin_test
