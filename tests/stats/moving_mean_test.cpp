#include "catch.hpp"

#include <dsns/mesh/sphere_mesh.hpp>
#include <dsns/stats/moving_mean.hpp>
#include <dsns/surface/analytic.hpp>
#include <dsns/surface/any_surface.hpp>

namespace moving_mean_test {

using namespace dsns;

namespace {

LimbedBody some_body(double size, double pace) {
  LimbedBody body;
  body.axes = 0.3 * size * Vec3d(1, 0.8, 0.6);
  body.limbs = {
      {Vec3d(1, 0.3, 0.2).normalized(), 6, 0.3 * size * Vec3d(0.7, 0.2, 0.1), 0.3 * size * Vec3d(0, 0.3, 0.1)},
      {Vec3d(-1, 0.5, 0.4).normalized(), 5, 0.3 * size * Vec3d(-0.5, 0.3, 0.3), 0.3 * size * Vec3d(0, 0.2, 0.3), 0.3}};
  body.pace = pace;
  return body;
}

RegistrationOptions quick() {
  RegistrationOptions o;
  o.spatial.search = RotationSearch::upright;
  o.spatial.levels = {{1, 6, 0.03, 0.5}, {2, 6, 0.02, 0.5}, {3, 8, 0.0, 0.0}};
  o.spatial.refinement = {{4, 8, 0.0, 0.5}};
  o.spatial.latitudes = 12;
  o.spatial.rotations = 100;
  o.spatial.refined = 2;
  o.spatial_times = 2;
  o.rounds = 2;
  o.temporal.grid = 80;
  o.temporal.cosines = {8, 16};
  o.snapshots = 12;
  o.velocities = 64;
  return o;
}

}  // namespace

TEST_CASE("a body moving at another pace on a warped sphere is brought back in space and in time", "[stats]") {
  const LimbedBody body = some_body(1, 0);
  const SphereDiffeomorphism gamma = random_diffeomorphism(7, 3, 1.7 * pi / 180);
  const TimeWarp zeta = random_warp(2, 0.4);
  const RegisteredSurface moved(body, Mat3::Identity(), gamma, zeta);
  const TriangleMesh sphere = icosphere(2);
  RegistrationOptions options = quick();
  options.rounds = 4;
  options.clock_settled = 0.05;
  const MovingRegistration r = register_moving(moved, body, sphere, options);
  double square = 0;
  const Mat3X a = gamma(sphere.vertices), b = r.spatial.gamma(sphere.vertices);
  for (Index i = 0; i < a.cols(); ++i) square += std::pow(angle_between(a.col(i), b.col(i)), 2) / double(a.cols());
  INFO("sphere missed by " << std::sqrt(square) * 180 / pi << " degrees, time by " << distance(r.temporal.warp, zeta));
  CHECK(std::sqrt(square) * 180 / pi < 0.5);
  CHECK(distance(r.temporal.warp, zeta) < 1e-2);
  CHECK(distance(r.temporal.warp, zeta) < 0.2 * distance({}, zeta));
  CHECK(r.spatial.summary.min_jacobian > 0);
  CHECK(r.rounds == 2);  // the second moves the clock by less than is asked for
  CHECK(r.clock_moved > 0);
  CHECK(r.clock_moved < options.clock_settled);
}

TEST_CASE("law: the ends of a geodesic are the moving bodies, to what the components leave", "[law][stats]") {
  const LimbedBody a = some_body(0.9, 0), b = some_body(1.1, 0.3);
  const TriangleMesh sphere = icosphere(2);
  RegistrationOptions options = quick();
  options.pca.residual = GENERATE(1e-5, 1e-7);
  const std::vector<SurfaceSamples> samples{sample(a, {}, sphere.vertices, options),
                                            sample(b, {}, sphere.vertices, options)};
  const FunctionalPca pca = joint_pca(samples, sphere, options);
  const TimeWarp warp = random_time_warp(3, 0.6, 1.5);
  const CurveGeodesic way(shape_curve(samples[0], pca), shape_curve(samples[1], pca), warp);
  const auto check = [&](const LimbedBody& body, double tau, const TimeWarp& zeta) {
    double msd = 0;
    for (int k = 0; k < 12; ++k) {
      const double t = k / 11.0;
      const Mat3X x = pca.reconstruct(interpolate(way.points(tau), t)), y = positions(body, sphere.vertices, zeta(t));
      msd += (x - y).squaredNorm() / double(x.size()) / 12;
    }
    INFO("residual " << pca.residual() << ", of the end at " << tau << ": " << msd);
    CHECK(msd < 4 * options.pca.residual);  // of the vertices, which do not have the areas' weights
  };
  check(a, 0, {});
  check(b, 1, warp);
}

TEST_CASE("the mean of two sizes of a body has the size between", "[stats]") {
  const std::vector<AnyAnimatedSurface> bodies{AnyAnimatedSurface(some_body(0.9, 0.3)),
                                               AnyAnimatedSurface(some_body(1.1, -0.3))};
  MovingMeanOptions options;
  options.registration = quick();
  options.karcher.temporal = options.registration.temporal;
  options.karcher.iterations = 3;
  const TriangleMesh sphere = icosphere(2);
  const MovingMean m = mean_of_moving(bodies, sphere, options);
  const std::vector<Mat3X> frames = m.frames(5);
  REQUIRE(frames.size() == 5);
  const auto& energy = m.curves.summary.energy;
  for (std::size_t k = 1; k < energy.size(); ++k) CHECK(energy[k] <= energy[k - 1]);
  CHECK(energy.back() < energy.front());
  const LimbedBody middle = some_body(1, 0);
  const double wanted = area({positions(middle, sphere.vertices, 0), sphere.faces});
  CHECK(area({frames.front(), sphere.faces}) == Approx(wanted).epsilon(0.02));
}

TEST_CASE("samples, components and curves fit together", "[stats]") {
  const LimbedBody body = some_body(1, 0.2);
  const TriangleMesh sphere = icosphere(2);
  RegistrationOptions options = quick();
  options.pca = {1e-12, 80};
  const SurfaceSamples s = sample(body, {}, sphere.vertices, options);
  const FunctionalPca pca = joint_pca({s}, sphere, options);
  const Curve curve = shape_curve(s, pca);
  const TimeGrid grid = time_grid();
  const Eigen::MatrixXd points = integrate_srvf(curve.start(), warped_srvf(curve, {}, grid), grid);
  CHECK((pca.reconstruct(points.rightCols<1>()) - positions(body, sphere.vertices, 1)).cwiseAbs().maxCoeff() < 1e-4);
  CHECK((pca.reconstruct(interpolate(points, 0.5)) - positions(body, sphere.vertices, 0.5)).cwiseAbs().maxCoeff() <
        1e-4);
}

TEST_CASE("a mean of nothing is refused", "[stats]") {
  CHECK_THROWS_AS(mean_of_moving(std::vector<AnyAnimatedSurface>{}, icosphere(0)), InvalidArgument);
  MovingMeanOptions options;
  options.registration = quick();
  CHECK_THROWS_AS(mean_of_moving(std::vector{AnyAnimatedSurface(some_body(1, 0))}, icosphere(2), options).frames(1),
                  InvalidArgument);
}

}  // namespace moving_mean_test
