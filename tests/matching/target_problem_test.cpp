#include <dsns/matching/target_problem.hpp>

#include "catch.hpp"
#include "support/bodies.hpp"
#include "support/sphere_warps.hpp"

namespace target_problem_test {

using namespace dsns;

namespace {

/// The energy as its definition says, face by face and point by point, weights of the observations as they are at `from`.
double by_definition(const detail::TargetProblem& problem, const detail::Observations& o, double elastic,
                     const detail::JacobianBarrier& barrier, const Mat3X& from, const Mat3X& y) {
  const auto& ico = problem.ico();
  const auto hits = problem.locate(o.points);
  const Mat3X before = problem.interpolate(from, hits), now = problem.interpolate(y, hits);
  double sum = elastic * (y * ico.energy()).cwiseProduct(y).sum();
  for (Index i = 0; i < o.points.cols(); ++i) {
    const double r2 = o.robust * o.robust, d2 = (before.col(i) - o.targets.col(i)).squaredNorm();
    const double trust = std::isinf(r2) ? 1 : r2 / (r2 + d2);
    sum += o.weights[i] * trust * trust * (now.col(i) - o.targets.col(i)).squaredNorm();
  }
  for (Index f = 0; f < ico.faces().cols(); ++f) sum += ico.face_masses()[f] * barrier(ico.jacobian(y, f));
  for (Index i = 0; i < y.cols(); ++i) sum += 1e-8 * ico.masses()[i] * (y.col(i) - from.col(i)).squaredNorm();
  return sum;
}

detail::Observations random_observations(double robust) {
  return {test::random_unit_vectors(300, 1), test::random_unit_vectors(300, 2),
          Eigen::VectorXd::Constant(300, 1.0 / 300), robust};
}

double least(const detail::TargetProblem& problem, const Mat3X& y) {
  double J = std::numeric_limits<double>::infinity();
  for (Index f = 0; f < problem.ico().faces().cols(); ++f) J = std::min(J, problem.ico().jacobian(y, f));
  return J;
}

}  // namespace

TEST_CASE("target problem: the energy is its definition", "[matching]") {
  const detail::JacobianBarrier barrier{0.9, 0.1};
  detail::TargetProblem problem(2, barrier);
  const Mat3X from = problem.ico().vertices(), y = test::turned_warp(3, 4, 8, Vec3d(0.1, 0, 0.2))(from);
  for (const double robust : {0.5, std::numeric_limits<double>::infinity()}) {
    const detail::Observations o = random_observations(robust);
    problem.begin(from, 1e-4);
    problem.observe(from, o, problem.locate(o.points));
    for (const Mat3X& z : {from, y})
      CHECK(problem.energy(z) == Approx(by_definition(problem, o, 1e-4, barrier, from, z)).epsilon(1e-12));
  }
}

TEST_CASE("target problem: without obstacles the global step solves the linear system", "[matching]") {
  detail::TargetProblem problem(2, {});
  const Mat3X from = problem.ico().vertices(), goal = test::turned_warp(3, 4, 4, Vec3d(0.1, 0, 0.1))(from);
  const detail::Observations o{from, goal, problem.ico().masses()};
  problem.begin(from, 1e-7);
  problem.observe(from, o, problem.locate(from));
  CHECK((problem.global_step(from) - goal).colwise().norm().maxCoeff() < 2e-3);
}

TEST_CASE("target problem: steps keep every face upright, settling lowers the energy", "[matching]") {
  detail::TargetProblem problem(3, {});
  const detail::Observations o = random_observations(0.5);
  Mat3X y = problem.ico().vertices();
  for (int step = 0; step < 5; ++step) {
    problem.begin(y, 1e-6);
    problem.observe(y, o, problem.locate(o.points));
    y = problem.global_step(y);
    CHECK(least(problem, y) > 0);
    double energy = problem.energy(y);
    for (int sweep = 0; sweep < 4; ++sweep) {
      problem.settle(y, 1);
      CHECK(problem.energy(y) <= energy * (1 + 1e-12));
      energy = problem.energy(y);
    }
    CHECK(least(problem, y) > 0);
    CHECK((y.colwise().norm().array() - 1).abs().maxCoeff() < 1e-12);
  }
}

TEST_CASE("target problem: settled vertices are where no small move lowers the energy", "[matching]") {
  detail::TargetProblem problem(1, {0.9, 1});
  const detail::Observations o = random_observations(0.5);
  Mat3X y = problem.ico().vertices();
  problem.begin(y, 1e-3);
  problem.observe(y, o, problem.locate(o.points));
  problem.settle(y, 150);
  const double energy = problem.energy(y);
  test::Uniform uniform(3);
  for (Index i = 0; i < y.cols(); ++i) {
    Mat3X moved = y;
    moved.col(i) = (moved.col(i) + 1e-3 * uniform.unit_vector()).normalized();
    CHECK(problem.energy(moved) > energy);
  }
}

}  // namespace target_problem_test
