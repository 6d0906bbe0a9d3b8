#pragma once
/// Rotations: exponential and logarithm, nearest rotation, finite sets for searches.
#include <dsns/core/types.hpp>

#include <Eigen/SVD>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

namespace dsns {

/// Rotation about w by |w| radians (Rodrigues).
inline Mat3 rotation_exp(const Vec3d& w) {
  const double angle = w.norm();
  return angle == 0 ? Mat3::Identity() : Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
}

/// Axis times angle in [0, pi] of a rotation matrix: the inverse of rotation_exp.
inline Vec3d rotation_log(const Mat3& rotation) {
  const Eigen::AngleAxisd turn(rotation);
  return turn.angle() * turn.axis();
}

/// Angle of a rotation, radians in [0, pi].
inline double rotation_angle(const Mat3& rotation) { return rotation_log(rotation).norm(); }

/// The rotation O that maximises trace(O^T M): for M = sum w a b^T it minimises sum w |a - O b|^2 (Kabsch 1976).
inline Mat3 nearest_rotation(const Mat3& m) {
  const Eigen::JacobiSVD<Mat3> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Vec3d signs = Vec3d::Ones();
  signs.z() = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  return svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
}

/// Rotation drawn uniformly from SO(3) (Shoemake 1992).
inline Mat3 random_rotation(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  Eigen::Quaterniond q;
  do {
    q = Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random));
  } while (q.norm() < 1e-6);
  return q.normalized().toRotationMatrix();
}

/// n rotations that fill SO(3) evenly (super-Fibonacci spirals), always the same ones; the identity comes first.
/// source   Alexa, CVPR 2022
inline std::vector<Mat3> rotation_grid(int n) {
  constexpr double phi = 1.4142135623730951, psi = 1.533751168755204288118041;
  std::vector<Mat3> grid{Mat3::Identity()};
  for (int i = 0; i + 1 < n; ++i) {
    const double s = i + 0.5, t = s / (n - 1), d = 2 * pi * s;
    const double r = std::sqrt(t), big = std::sqrt(1 - t), alpha = d / phi, beta = d / psi;
    const Eigen::Quaterniond q(r * std::sin(alpha), r * std::cos(alpha), big * std::sin(beta), big * std::cos(beta));
    grid.push_back(q.normalized().toRotationMatrix());
  }
  return grid;
}

}  // namespace dsns
