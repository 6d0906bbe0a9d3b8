#pragma once
/// Where to start matching two bodies: smooth maps of the sphere under which their descriptors agree.
#include <dsns/matching/matching_body.hpp>
#include <dsns/matching/scalar_registration.hpp>

#include <algorithm>

namespace dsns {

struct DescriptorStartOptions {
  int degree = 8;           ///< of the harmonics that smooth the descriptors
  double smoothing = 0.01;  ///< heat time on the unit sphere
  int rotations = 600;      ///< scored
  int refined = 10;         ///< of these, by Gauss-Newton
  int kept = 6;             ///< of these
  double apart = 35;        ///< least angle between refined rotations, degrees
  double same = 10;         ///< refined starts nearer to each other than this, degrees rms, are one
  ScalarRegistrationOptions registration;
};

/// Harmonic coefficients of functions of the vertices, a column each, by least squares weighted with the body's masses,
/// damped by exp(-smoothing l(l + 1)).
inline Eigen::MatrixXd smoothed_on_sphere(const MatchingBody& body, const Eigen::MatrixXd& functions, int degree,
                                          double smoothing) {
  const Eigen::MatrixXd y = harmonics(body.sphere(), degree);
  const Eigen::ArrayXd l = harmonic_degrees(degree), square = l * (l + 1);
  const Eigen::MatrixXd weighted = body.masses().asDiagonal() * y;
  Eigen::MatrixXd normal = weighted.transpose() * y;
  normal.diagonal().array() += 1e-8 * square.square() + 1e-12 * normal.trace();
  return (-smoothing * square).exp().matrix().asDiagonal() * normal.ldlt().solve(weighted.transpose() * functions);
}

/// Starts by rising energy: rotations scored on the smoothed descriptors, the best that lie apart refined by smooth fields.
/// functions  descriptors at the vertices of each body, columns correspond
inline std::vector<ScalarRegistration> descriptor_starts(const MatchingBody& first, const Eigen::MatrixXd& functions1,
                                                         const MatchingBody& second, const Eigen::MatrixXd& functions2,
                                                         const DescriptorStartOptions& options = {}) {
  require(options.rotations >= 1 && options.refined >= 1 && options.kept >= 1,
          "descriptor_starts: give at least one rotation, refined and kept");
  const Eigen::MatrixXd c1 = smoothed_on_sphere(first, functions1, options.degree, options.smoothing),
                        c2 = smoothed_on_sphere(second, functions2, options.degree, options.smoothing);
  const Mat3X s = fibonacci_sphere(250).points;
  const Eigen::MatrixXd target = harmonics(s, options.degree) * c1;
  struct Scored {
    Mat3 rotation;
    double energy;
  };
  std::vector<Scored> scored;
  Eigen::MatrixXd y;
  for (const Mat3& R : rotation_grid(options.rotations)) {
    y = harmonics((R * s).colwise().normalized(), options.degree, std::move(y));
    scored.push_back({R, (target - y * c2).squaredNorm()});
  }
  std::stable_sort(scored.begin(), scored.end(), [](const auto& a, const auto& b) { return a.energy < b.energy; });

  std::vector<Mat3> chosen;
  for (const Scored& candidate : scored) {
    if (static_cast<int>(chosen.size()) == options.refined) break;
    if (std::all_of(chosen.begin(), chosen.end(), [&](const Mat3& other) {
          return rotation_angle(candidate.rotation.transpose() * other) >= options.apart * pi / 180;
        }))
      chosen.push_back(candidate.rotation);
  }
  const detail::ScalarProblem problem(c1, c2, options.registration);
  std::vector<ScalarRegistration> starts;
  for (const Mat3& R : chosen) starts.push_back(problem.minimise(R));
  std::stable_sort(starts.begin(), starts.end(), [](const auto& a, const auto& b) { return a.energy < b.energy; });

  std::vector<ScalarRegistration> kept;
  std::vector<Mat3X> images;
  for (ScalarRegistration& start : starts) {
    if (static_cast<int>(kept.size()) == options.kept) break;
    Mat3X image = start.gamma(s);
    const double same = std::pow(2 * std::sin(0.5 * options.same * pi / 180), 2);  // chords
    if (std::any_of(images.begin(), images.end(),
                    [&](const Mat3X& other) { return (image - other).colwise().squaredNorm().mean() < same; }))
      continue;
    images.push_back(std::move(image));
    kept.push_back(std::move(start));
  }
  return kept;
}

}  // namespace dsns
