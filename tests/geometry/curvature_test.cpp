#include "catch.hpp"
#include "support/sphere_points.hpp"

#include <dsns/geometry/curvature.hpp>
#include <dsns/nn/fit.hpp>
#include <dsns/surface/analytic.hpp>

namespace curvature_test {

using namespace dsns;

namespace {

/// A resting surface as a moving one, for the fit.
struct Resting {
  Ellipsoid shape;
  template <class T>
  Vec3<T> operator()(const Vec3<T>& s, const T&) const {
    return shape(s);
  }
};

double relative_rms_error(const Eigen::VectorXd& value, const Eigen::VectorXd& exact) {
  return (value - exact).norm() / exact.norm();
}

}  // namespace

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

TEST_CASE("normals point outward and a crushed surface is refused", "[geometry]") {
  const ChartBatch c = charts_at(test::sphere_points());
  const Mat3X n = unit_normals(jets(Ellipsoid{2, 3, 4}, c));
  CHECK((n.array() * c.s.array()).colwise().sum().minCoeff() > 0);
  CHECK_THROWS_AS(unit_normals(jets(Ellipsoid{0, 0, 1}, c)), DegenerateSurface);
}

TEST_CASE("the curvature of a fitted network approaches the ellipsoid's as the fit goes on", "[geometry]") {
  const Resting body{{1, 1.3, 0.8}};
  const Mat3X s = test::sphere_points(100);
  Eigen::VectorXd exact(s.cols());
  for (Index i = 0; i < s.cols(); ++i) exact[i] = gaussian_curvature(body.shape, s.col(i));
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
    const FitResult fit = fit_neural_surface(body, options);
    errors.push_back(relative_rms_error(curvature(at_time(fit.surface, 0.5), s).gaussian, exact));
  }
  INFO("relative errors " << errors[0] << ", " << errors[1] << ", " << errors[2]);
  CHECK(errors[1] < 0.7 * errors[0]);
  CHECK(errors[2] < 0.7 * errors[1]);
  CHECK(errors[2] < 0.1);
}

}  // namespace curvature_test
