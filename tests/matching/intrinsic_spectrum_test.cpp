#include "catch.hpp"
#include "support/bodies.hpp"

#include <dsns/geometry/spectrum.hpp>
#include <dsns/matching/intrinsic_spectrum.hpp>
#include <dsns/surface/analytic.hpp>

namespace intrinsic_spectrum_test {

using namespace dsns;

TEST_CASE("eigenvalues of a triangulated sphere are l(l + 1), 2 l + 1 of each", "[matching]") {
  std::array<double, 2> worst{};
  for (const int level : {3, 4}) {
    const IntrinsicSpectrum spectrum = intrinsic_spectrum(matching_body(Sphere{}, level), 24);  // in units of area 1
    Index k = 0;
    for (int l = 1; l <= 4; ++l)
      for (int m = -l; m <= l; ++m, ++k) {
        const double error = std::abs(spectrum.eigenvalues[k] / (4 * pi * l * (l + 1)) - 1);
        worst[std::size_t(level - 3)] = std::max(worst[std::size_t(level - 3)], error);
      }
  }
  INFO("off by " << worst[0] << " and on a finer mesh by " << worst[1]);
  CHECK(worst[1] < 8e-3);
  CHECK(worst[1] < 0.3 * worst[0]);  // of second order in the edges
}

TEST_CASE("mesh and Galerkin spectra of an ellipsoid agree", "[matching]") {
  const Ellipsoid shape{1, 0.7, 1.6};
  const LaplaceBeltramiSpectrum galerkin = laplace_beltrami_spectrum(shape, {.degree = 14});
  const MatchingBody body = matching_body(shape, 4);
  const IntrinsicSpectrum spectrum = intrinsic_spectrum(body, 20);
  const Eigen::MatrixXd exact = galerkin.values(body.sphere()) * std::sqrt(galerkin.summary.area);
  for (Index k = 0; k < 20; ++k) {
    const double lambda = galerkin.eigenvalues[k + 1] * galerkin.summary.area;
    INFO("number " << k << ": " << spectrum.eigenvalues[k] << " and " << lambda);
    CHECK(spectrum.eigenvalues[k] == Approx(lambda).epsilon(1e-2));
    if (k < 6) {  // no two of them are close
      const Eigen::VectorXd product = spectrum.eigenfunctions.col(k).cwiseProduct(exact.col(k + 1));
      CHECK(std::abs(product.dot(body.masses())) == Approx(1).epsilon(2e-3));
    }
  }
  const Eigen::MatrixXd gram =
      spectrum.eigenfunctions.transpose() * intrinsic_laplacian(body).masses.asDiagonal() * spectrum.eigenfunctions;
  CHECK((gram - Eigen::MatrixXd::Identity(20, 20)).norm() < 1e-7);
}

TEST_CASE("needles do not spoil the spectrum", "[matching]") {
  const TriangleMesh sphere = latitude_longitude_sphere(24, 96);
  const MatchingBody body(test::still(sphere), sphere.vertices);
  const IntrinsicSpectrum spectrum = intrinsic_spectrum(body, 8);
  for (Index k = 0; k < 3; ++k) CHECK(spectrum.eigenvalues[k] / (4 * pi) == Approx(2).epsilon(0.01));
  for (Index k = 3; k < 8; ++k) CHECK(spectrum.eigenvalues[k] / (4 * pi) == Approx(6).epsilon(0.015));
}

TEST_CASE("spectra of counts that a mesh does not have are refused", "[matching]") {
  const MatchingBody body = matching_body(Sphere{}, 1);
  CHECK_THROWS_AS(intrinsic_spectrum(body, 0), InvalidArgument);
  CHECK_THROWS_AS(intrinsic_spectrum(body, 41), InvalidArgument);
  CHECK(intrinsic_spectrum(body, 40).size() == 40);
}

}  // namespace intrinsic_spectrum_test
