#include "catch.hpp"
#include "support/bodies.hpp"

#include <dsns/matching/descriptor_starts.hpp>

namespace scalar_registration_test {

using namespace dsns;

namespace {

Eigen::MatrixXd some_channels(int degree, int channels) {
  test::Uniform uniform(11);
  Eigen::MatrixXd c(harmonic_count(degree), channels);
  for (double& value : c.reshaped()) value = uniform(-1, 1);
  return c;
}

double rms_deg(const Mat3X& a, const Mat3X& b) {
  double sum = 0;
  for (Index i = 0; i < a.cols(); ++i) sum += std::pow(angle_between(a.col(i), b.col(i)), 2);
  return std::sqrt(sum / double(a.cols())) * 180 / pi;
}

SphereDiffeomorphism turned_warp(double degrees) {
  SphereDiffeomorphism gamma(rotation_exp(Vec3d(0.3, -2, 1)));
  const SphereDiffeomorphism warp = random_diffeomorphism(4, 3, degrees * pi / 180);
  for (const auto& v : warp.increments()) gamma.append(v);
  return gamma;
}

/// Coefficients of the channels f o gamma.
Eigen::MatrixXd pulled_back(const Eigen::MatrixXd& channels, const SphereDiffeomorphism& gamma, int degree) {
  const SphereQuadrature q = sphere_quadrature(24);
  const Eigen::MatrixXd values = harmonics(gamma(q.points), harmonic_degree(channels.rows())) * channels;
  return harmonics(q.points, degree).transpose() * (q.weights.asDiagonal() * values);
}

}  // namespace

TEST_CASE("a known warp between scalar functions is recovered", "[matching]") {
  const Eigen::MatrixXd second = some_channels(4, 6);
  const SphereDiffeomorphism gamma = turned_warp(8);
  const Eigen::MatrixXd first = pulled_back(second, gamma, 12);
  ScalarRegistrationOptions options;
  options.damping = 1e-6;
  options.latitudes = 16;
  options.field_degrees = {1, 2, 3, 4, 6};
  const Mat3 near = rotation_exp(Vec3d(0.1, 0.05, -0.1)) * gamma.rotation();
  const ScalarRegistration r = register_scalars(first, second, near, options);
  const Mat3X s = fibonacci_sphere(300).points;
  INFO("missed by " << rms_deg(r.gamma(s), gamma(s)) << " degrees, energy " << r.energy);
  CHECK(rms_deg(SphereDiffeomorphism(near)(s), gamma(s)) > 8);
  CHECK(rms_deg(r.gamma(s), gamma(s)) < 0.1);
  CHECK(certify(r.gamma).holds());

  // The energy is what its name says.
  const SphereQuadrature q = sphere_quadrature(30);
  const Eigen::MatrixXd miss = harmonics(q.points, 12) * first - harmonics(near * q.points, 4) * second;
  options.field_degrees = {};
  CHECK(register_scalars(first, second, near, options).energy ==
        Approx(q.weights.dot(miss.rowwise().squaredNorm()) / (4 * pi * 6)).epsilon(1e-6));
}

TEST_CASE("functions of the vertices are smoothed on the sphere", "[matching]") {
  const MatchingBody body = matching_body([](const auto& s) { return s; }, 3);
  const Eigen::MatrixXd exact = some_channels(4, 2);
  const Eigen::MatrixXd values = harmonics(body.sphere(), 4) * exact;
  const Eigen::MatrixXd c = smoothed_on_sphere(body, values, 5, 0.02);
  const Eigen::ArrayXd l = harmonic_degrees(5), decay = (-0.02 * l * (l + 1)).exp();
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(36, 2);
  expected.topRows(25) = exact;
  CHECK((c - decay.matrix().asDiagonal() * expected).cwiseAbs().maxCoeff() < 1e-4);
}

TEST_CASE("starts contain the map that carries the descriptors over", "[matching]") {
  const Eigen::MatrixXd second = some_channels(4, 6);
  const SphereDiffeomorphism gamma = turned_warp(4);
  const MatchingBody body = matching_body([](const auto& s) { return s; }, 3);
  DescriptorStartOptions options;
  options.smoothing = 0;
  options.degree = 6;
  options.refined = 4;
  options.kept = 3;
  options.same = 0;
  options.registration.damping = 1e-6;
  const std::vector<ScalarRegistration> starts = descriptor_starts(body, harmonics(gamma(body.sphere()), 4) * second,
                                                                   body, harmonics(body.sphere(), 4) * second, options);
  REQUIRE(starts.size() == 3);
  CHECK(starts[0].energy <= starts[1].energy);
  CHECK(starts[1].energy <= starts[2].energy);
  const Mat3X s = fibonacci_sphere(200).points;
  INFO("missed by " << rms_deg(starts[0].gamma(s), gamma(s)) << " degrees");
  CHECK(rms_deg(starts[0].gamma(s), gamma(s)) < 0.5);
  CHECK(rotation_angle(starts[0].gamma.rotation().transpose() * starts[1].gamma.rotation()) > 34 * pi / 180);

  // All that lead to one map are one.
  options.same = 10;
  options.refined = 12;
  options.kept = 12;
  const auto apart = descriptor_starts(body, harmonics(gamma(body.sphere()), 4) * second, body,
                                       harmonics(body.sphere(), 4) * second, options);
  for (std::size_t i = 0; i < apart.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) CHECK(rms_deg(apart[i].gamma(s), apart[k].gamma(s)) > 9.5);
}

}  // namespace scalar_registration_test
