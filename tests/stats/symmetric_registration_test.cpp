#include "catch.hpp"

#include <dsns/elastic/known_warp.hpp>
#include <dsns/stats/symmetric_registration.hpp>
#include <dsns/surface/any_surface.hpp>
#include <dsns/surface/bodies.hpp>

namespace symmetric_registration_test {

using namespace dsns;

namespace {

LimbedBody creature(double width) {
  LimbedBody body;
  body.axes = {1, width, 0.7};
  body.limbs = {{Vec3d(0.8, -0.7, -0.5).normalized(), 6, Vec3d(0.3, -0.9, -0.2), Vec3d(0, 0.1, 0.05)},
                {Vec3d(-0.8, 0.6, -0.5).normalized(), 6, Vec3d(-0.2, 0.6, -0.7), Vec3d(0, 0, 0.1)},
                {Vec3d(0.6, 0, 0.9).normalized(), 7, Vec3d(0.4, 0, 0.8), Vec3d(0.1, 0, 0)}};
  return body;
}

SymmetricOptions quick() {
  SymmetricOptions options;
  options.registration.spatial_times = 2;
  options.registration.spatial.latitudes = 10;
  options.registration.spatial.search = RotationSearch::none;
  options.registration.spatial.levels = {{3, 6, 0.02, 0.5}};
  options.registration.spatial.refinement = {{5, 7, 0.0, 0.5}};
  options.fit.degrees = {1, 2, 4, 8};
  return options;
}

}  // namespace

TEST_CASE("a symmetric registration changes over with its bodies", "[stats]") {
  const AnyAnimatedSurface slim(creature(0.6)), wide(creature(0.8));
  SymmetricOptions options = quick();
  const auto slim_side = [](const Mat3X& s) { return Eigen::VectorXd((s.row(0).array() > -0.9).cast<double>()); };
  options.registration.spatial.mask = slim_side;
  const SymmetricRegistration r = register_symmetrically(slim, wide, options);
  std::swap(options.registration.spatial.mask, options.second_mask);
  const SymmetricRegistration changed = register_symmetrically(wide, slim, options);
  const Mat3X s = fibonacci_sphere(300).points;
  const Eigen::VectorXd w = Eigen::VectorXd::Ones(s.cols());
  CHECK(r.averaged == 2);
  CHECK(r.apart.rms > 1e-3);
  CHECK(angular_distance(r.there.gamma(r.back.gamma(s)), s, w).largest < 1e-9);
  CHECK(angular_distance(r.there.gamma(changed.there.gamma(s)), s, w).largest < 1e-9);
  CHECK((r.there.rotation * changed.there.rotation - Mat3::Identity()).norm() < 1e-12);
  CHECK(r.there.summary.energy_after < r.there.summary.energy_before);
  CHECK(r.back.summary.min_jacobian > 0);
}

TEST_CASE("a symmetric registration through warps of both spheres finds a known warp", "[stats]") {
  const LimbedBody body = creature(0.6);
  const KnownWarp truth = known_warp(3, 2, 0.1, KnownTurns::none);
  SymmetricOptions options = quick();
  options.views = 2;
  const AnyAnimatedSurface own(body), warped(RegisteredSurface(body, truth.rotation, truth.gamma));
  const SymmetricRegistration r = register_symmetrically(warped, own, options);
  CHECK(r.averaged == 4);
  CHECK(recovery(truth, r.there.rotation, r.there.gamma).missed < 0.01);
  CHECK(recovery({truth.rotation, inverted(truth.gamma), truth.size}, r.back.rotation, r.back.gamma).missed < 0.01);
  options.views = 0;
  CHECK_THROWS_AS(register_symmetrically(own, own, options), InvalidArgument);
}

}  // namespace symmetric_registration_test
