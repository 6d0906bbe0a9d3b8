#include "catch.hpp"
#include "support/smooth_surfaces.hpp"
#include "support/sphere_points.hpp"

#include <dsns/geometry/curvature.hpp>
#include <dsns/geometry/operators.hpp>
#include <dsns/sphere/quadrature.hpp>

namespace operators_test {

using namespace dsns;

namespace {

struct Wave {
  template <class T>
  T operator()(const Vec3<T>& s) const {
    using std::sin;
    return sin(2.0 * s.x() + s.y()) + s.z() * s.z() * s.x();
  }
};

/// An arbitrary field, not tangential.
struct Swirl {
  template <class T>
  Vec3<T> operator()(const Vec3<T>& s) const {
    return {s.y() * s.z() + 0.3, s.x() - s.z() * s.z(), s.x() * s.y() + 2.0 * s.z()};
  }
};

/// u(p) = p_x^2 p_y + p_z on an ellipsoid, and its surface gradient in closed form: the tangential part of the gradient in R^3.
struct Cubic {
  Ellipsoid e;
  template <class T>
  T operator()(const Vec3<T>& s) const {
    const Vec3<T> p = e(s);
    return p.x() * p.x() * p.y() + p.z();
  }
};
struct CubicGradient {
  Ellipsoid e;
  template <class T>
  Vec3<T> operator()(const Vec3<T>& s) const {
    const Vec3<T> p = e(s), n(s.x() / e.a, s.y() / e.b, s.z() / e.c), g(2.0 * p.x() * p.y(), p.x() * p.x(), T(1.0));
    const T along = (g[0] * n[0] + g[1] * n[1] + g[2] * n[2]) / (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    return {g[0] - along * n[0], g[1] - along * n[1], g[2] - along * n[2]};
  }
};

}  // namespace

TEST_CASE("harmonics are eigenfunctions of the round sphere", "[geometry]") {
  const Mat3X s = test::sphere_points();
  constexpr int degree = 5;
  const Eigen::ArrayXd l = harmonic_degrees(degree);
  const Eigen::MatrixXd y = harmonics(s, degree);
  for (Index k = 0; k < harmonic_count(degree); ++k) {
    const Eigen::VectorXd unit = Eigen::VectorXd::Unit(harmonic_count(degree), k);
    CHECK((laplace_beltrami(Ellipsoid{2, 2, 2}, unit, s) + l[k] * (l[k] + 1) / 4 * y.col(k)).cwiseAbs().maxCoeff() <
          1e-11);
  }
  CHECK_THROWS_AS(laplace_beltrami(Ellipsoid{}, Eigen::VectorXd(5), s), InvalidArgument);
}

TEST_CASE("harmonic coefficients and the functor they stand for have the same jets", "[geometry]") {
  const ChartBatch c = charts_at(test::sphere_points());
  Eigen::VectorXd coefficients(harmonic_count(4));
  for (Index i = 0; i < coefficients.size(); ++i) coefficients[i] = std::sin(3.7 * double(i));
  const auto functor = [&](const auto& s) {
    const auto y = harmonics(s, 4);
    auto sum = coefficients[0] * y[0];
    for (Index k = 1; k < y.size(); ++k) sum += coefficients[k] * y[k];
    return sum;
  };
  const FunctionJets<1> a = function_jets(coefficients, c), b = function_jets(functor, c);
  for (const auto field : {&FunctionJets<1>::f, &FunctionJets<1>::fu, &FunctionJets<1>::fv, &FunctionJets<1>::fuu,
                           &FunctionJets<1>::fuv, &FunctionJets<1>::fvv})
    CHECK((a.*field - b.*field).cwiseAbs().maxCoeff() < 1e-11);
}

TEST_CASE("gradients are closed forms, and div grad is the Laplacian", "[geometry]") {
  const Mat3X s = test::sphere_points();
  for (const Ellipsoid& e : {Ellipsoid{1, 1, 1}, Ellipsoid{1, 1.5, 0.7}, Ellipsoid{2, 1, 3}}) {
    const CubicGradient exact{e};
    CHECK(test::difference(surface_gradient(e, Cubic{e}, s), positions(exact, s)) < 1e-12);
    CHECK(test::difference(laplace_beltrami(e, Cubic{e}, s), surface_divergence(e, exact, s)) < 1e-11);
  }
}

TEST_CASE("the Laplacian of the position is -2 H n", "[law]") {
  const ChartBatch c = charts_at(test::sphere_points());
  test::visit_formulas([&](const std::string& name, const test::AnySurface& surface) {
    INFO(name);
    const SurfaceJets j = jets(surface, c);
    const Mat3X expected = unit_normals(j) * (-2 * curvature(j).mean).asDiagonal();
    for (int k = 0; k < 3; ++k) {
      const auto coordinate = [&](const auto& s) { return surface(s)[k]; };
      CHECK(test::difference(laplace_beltrami(j, function_jets(coordinate, c)).transpose(), expected.row(k)) < 1e-11);
    }
  });
}

TEST_CASE("on closed surfaces divergences integrate to that of the normal part, and Green's formula holds", "[law]") {
  const SphereQuadrature q = sphere_quadrature(160);  // resolves the sharpest ripples to 1e-7
  const ChartBatch c = charts_at(q.points);
  const FunctionJets<1> u = function_jets(Wave{}, c),
                        w = function_jets([](const auto&s) { return s.x() * s.y() + s.x(); }, c);
  test::visit_smooth_surfaces([&](const std::string& name, const test::AnySurface& surface) {
    INFO(name);
    const SurfaceJets j = jets(surface, c);
    const Eigen::VectorXd area = area_densities(j).cwiseProduct(q.weights);
    CHECK(std::abs(laplace_beltrami(j, u).dot(area)) < 1e-6);
    const double products = surface_gradient(j, u).cwiseProduct(surface_gradient(j, w)).colwise().sum() * area;
    CHECK(products == Approx(-w.f.dot(laplace_beltrami(j, u).cwiseProduct(area))).epsilon(1e-6).margin(1e-6));
    CHECK(products == Approx(-u.f.dot(laplace_beltrami(j, w).cwiseProduct(area))).epsilon(1e-6).margin(1e-6));
    const SurfaceTangents X = tangents(Swirl{}, c);
    const Eigen::VectorXd normal = unit_normals(j).cwiseProduct(X.f).colwise().sum().transpose();
    CHECK(surface_divergence(j, X).dot(area) ==
          Approx(2 * curvature(j).mean.cwiseProduct(normal).dot(area)).epsilon(1e-6).margin(1e-6));
  });
}

TEST_CASE("gradient, divergence and Laplacian do not depend on the frames of the charts", "[law]") {
  const ChartBatch c = charts_at(test::sphere_points()), turned = test::turned_frames(c, 0.7);
  const FunctionJets<1> u = function_jets(Wave{}, c), v = function_jets(Wave{}, turned);
  test::visit_smooth_surfaces([&](const std::string& name, const test::AnySurface& surface) {
    INFO(name);
    const SurfaceJets j = jets(surface, c), k = jets(surface, turned);
    CHECK(test::difference(surface_gradient(j, u), surface_gradient(k, v)) < 1e-12);
    CHECK(test::difference(laplace_beltrami(j, u), laplace_beltrami(k, v)) < 1e-11);
    CHECK(test::difference(surface_divergence(j, tangents(Swirl{}, c)),
                           surface_divergence(k, tangents(Swirl{}, turned))) < 1e-12);
  });
}

TEST_CASE("the Laplacian goes with a reparametrisation", "[law]") {
  const LimbedBody body = test::two_limbs();
  const SphereDiffeomorphism gamma = random_diffeomorphism(6, 4, 0.15);
  const RegisteredSurface moved(body, rotation_exp(Vec3d(0.7, -0.2, 0.4)), gamma);
  const Mat3X s = test::sphere_points();
  const auto pulled = [&](const auto& p) { return Wave{}(gamma(p)); };
  CHECK(test::difference(laplace_beltrami(at_time(moved, 0.4), pulled, s),
                         laplace_beltrami(at_time(body, 0.4), Wave{}, gamma(s))) < 1e-11);
}

}  // namespace operators_test
