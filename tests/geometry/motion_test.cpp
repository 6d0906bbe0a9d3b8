#include "catch.hpp"
#include "support/smooth_surfaces.hpp"
#include "support/sphere_points.hpp"

#include <dsns/geometry/motion.hpp>
#include <dsns/mesh/sphere_mesh.hpp>
#include <dsns/mesh/triangle_mesh.hpp>
#include <dsns/surface/sampled.hpp>

namespace motion_test {

using namespace dsns;

namespace {

/// (A + t B) s.
struct Affine {
  Mat3 A, B;
  template <class T>
  Vec3<T> operator()(const Vec3<T>& s, const T& t) const {
    Vec3<T> p(T(0.0), T(0.0), T(0.0));
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) p[i] += (A(i, k) + B(i, k) * t) * s[k];
    return p;
  }
};

Affine affine() {
  Affine motion;
  motion.A << 1, 0.2, 0, 0, 1.5, -0.3, 0.1, 0, 0.8;
  motion.B << 0.3, -0.1, 0.5, 0.2, 0.4, 0, 0, 0.6, -0.2;
  return motion;
}

/// Calls visit(name, surface) for moving surfaces.
void visit_motions(const test::MotionVisitor& visit) {
  test::visit_motions(visit);
  visit("affine", AnyAnimatedSurface(affine()));
}

/// An ellipsoid that turns about an axis of its own and drifts.
struct Spinning {
  template <class T>
  Vec3<T> operator()(const Vec3<T>& s, const T& t) const {
    using std::cos, std::sin;
    const T x = s.x(), y = 2.0 * s.y(), c = cos(3.0 * t), w = sin(3.0 * t);
    return {c * x - w * y + t, w * x + c * y, 0.5 * s.z() - t * t};
  }
};

}  // namespace

TEST_CASE("a growing sphere grows by the closed forms", "[geometry]") {
  const auto balloon = [](const auto& s, const auto& t) {
    auto p = s;
    for (int k = 0; k < 3; ++k) p[k] = p[k] * (1.0 + 2.0 * t);
    return p;
  };
  const SphereQuadrature q = sphere_quadrature(8);
  const MeasureRates r = measure_rates(balloon, q, 0.5);  // radius 2, speed 2
  CHECK(r.area == Approx(8 * pi * 2 * 2).epsilon(1e-12));
  CHECK(r.area_by_curvature == Approx(8 * pi * 2 * 2).epsilon(1e-12));
  CHECK(r.volume == Approx(4 * pi * 4 * 2).epsilon(1e-12));
  const MotionJets j = motion_jets(balloon, charts_at(test::sphere_points()), 0.5);
  CHECK((normal_velocities(j).array() - 2).abs().maxCoeff() < 1e-13);
  const PrincipalAxes rates = principal_axes(strain_rates(j));
  CHECK((rates.k1.array() - 1).abs().maxCoeff() < 1e-13);  // 2 / 2: lengths grow by their own half
  CHECK((rates.k2.array() - 1).abs().maxCoeff() < 1e-13);
}

TEST_CASE("a rigid motion strains nothing and keeps all measures", "[geometry]") {
  const MotionJets j = motion_jets(Spinning{}, charts_at(test::sphere_points()), 0.4);
  const TangentTensor d = strain_rates(j);
  CHECK(d.xx.cwiseAbs().maxCoeff() + d.xy.cwiseAbs().maxCoeff() + d.yy.cwiseAbs().maxCoeff() < 1e-13);
  CHECK(area_density_rates(j).cwiseAbs().maxCoeff() < 1e-12);
  CHECK(j.ft.cwiseAbs().maxCoeff() > 1);
  const MeasureRates r = measure_rates(Spinning{}, sphere_quadrature(60), 0.4);
  CHECK(std::abs(r.area) < 1e-11);
  CHECK(std::abs(r.area_by_curvature) < 1e-8);
  CHECK(std::abs(r.volume) < 1e-11);
}

TEST_CASE("the strain rate of an affine motion is the symmetric part of its velocity gradient", "[geometry]") {
  const Affine motion = affine();
  const double t = 0.6;
  const Mat3 gradient = motion.B * (motion.A + t * motion.B).inverse(), D = (gradient + gradient.transpose()) / 2;
  const MotionJets j = motion_jets(motion, charts_at(test::sphere_points()), t);
  const TangentTensor d = strain_rates(j);
  const PrincipalAxes p = principal_axes(d);
  for (Index i = 0; i < j.size(); ++i) {
    const Vec3d t1 = d.t1.col(i), t2 = d.t2.col(i);
    CHECK(d.xx[i] == Approx(t1.dot(D * t1)).margin(1e-12));
    CHECK(d.xy[i] == Approx(t1.dot(D * t2)).margin(1e-12));
    CHECK(d.yy[i] == Approx(t2.dot(D * t2)).margin(1e-12));
    CHECK(p.k1[i] == Approx(p.t1.col(i).dot(D * p.t1.col(i))).margin(1e-12));
    CHECK(p.k2[i] == Approx(p.t2.col(i).dot(D * p.t2.col(i))).margin(1e-12));
  }
}

TEST_CASE("rates of area, volume, density and metric are the changes of what they are rates of", "[law]") {
  const SphereQuadrature q = sphere_quadrature(50);  // resolves the sharpest limb to 1e-6
  const ChartBatch c = charts_at(test::sphere_points());
  constexpr double h = 1e-4, t = 0.35;
  visit_motions([&](const std::string& name, const AnyAnimatedSurface& surface) {
    INFO(name);
    const auto rate = [&](const auto& measured) -> std::decay_t<decltype(measured(t))> {  // fourth order
      return (8.0 * (measured(t + h) - measured(t - h)) - (measured(t + 2 * h) - measured(t - 2 * h))) / (12 * h);
    };
    const MeasureRates r = measure_rates(surface, q, t);
    CHECK(r.area == Approx(rate([&](double at) { return area(at_time(surface, at), q); })).epsilon(1e-8));
    CHECK(r.area_by_curvature == Approx(r.area).epsilon(1e-6));
    CHECK(r.volume == Approx(rate([&](double at) { return volume(at_time(surface, at), q); })).epsilon(1e-6));
    const MotionJets j = motion_jets(surface, c, t);
    const auto tangents_at = [&](double at) { return tangents(surface, c, at); };
    const Eigen::VectorXd density = rate([&](double at) -> Eigen::VectorXd { return area_densities(tangents_at(at)); });
    CHECK(test::difference(area_density_rates(j), density) < 1e-8);
    const FirstFundamentalForm m = metric_rates(j);
    const Eigen::VectorXd E =
        rate([&](double at) { return Eigen::VectorXd(first_fundamental_form(tangents_at(at)).E); });
    const Eigen::VectorXd F =
        rate([&](double at) { return Eigen::VectorXd(first_fundamental_form(tangents_at(at)).F); });
    const Eigen::VectorXd G =
        rate([&](double at) { return Eigen::VectorXd(first_fundamental_form(tangents_at(at)).G); });
    CHECK(test::difference(m.E, E) + test::difference(m.F, F) + test::difference(m.G, G) < 1e-8);
    // The trace of the strain rate is the relative rate of area.
    CHECK(test::difference(strain_rates(j).trace(), area_density_rates(j).cwiseQuotient(area_densities(j))) < 1e-12);
  });
}

TEST_CASE("strain rates do not depend on the frames of the charts", "[law]") {
  const ChartBatch c = charts_at(test::sphere_points()), turned = test::turned_frames(c, 0.7);
  visit_motions([&](const std::string& name, const AnyAnimatedSurface& surface) {
    INFO(name);
    const PrincipalAxes a = principal_axes(strain_rates(motion_jets(surface, c, 0.2))),
                        b = principal_axes(strain_rates(motion_jets(surface, turned, 0.2)));
    CHECK(test::difference(a.k1, b.k1) < 1e-12);
    CHECK(test::difference(a.k2, b.k2) < 1e-12);
  });
}

TEST_CASE("a sampled body's area changes as its motion jets say", "[geometry]") {
  const SampledSurface body(sequence_of(test::two_limbs(), icosphere(2), 12), icosphere(2).vertices);
  const SphereQuadrature q = sphere_quadrature(20);
  constexpr double h = 1e-5, t = 0.35;
  const double change = (area(at_time(body, t + h), q) - area(at_time(body, t - h), q)) / (2 * h);
  CHECK(area_density_rates(motion_jets(body, charts_at(q.points), t)).dot(q.weights) == Approx(change).epsilon(1e-7));
}

}  // namespace motion_test
