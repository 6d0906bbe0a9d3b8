#include "catch.hpp"
#include "support/sphere_warps.hpp"

#include <dsns/elastic/spatial_refinement.hpp>
#include <dsns/surface/analytic.hpp>

namespace spatial_refinement_test {

using namespace dsns;

namespace {

LimbedBody moving_body() {
  LimbedBody body;
  body.axes = {1, 0.8, 0.6};
  body.limbs = {{Vec3d(1, 0.3, 0.2).normalized(), 6, Vec3d(0.7, 0.2, 0.1), Vec3d(0, 0.3, 0.1)},
                {Vec3d(-1, 0.5, 0.4).normalized(), 5, Vec3d(-0.5, 0.3, 0.3), Vec3d(0.1, 0.2, 0)},
                {Vec3d(0, -1, 0.4).normalized(), 6, Vec3d(0, -0.6, 0.3), Vec3d(0.2, 0, 0.1)}};
  return body;
}

struct Still {
  double operator()(double t) const { return t; }
};
using Stack = MovingStack<LimbedBody, Still>;

}  // namespace

TEST_CASE("the slope of the energy along a field is that of its finite differences", "[elastic]") {
  const LimbedBody body = moving_body();
  LimbedBody other = body;
  other.axes = {0.9, 0.9, 0.7};
  const Still clock;
  const Stack first{body, clock, 2}, second{other, clock, 2};
  SpatialOptions options;
  options.latitudes = 10;
  const double weight = GENERATE(0.0, 0.3, 1.0), smoothing = GENERATE(0.0, 0.02);
  const detail::RefinementProblem problem(first, second, {3, 6, smoothing, weight}, options);
  const SphereDisplacement begin =
      test::turned_warp(3, 3, 6, Vec3d(0.2, -0.1, 0.3)).displacement(charts_at(problem.points()));
  const Mat3 O = rotation_exp(Vec3d(0.3, 0.1, -0.2));
  const detail::RefinementState p = problem.at(begin.y, begin.J, O);
  const detail::NormalEquations system = problem.linearise(p, charts_at(p.y), 3);
  const Index count = harmonic_count(3) - 1;
  for (const Index k : {Index(0), Index(5), count + 2, 2 * count, 2 * count + 2}) {
    const auto energy = [&](double step) {
      SphereVectorField v = SphereVectorField::zero(3);
      Vec3d turn = Vec3d::Zero();
      if (k < count)
        v.a[1 + k] = step;
      else if (k < 2 * count)
        v.b[1 + k - count] = step;
      else
        turn[k - 2 * count] = step;
      return problem.at(displace(v, charts_at(p.y)).y, p.J, O * rotation_exp(turn)).energy;
    };
    const double h = 1e-5, slope = (energy(h) - energy(-h)) / (2 * h);
    INFO("unknown " << k << ", positions " << weight << ", smoothing " << smoothing);
    CHECK(-2 * system.right[k] == Approx(slope).epsilon(1e-5));
  }
}

TEST_CASE("the truth has no energy, whatever the projection takes away", "[elastic]") {
  const LimbedBody body = moving_body();
  const Still clock;
  const SphereDiffeomorphism gamma = test::turned_warp(5, 3, 12, Vec3d(1, 0.4, -0.2));
  struct Warped {
    const Stack& stack;
    const SphereDiffeomorphism& gamma;
    std::vector<Mat3X> positions(const Mat3X& s) const { return stack.positions(gamma(s)); }
    std::vector<SurfaceTangents> tangents(const ChartBatch& charts) const { return stack.tangents(charts); }
  };
  const Stack second{body, clock, 2};
  const Warped first{second, gamma};
  SpatialOptions options;
  options.latitudes = 10;
  const detail::RefinementProblem problem(first, second, {3, 5, 0, 0.5}, options);
  const SphereDisplacement truth = gamma.displacement(charts_at(problem.points()));
  CHECK(problem.at(truth.y, truth.J, Mat3::Identity()).energy < 1e-20);
  CHECK(problem.at(problem.points(), truth.J, Mat3::Identity()).energy > 0.1);
}

TEST_CASE("a refinement of surfaces at other times than the first's is refused", "[elastic]") {
  const LimbedBody body = moving_body();
  const Still clock;
  const Stack first{body, clock, 2}, second{body, clock, 3};
  const detail::RefinementProblem problem(first, second, {3, 5, 0, 0.5}, {});
  CHECK_THROWS_AS(problem.at(problem.points(), Eigen::VectorXd::Ones(problem.points().cols()), Mat3::Identity()),
                  InvalidArgument);
}

}  // namespace spatial_refinement_test
