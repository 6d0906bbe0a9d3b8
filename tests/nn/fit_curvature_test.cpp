#include "catch.hpp"
#include "support/sphere_points.hpp"

#include <dsns/geometry/curvature.hpp>
#include <dsns/nn/fit.hpp>
#include <dsns/surface/analytic.hpp>
#include <dsns/surface/motion.hpp>

namespace fit_curvature_test {

using namespace dsns;

namespace {

double relative_rms_error(const Eigen::VectorXd& value, const Eigen::VectorXd& exact) {
  return (value - exact).norm() / exact.norm();
}

}  // namespace

TEST_CASE("the curvature of a fitted network approaches the ellipsoid's as the fit goes on", "[geometry]") {
  const Ellipsoid shape{1, 1.3, 0.8};
  const Mat3X s = test::sphere_points(100);
  Eigen::VectorXd exact(s.cols());
  for (Index i = 0; i < s.cols(); ++i) exact[i] = gaussian_curvature(shape, s.col(i));
  std::vector<double> errors;
  for (const int steps : {30, 300, 1500}) {
    FitOptions options;
    options.width = 32;
    options.points = 2000;
    options.times = 8;
    options.encoding.harmonic_degree = 4;  // high harmonics would learn positions first and curvature late
    options.encoding.harmonic_decay = 2;
    options.encoding.time_frequencies = 2;
    options.batch = 256;
    options.steps = steps;
    const FitResult fit = fit_neural_surface(resting(shape), options);
    errors.push_back(relative_rms_error(curvature(at_time(fit.surface, 0.5), s).gaussian, exact));
  }
  INFO("relative errors " << errors[0] << ", " << errors[1] << ", " << errors[2]);
  CHECK(errors[1] < 0.7 * errors[0]);
  CHECK(errors[2] < 0.7 * errors[1]);
  CHECK(errors[2] < 0.1);
}

}  // namespace fit_curvature_test
