#include "catch.hpp"

#include <dsns/elastic/registered_surface.hpp>
#include <dsns/elastic/spatial_registration.hpp>
#include <dsns/geometry/integrals.hpp>
#include <dsns/mesh/sphere_mesh.hpp>
#include <dsns/surface/analytic.hpp>
#include <dsns/surface/sampled.hpp>

namespace spatial_registration_test {

using namespace dsns;

namespace {

LimbedBody some_body() {
  LimbedBody body;
  body.axes = {1, 0.8, 0.6};
  body.limbs = {{Vec3d(1, 0.3, 0.2).normalized(), 6, Vec3d(0.7, 0.2, 0.1)},
                {Vec3d(-1, 0.5, 0.4).normalized(), 5, Vec3d(-0.5, 0.3, 0.3)},
                {Vec3d(0, -1, 0.4).normalized(), 6, Vec3d(0, -0.6, 0.3)}};
  return body;
}

double rms_angle_deg(const Mat3X& a, const Mat3X& b) {
  double sum = 0;
  for (Index i = 0; i < a.cols(); ++i) sum += std::pow(angle_between(a.col(i), b.col(i)), 2);
  return std::sqrt(sum / double(a.cols())) * 180 / pi;
}

/// Small grids and few levels: what a test can afford under the sanitizers.
SpatialOptions quick() {
  SpatialOptions o;
  o.levels = {{1, 6, 0.03, 0.5}, {2, 6, 0.02, 0.5}, {3, 8, 0.0, 0.5}, {4, 10, 0.0, 0.0}};
  o.latitudes = 14;
  o.rotations = 150;
  o.refined = 3;
  o.refinement = {};
  return o;
}

}  // namespace

TEST_CASE("a known warp and rotation of one body is recovered", "[elastic]") {
  const LimbedBody body = some_body();
  const SphereDiffeomorphism gamma = random_diffeomorphism(7, 3, 2.3 * pi / 180);
  const Mat3 O = rotation_exp(Vec3d(0.5, 1.2, -0.7));
  const RegisteredSurface moved(body, O, gamma);
  const SpatialResult r = register_spatially(at_time(moved, 0.0), at_time(body, 0.0), quick());
  const Mat3X s = fibonacci_sphere(300).points;
  INFO("the warp is " << rms_angle_deg(gamma(s), s) << " degrees, missed by " << rms_angle_deg(gamma(s), r.gamma(s)));
  CHECK(rms_angle_deg(gamma(s), s) > 2);
  CHECK(rms_angle_deg(gamma(s), r.gamma(s)) < 0.1);
  CHECK(rotation_angle(r.rotation * O.transpose()) * 180 / pi < 0.1);
  CHECK(r.summary.min_jacobian > 0);
  CHECK(r.summary.energy_after < 1e-4 * r.summary.energy_before);
  CHECK(r.summary.norm == Approx(measure(at_time(body, 0.0), sphere_quadrature(40)).area).epsilon(0.01));
}

TEST_CASE("what a mask hides does not disturb the registration", "[elastic]") {
  // Around the south pole the second body has a dent that the first lacks.
  const LimbedBody body = some_body();
  LimbedBody dented = body;
  dented.limbs.push_back({-Vec3d::UnitZ(), 30, Vec3d(0.25, 0, 0.25)});
  const SphereDiffeomorphism gamma = random_diffeomorphism(7, 3, 2.3 * pi / 180);
  const RegisteredSurface moved(body, Mat3::Identity(), gamma);
  SpatialOptions options = quick();
  options.search = RotationSearch::none;
  const auto missed = [&] {
    const SpatialResult r = register_spatially(at_time(moved, 0.0), at_time(dented, 0.0), options);
    const Mat3X s = fibonacci_sphere(600).points;
    double sum = 0;
    int seen = 0;
    for (Index i = 0; i < s.cols(); ++i) {
      if (s(2, i) < -0.6) continue;
      sum += std::pow(angle_between(r.gamma(Vec3d(s.col(i))), gamma(Vec3d(s.col(i)))), 2);
      ++seen;
    }
    return std::sqrt(sum / seen) * 180 / pi;
  };
  const double seen = missed();
  options.mask = [](const Mat3X& s) { return Eigen::VectorXd((s.row(2).array() > -0.75).cast<double>().transpose()); };
  const double hidden = missed();
  INFO("missed by " << seen << " degrees with the dent in sight, by " << hidden << " behind the mask");
  CHECK(hidden < 0.5 * seen);

  options.mask = [](const Mat3X& s) { return Eigen::VectorXd::Zero(s.cols()).eval(); };
  CHECK_THROWS_AS(register_spatially(at_time(moved, 0.0), at_time(body, 0.0), options), InvalidArgument);
}

TEST_CASE("a surface is registered to itself by the identity", "[elastic]") {
  const LimbedBody body = some_body();
  const SpatialResult r = register_spatially(at_time(body, 0.0), at_time(body, 0.0), quick());
  const Mat3X s = fibonacci_sphere(100).points;
  CHECK(r.summary.energy_after <= r.summary.energy_before);
  CHECK(r.summary.energy_after < 1e-12);
  CHECK(rms_angle_deg(r.gamma(s), s) < 1e-3);
}

TEST_CASE("spatial registration repeats and does not depend on the threads", "[elastic]") {
  const LimbedBody body = some_body();
  LimbedBody other = body;
  other.axes = {0.9, 0.9, 0.6};
  SpatialOptions options = quick();
  options.levels.resize(2);
  const SpatialResult one = register_spatially(at_time(body, 0.0), at_time(other, 0.0), options);
  options.threads = 3;
  const SpatialResult three = register_spatially(at_time(body, 0.0), at_time(other, 0.0), options);
  CHECK(one.summary.energy_after == three.summary.energy_after);
  CHECK(one.rotation == three.rotation);
}

TEST_CASE("stacks of different sizes are refused", "[elastic]") {
  const std::vector<HarmonicSurface> two(2, project_on_harmonics(Ellipsoid{}, 2));
  CHECK_THROWS_AS(register_harmonic(std::span(two).first(1), two), InvalidArgument);
  SpatialOptions none;
  none.levels.clear();
  CHECK_THROWS_AS(register_harmonic(two, two, none), InvalidArgument);
}

}  // namespace spatial_registration_test
