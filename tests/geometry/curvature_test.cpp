#include "catch.hpp"
#include "support/smooth_surfaces.hpp"
#include "support/sphere_points.hpp"

#include <dsns/geometry/curvature.hpp>
#include <dsns/surface/analytic.hpp>

namespace curvature_test {

using namespace dsns;

TEST_CASE("Gaussian and mean curvature of ellipsoids are exact, at the poles and everywhere", "[geometry]") {
  const Mat3X s = test::sphere_points(200);
  for (const Ellipsoid& e : {Ellipsoid{1, 1, 1}, Ellipsoid{1, 1.5, 0.7}, Ellipsoid{1, 2, 5}, Ellipsoid{30, 20, 0.1}}) {
    const Curvature c = curvature(e, s);
    for (Index i = 0; i < s.cols(); ++i) {
      CHECK(c.gaussian[i] == Approx(gaussian_curvature(e, s.col(i))).epsilon(1e-11));
      CHECK(c.mean[i] == Approx(mean_curvature(e, s.col(i))).epsilon(1e-11));
    }
  }
}

TEST_CASE("closed forms of ellipsoids at the ends of their axes are the textbook's", "[geometry]") {
  const Ellipsoid e{1, 2, 5};
  CHECK(gaussian_curvature(e, Vec3d::UnitZ()) == Approx(25.0 / (1 * 4)));  // c^2 / (a^2 b^2)
  CHECK(mean_curvature(e, Vec3d::UnitZ()) == Approx((5.0 / 1 + 5.0 / 4) / 2));
  CHECK(mean_curvature({3, 3, 3}, Vec3d(1, 2, 2).normalized()) == Approx(1.0 / 3));
}

TEST_CASE("principal curvatures of ellipsoids are exact in size and direction", "[geometry]") {
  const Mat3X s = test::sphere_points(200);
  for (const Ellipsoid& e : {Ellipsoid{1, 1.5, 0.7}, Ellipsoid{1, 2, 5}, Ellipsoid{30, 20, 0.1}}) {
    const PrincipalAxes p = principal_curvatures(e, s);
    const Vec3d D(1 / (e.a * e.a), 1 / (e.b * e.b), 1 / (e.c * e.c));
    for (Index i = 0; i < s.cols(); ++i) {
      const Vec3d x = e(Vec3d(s.col(i))), gradient = D.cwiseProduct(x), t1 = p.t1.col(i), t2 = p.t2.col(i);
      CHECK((t1.cross(t2) - gradient.normalized()).norm() < 1e-11);
      // Of the quadric <x, D x> = 1 the normal curvature along a unit vector t is <t, D t> / |D x|; principal directions
      // are conjugate, <t1, D t2> = 0.
      const double k1 = t1.dot(D.cwiseProduct(t1)) / gradient.norm();
      CHECK(p.k1[i] == Approx(k1).epsilon(1e-11));
      CHECK(p.k2[i] == Approx(gaussian_curvature(e, s.col(i)) / k1).epsilon(1e-11));
      CHECK(p.k2[i] == Approx(t2.dot(D.cwiseProduct(t2)) / gradient.norm()).epsilon(1e-9));  // <t2, D t2> loses digits
      CHECK(std::abs(t1.dot(D.cwiseProduct(t2))) < 1e-11 * gradient.norm() * p.k1[i]);
      CHECK(p.k1[i] >= p.k2[i]);
      CHECK(p.k1[i] * p.k2[i] == Approx(gaussian_curvature(e, s.col(i))).epsilon(1e-11));
      CHECK((p.k1[i] + p.k2[i]) / 2 == Approx(mean_curvature(e, s.col(i))).epsilon(1e-11));
    }
  }
}

TEST_CASE("at the ends of an ellipsoid's axes the principal directions are the other axes", "[geometry]") {
  const PrincipalAxes p = principal_curvatures(Ellipsoid{1, 2, 5}, Vec3d::UnitZ());
  CHECK(p.k1[0] == Approx(5.0 / 1).epsilon(1e-14));  // c / a^2 along x
  CHECK(p.k2[0] == Approx(5.0 / 4).epsilon(1e-14));
  CHECK(std::abs(p.t1(0, 0)) == Approx(1));
  CHECK(std::abs(p.t2(1, 0)) == Approx(1));
}

TEST_CASE("at umbilic points the directions are the chart's", "[geometry]") {
  const ChartBatch c = charts_at(test::sphere_points());
  const PrincipalAxes sphere = principal_curvatures(jets(Ellipsoid{2, 2, 2}, c));
  CHECK((sphere.k1.array() - 0.5).abs().maxCoeff() < 1e-14);
  CHECK((sphere.k2.array() - 0.5).abs().maxCoeff() < 1e-14);
  CHECK(test::difference(sphere.t1, c.e1) < 1e-14);
  CHECK(test::difference(sphere.t2, c.e2) < 1e-14);
  // An ellipsoid a > b > c has four: x^2 = a^2 (a^2 - b^2) / (a^2 - c^2), y = 0, with k = a c / b^3 (do Carmo 3-2).
  const double a = 3, b = 2, d = 1, x = std::sqrt((a * a - b * b) / (a * a - d * d));
  const PrincipalAxes p = principal_curvatures(Ellipsoid{a, b, d}, Vec3d(x, 0, std::sqrt(1 - x * x)));
  CHECK(p.k1[0] ==
        Approx(a * d / (b * b * b)).epsilon(1e-7));  // the square root of rounding: k1 - k2 is a distance there
  CHECK(p.k2[0] == Approx(a * d / (b * b * b)).epsilon(1e-7));
  CHECK(std::abs(p.t1.col(0).dot(p.t2.col(0))) < 1e-14);
}

namespace {

/// (r(z) x, r(z) y, z) with a waist: a surface of revolution with profile rho = sqrt(1 - z^2) r(z).
struct Vase {
  template <class T>
  Vec3<T> operator()(const Vec3<T>& s) const {
    const T r = 0.5 + 0.8 * s.z() * s.z();
    return {r * s.x(), r * s.y(), s.z()};
  }
};

/// r(s) s with a radius that is a polynomial, and the same body as a level set.
struct Star {
  template <class T>
  static T radius(const Vec3<T>& s) {
    return 1.0 + 0.4 * s.x() * s.y() + 0.3 * s.z() * s.z() * s.z() - 0.2 * s.x();
  }
  template <class T>
  Vec3<T> operator()(const Vec3<T>& s) const {
    return s * radius(s);
  }
};

}  // namespace

TEST_CASE("curvatures of a surface of revolution are the textbook's", "[geometry]") {
  const Mat3X s = test::sphere_points(100);
  const PrincipalAxes p = principal_curvatures(Vase{}, s);
  for (Index i = 0; i < s.cols(); ++i) {
    const double z = s(2, i);
    if (std::abs(z) > 0.999) {  // on the axis, up to the square of the distance
      CHECK(p.k1[i] == Approx(p.k2[i]).epsilon(1e-6));
      continue;
    }
    const auto zz = Jet2<double, 1>::variable(z, 0);
    const auto rho = sqrt(1.0 - zz * zz) * (0.5 + 0.8 * zz * zz);
    const double slope = std::sqrt(1 + rho.g[0] * rho.g[0]);
    const double meridian = -rho.h[0] / (slope * slope * slope), parallel = 1 / (rho.f * slope);
    CHECK(p.k1[i] == Approx(std::max(meridian, parallel)).epsilon(1e-11));
    CHECK(p.k2[i] == Approx(std::min(meridian, parallel)).epsilon(1e-10));
    const Vec3d around = Vec3d::UnitZ().cross(Vec3d(s.col(i))).normalized();
    CHECK(std::abs((parallel > meridian ? p.t1 : p.t2).col(i).dot(around)) == Approx(1).epsilon(1e-12));
  }
}

TEST_CASE("curvatures of a star-shaped body are those of its level set", "[geometry]") {
  // Goldman 2005: K = <g, adj(h) g> / |g|^4, H = (|g|^2 tr h - <g, h g>) / (2 |g|^3) of F = |p| - r(p / |p|).
  const Mat3X s = test::sphere_points(100);
  const Curvature c = curvature(Star{}, s);
  for (Index i = 0; i < s.cols(); ++i) {
    using J = Jet2<double, 3>;
    const Vec3d x = Star{}(Vec3d(s.col(i)));
    const Vec3<J> p(J::variable(x[0], 0), J::variable(x[1], 1), J::variable(x[2], 2));
    const J length = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
    const J F = length - Star::radius(Vec3<J>(p[0] / length, p[1] / length, p[2] / length));
    const Vec3d g(F.g[0], F.g[1], F.g[2]);
    Mat3 h, adjugate;
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) h(a, b) = F.hessian(a, b);
    adjugate << h.col(1).cross(h.col(2)), h.col(2).cross(h.col(0)), h.col(0).cross(h.col(1));
    CHECK(c.gaussian[i] == Approx(g.dot(adjugate * g) / std::pow(g.norm(), 4)).epsilon(1e-11).margin(1e-11));
    CHECK(c.mean[i] ==
          Approx((g.squaredNorm() * h.trace() - g.dot(h * g)) / (2 * std::pow(g.norm(), 3))).epsilon(1e-11));
  }
}

TEST_CASE("the shape operator is the change of the normal", "[law]") {
  const ChartBatch c = charts_at(test::sphere_points(20));
  constexpr double h = 1e-4;
  const auto normals_at = [](const auto& surface, const Mat3X& s) {
    return unit_normals(tangents(surface, charts_at(s.colwise().normalized())));
  };
  test::visit_smooth_surfaces([&](const std::string& name, const test::AnySurface& surface) {
    INFO(name);
    const SurfaceJets j = jets(surface, c);
    const TangentTensor S = shape_operator(j);
    const Mat3X nu =
        (8 * (normals_at(surface, c.s + std::tan(h) * c.e1) - normals_at(surface, c.s - std::tan(h) * c.e1)) -
         (normals_at(surface, c.s + std::tan(2 * h) * c.e1) - normals_at(surface, c.s - std::tan(2 * h) * c.e1))) /
        (12 * h);
    for (Index i = 0; i < c.size(); ++i) {
      const Vec3d t1 = S.t1.col(i), t2 = S.t2.col(i), fu = j.fu.col(i);
      const double x = fu.dot(t1), y = fu.dot(t2);
      const Vec3d image = (S.xx[i] * x + S.xy[i] * y) * t1 + (S.xy[i] * x + S.yy[i] * y) * t2;
      CHECK((image - nu.col(i)).norm() < 1e-8 * (1 + image.norm()));
    }
  });
}

TEST_CASE("curvatures do not depend on the frames of the charts", "[law]") {
  const ChartBatch c = charts_at(test::sphere_points()), turned = test::turned_frames(c, 0.7);
  test::visit_smooth_surfaces([&](const std::string& name, const test::AnySurface& surface) {
    INFO(name);
    const Curvature a = curvature(jets(surface, c)), b = curvature(jets(surface, turned));
    CHECK(test::difference(a.gaussian, b.gaussian) < 1e-12);
    CHECK(test::difference(a.mean, b.mean) < 1e-12);
    const PrincipalAxes p = principal_curvatures(jets(surface, c)), q = principal_curvatures(jets(surface, turned));
    for (Index i = 0; i < c.size(); ++i)
      if (p.k1[i] - p.k2[i] > 1e-3) CHECK(std::abs(p.t1.col(i).dot(q.t1.col(i))) == Approx(1).epsilon(1e-12));
  });
}

TEST_CASE("curvatures are functions of the place: turned and reparametrised bodies have the same", "[law]") {
  const SphereDiffeomorphism gamma = random_diffeomorphism(6, 4, 0.15);
  const Mat3 O = rotation_exp(Vec3d(0.7, -0.2, 0.4));
  const Mat3X s = test::sphere_points(), images = gamma(s);
  test::visit_formulas([&](const std::string& name, const test::AnySurface& surface) {
    INFO(name);
    const PrincipalAxes a = principal_curvatures(rotated(reparametrized(surface, gamma), O), s),
                        b = principal_curvatures(surface, images);
    CHECK(test::difference(a.k1, b.k1) < 1e-11);
    CHECK(test::difference(a.k2, b.k2) < 1e-11);
    for (Index i = 0; i < s.cols(); ++i)
      if (a.k1[i] - a.k2[i] > 1e-3) CHECK(std::abs(a.t1.col(i).dot(O * b.t1.col(i))) == Approx(1).epsilon(1e-12));
  });
}

}  // namespace curvature_test
