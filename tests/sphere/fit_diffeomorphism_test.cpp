#include <dsns/mesh/piecewise_linear_diffeomorphism.hpp>
#include <dsns/sphere/fit_diffeomorphism.hpp>

#include "catch.hpp"
#include "support/sphere_points.hpp"
#include "support/sphere_warps.hpp"

namespace fit_diffeomorphism_test {

using namespace dsns;

namespace {

constexpr double degree = pi / 180;
const DiffeomorphismFitOptions quick{.degrees = {1, 2, 4, 8, 8, 10}};

}  // namespace

TEST_CASE("fit of a diffeomorphism: a rotation is found at once", "[sphere]") {
  const SphereDiffeomorphism turn(rotation_exp(Vec3d(2, -1, 0.4)));
  const DiffeomorphismFit fit = smoothed(turn, quick);
  CHECK((fit.gamma.rotation() - turn.rotation()).norm() < 1e-12);
  CHECK(fit.error.largest < 1e-7);
  CHECK(fit.min_jacobian == Approx(1).epsilon(1e-6));
}

TEST_CASE("fit of a diffeomorphism: a known warp is found again", "[sphere]") {
  const SphereDiffeomorphism truth = test::turned_warp(3, 4, 10, Vec3d(0.4, -1, 0.3));
  const DiffeomorphismFit fit = smoothed(truth, quick);
  const AngularDistance error = angular_distance(fit.gamma, truth, fibonacci_sphere(2000));
  CHECK(error.rms < 0.01 * degree);
  CHECK(error.largest < 0.05 * degree);
  CHECK(fit.error.rms == Approx(error.rms).epsilon(0.2));
  CHECK(fit.min_jacobian == Approx(certify(truth).min_jacobian).epsilon(0.02));
  CHECK(fit.rms.back() == fit.error.rms);
  CHECK(std::is_sorted(fit.rms.rbegin(), fit.rms.rend()));
  CHECK(fit.gamma.increments().size() + 1 == fit.rms.size());
}

TEST_CASE("fit of a diffeomorphism: a piecewise-linear map becomes one with continuous derivatives", "[sphere]") {
  const SphereDiffeomorphism truth = test::turned_warp(3, 4, 10, Vec3d(0.4, -1, 0.3));
  const PiecewiseLinearDiffeomorphism rough = piecewise_linear(truth, icosphere(3)).map;
  const DiffeomorphismFit fit = smoothed(rough, quick);
  CHECK(certify(fit.gamma).holds());
  // the samples are the truth's: what is linear between them lies above degree 10, and the fit does not see it
  const SphereQuadrature q = fibonacci_sphere(2000);
  CHECK(angular_distance(fit.gamma, truth, q).rms < angular_distance(rough, truth, q).rms);
  const ChartBatch charts = charts_at(q.points);
  const double of_fit = (fit.gamma.displacement(charts).J - truth.displacement(charts).J).cwiseAbs().maxCoeff();
  const double of_rough = (rough.displacement(charts).J - truth.displacement(charts).J).cwiseAbs().maxCoeff();
  CHECK(of_fit < 0.3 * of_rough);
}

TEST_CASE("fit of a diffeomorphism: weights say which pairs count", "[sphere]") {
  const SphereDiffeomorphism truth = test::turned_warp(6, 3, 6, Vec3d(0.1, 0.2, 0.3));
  const SphereQuadrature q = fibonacci_sphere(600);
  Mat3X y = truth(q.points);
  Eigen::VectorXd weights = q.weights;
  for (Index i = 0; i < y.cols(); i += 10) {
    y.col(i) = -y.col(i);
    weights[i] = 0;
  }
  CHECK(angular_distance(fit_diffeomorphism(q.points, y, weights, quick).gamma, truth, q).rms < 0.1 * degree);
}

TEST_CASE("fit of a diffeomorphism: pairs that no diffeomorphism has give one all the same", "[sphere]") {
  const Mat3X s = fibonacci_sphere(400).points;
  const Mat3X mirrored = s.rowwise().reverse(), to_one_point = Vec3d::UnitX().replicate(1, s.cols());
  for (const Mat3X& y : {mirrored, to_one_point}) {
    const DiffeomorphismFit fit = fit_diffeomorphism(s, y, Eigen::VectorXd::Ones(400), quick);
    CHECK(fit.min_jacobian > 0);
    CHECK(certify(fit.gamma).holds());
  }
}

TEST_CASE("fit of a diffeomorphism: misfitting input is refused", "[sphere]") {
  const Mat3X s = test::sphere_points();
  const Index n = s.cols();
  CHECK_THROWS_AS(fit_diffeomorphism(s, s.leftCols(3), Eigen::VectorXd::Ones(n)), InvalidArgument);
  CHECK_THROWS_AS(fit_diffeomorphism(s, s, Eigen::VectorXd::Zero(n)), InvalidArgument);
  CHECK_THROWS_AS(fit_diffeomorphism(s, s, -Eigen::VectorXd::Ones(n)), InvalidArgument);
  CHECK_THROWS_AS(fit_diffeomorphism(s, 2 * s, Eigen::VectorXd::Ones(n)), InvalidArgument);
  CHECK_THROWS_AS(fit_diffeomorphism(Mat3X(3, 0), Mat3X(3, 0), Eigen::VectorXd()), InvalidArgument);
}

}  // namespace fit_diffeomorphism_test
