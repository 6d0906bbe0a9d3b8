#include "catch.hpp"

#include <dsns/geometry/integrals.hpp>
#include <dsns/geometry/mean_curvature_flow.hpp>
#include <dsns/surface/analytic.hpp>
#include <dsns/surface/any_surface.hpp>

namespace mean_curvature_flow_test {

using namespace dsns;

namespace {

HarmonicSurface ellipsoid(double a, double b, double c, int degree) {
  return project_on_harmonics(Ellipsoid{a, b, c}, degree);
}

double axis_ratio(const HarmonicSurface& f) { return f(Vec3d(0, 0, 1)).z() / f(Vec3d(1, 0, 0)).x(); }

}  // namespace

TEST_CASE("a sphere shrinks as sqrt(r^2 - 4 t), to the first order of the step, wherever it is", "[geometry]") {
  const auto variant = GENERATE(CurvatureFlow::exact, CurvatureFlow::conformalized);
  HarmonicSurface start = ellipsoid(2, 2, 2, 1);
  Eigen::MatrixX3d c = start.coefficients();
  const Vec3d centre(3, -1, 2);
  c.row(0) = std::sqrt(4 * pi) * centre.transpose();
  start = HarmonicSurface(c);
  std::vector<double> errors;
  for (const double step : {0.02, 0.01, 0.005}) {
    const MeanCurvatureFlow flow =
        mean_curvature_flow(start, {.times = {0.2, 0.6}, .step = step, .degree = 3, .variant = variant});
    REQUIRE(flow.surfaces.size() == 2);
    REQUIRE(flow.summary.times.size() == 1 + std::size_t(std::lround(0.6 / step)));
    const double r = (flow.surfaces[1](Vec3d(0.6, 0, 0.8)) - centre).norm();
    errors.push_back(r - std::sqrt(4 - 4 * 0.6));
    CHECK(flow.summary.areas.back() == Approx(4 * pi * r * r));
    CHECK(flow.summary.volumes.back() == Approx(4 * pi / 3 * r * r * r));
    CHECK(flow.summary.energies.back() == Approx(4 * pi * r * r));  // spheres about one point are conformal
  }
  INFO("errors " << errors[0] << ", " << errors[1] << ", " << errors[2]);
  CHECK(std::abs(errors[2]) < 6e-3);
  CHECK(errors[0] / errors[1] == Approx(2).epsilon(0.05));
  CHECK(errors[1] / errors[2] == Approx(2).epsilon(0.025));
}

TEST_CASE("the flow starts with the velocity -2 H n, and its area falls at the rate of the integral of (2 H)^2",
          "[geometry]") {
  const Ellipsoid e{1, 1.2, 1.5};
  const HarmonicSurface start = ellipsoid(1, 1.2, 1.5, 12);
  const SphereQuadrature q = sphere_quadrature(40);
  const SurfaceJets j = jets(e, charts_at(q.points));
  const Curvature c = curvature(j);
  const Eigen::VectorXd dA = area_normals(j).colwise().norm().transpose().cwiseProduct(q.weights);
  const double rate = -4 * c.mean.cwiseAbs2().dot(dA);
  const double step = 1e-4;
  const MeanCurvatureFlow once = mean_curvature_flow(start, {.times = {step}, .step = step});
  const MeanCurvatureFlow twice = mean_curvature_flow(start, {.times = {step / 2}, .step = step});
  const auto slope = [](const MeanCurvatureFlow& f) {
    return (f.summary.areas[1] - f.summary.areas[0]) / f.summary.times[1];
  };
  CHECK(2 * slope(twice) - slope(once) == Approx(rate).epsilon(1e-5));

  const Mat3X a = (once.surfaces[0].positions(q.points) - j.f) / step,
              b = (twice.surfaces[0].positions(q.points) - j.f) / (step / 2);
  const Mat3X exact = -2 * unit_normals(j) * c.mean.asDiagonal();
  CHECK((2 * b - a - exact).colwise().norm().maxCoeff() < 5e-4 * exact.colwise().norm().maxCoeff());
}

TEST_CASE("a convex body becomes round as it shrinks, and neither area nor Dirichlet bound is broken", "[geometry]") {
  const auto variant = GENERATE(CurvatureFlow::exact, CurvatureFlow::conformalized);
  const MeanCurvatureFlow flow =
      mean_curvature_flow(ellipsoid(1, 1.1, 1.4, 8), {.times = {0, 0.1, 0.2, 0.3}, .step = 0.01, .variant = variant});
  for (std::size_t k = 1; k < 4; ++k) CHECK(axis_ratio(flow.surfaces[k]) < axis_ratio(flow.surfaces[k - 1]));
  CHECK(axis_ratio(flow.surfaces[0]) == Approx(1.4));
  CHECK(axis_ratio(flow.surfaces[3]) < 1.25);
  const auto& m = flow.summary;
  for (std::size_t k = 1; k < m.areas.size(); ++k) {
    CHECK(m.areas[k] < m.areas[k - 1]);
    CHECK(m.energies[k] > m.areas[k]);
    CHECK(sphericity(m.areas[k], m.volumes[k]) > sphericity(m.areas[k - 1], m.volumes[k - 1]));
  }
  CHECK(m.energies[0] == Approx(m.areas[0]));
}

TEST_CASE("the conformalised flow makes a limbed body a sphere of its area, conformally", "[geometry]") {
  LimbedBody body;
  body.axes = {1, 0.8, 0.6};
  body.limbs = {{Vec3d(1, 1, 0).normalized(), 5, Vec3d(0.6, 0.3, 0.2), Vec3d(0, 0.2, 0.1), 0.2},
                {Vec3d(-1, 0.2, 0.4).normalized(), 4, Vec3d(-0.4, 0.1, 0.1)}};
  const HarmonicSurface start = project_on_harmonics(at_time(body, 0.3), 10);
  const MeanCurvatureFlow flow = mean_curvature_flow(
      start, {.times = {0, 6}, .step = 0.15, .variant = CurvatureFlow::conformalized, .area = FlowArea::kept});
  const auto& m = flow.summary;
  CHECK(m.areas.back() == Approx(m.areas.front()).epsilon(1e-12));
  CHECK(1 - sphericity(m.areas.front(), m.volumes.front()) > 0.2);
  CHECK(1 - sphericity(m.areas.back(), m.volumes.back()) < 1e-4);
  CHECK(m.energies.back() / m.areas.back() - 1 < 1e-4);
  CHECK(measure(flow.surfaces[0], sphere_quadrature(30)).area == Approx(m.areas.front()).epsilon(1e-6));
  CHECK(measure(flow.surfaces[1], sphere_quadrature(30)).total_curvature == Approx(4 * pi).epsilon(1e-3));
}

TEST_CASE("a body whose area is kept stays where it is", "[geometry]") {
  Eigen::MatrixX3d c = ellipsoid(1, 1.1, 1.3, 5).coefficients();
  const Vec3d centre(4, -2, 1);
  c.row(0) += std::sqrt(4 * pi) * centre.transpose();
  const MeanCurvatureFlow flow =
      mean_curvature_flow(HarmonicSurface(c), {.times = {0.1}, .step = 0.02, .area = FlowArea::kept});
  CHECK((measure(flow.surfaces[0], sphere_quadrature(20)).area_centroid - centre).norm() < 1e-12);
  CHECK(flow.summary.areas[5] == Approx(flow.summary.areas[0]).epsilon(1e-12));
}

TEST_CASE("the flow does not depend on threads, and refuses steps past the end, folds and wrong options",
          "[geometry]") {
  const HarmonicSurface body = ellipsoid(1, 1.1, 1.3, 6);
  const MeanCurvatureFlow one = mean_curvature_flow(body, {.times = {0.02}, .step = 0.01}),
                          two = mean_curvature_flow(body, {.times = {0.02}, .step = 0.01, .threads = 2});
  CHECK(one.surfaces[0].coefficients() == two.surfaces[0].coefficients());

  CHECK_THROWS_AS(mean_curvature_flow(ellipsoid(1, 1, 1, 1), {.times = {0.3}, .step = 0.01}), DegenerateSurface);
  CHECK_THROWS_AS(mean_curvature_flow(ellipsoid(1, 0, 0, 1), {}), DegenerateSurface);
  Eigen::MatrixX3d folded = body.coefficients();
  folded.row(24) = folded.row(2) * 2;
  CHECK_THROWS_AS(mean_curvature_flow(HarmonicSurface(folded), {.times = {0}}), DegenerateSurface);
  CHECK(mean_curvature_flow(HarmonicSurface(folded), {.times = {0}, .largest_turn = pi}).summary.turns[0] > pi / 2);
  CHECK_THROWS_AS(mean_curvature_flow(body, {.step = 0}), InvalidArgument);
  CHECK_THROWS_AS(mean_curvature_flow(body, {.times = {0.2, 0.1}}), InvalidArgument);
}

}  // namespace mean_curvature_flow_test
