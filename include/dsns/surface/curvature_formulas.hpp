#pragma once
/// Curvatures of surfaces that are given otherwise than by a chart: the closed forms of analytic surfaces.
#include <dsns/core/types.hpp>

#include <cmath>

namespace dsns {

/// K (length^-2) and H (length^-1) at one point; a sphere of radius r has H = 1/r.
struct PointCurvature {
  double gaussian = 0, mean = 0;
};

/// Of the level set of F through a point, from the gradient (not zero, outward) and the Hessian of F in any orthonormal frame:
///   K = g . adj(A) g / |g|^4,   H = (|g|^2 tr A - g . A g) / (2 |g|^3).
/// source   Goldman 2005, Curvature formulas for implicit curves and surfaces
inline PointCurvature level_set_curvature(const Vec3d& gradient, const Mat3& hessian) {
  const Vec3d a = hessian.col(0), b = hessian.col(1), c = hessian.col(2);
  Mat3 adjugate;
  adjugate << b.cross(c), c.cross(a), a.cross(b);
  const double square = gradient.squaredNorm();
  return {gradient.dot(adjugate * gradient) / (square * square),
          (square * hessian.trace() - gradient.dot(hessian * gradient)) / (2 * square * std::sqrt(square))};
}

/// Of r(s) s for a radius r > 0 with gradient g and covariant Hessian A on the sphere, in a tangent frame: with
/// w^2 = r^2 + |g|^2,
///   K = det(r A - 2 g g^T - r^2) / (r^2 w^4),   H = (2 + (|g|^2 + g . A g / r) / w^2 - tr A / r) / (2 w).
inline PointCurvature star_shaped_curvature(double r, const Eigen::Vector2d& g, const Eigen::Matrix2d& A) {
  const double square = g.squaredNorm(), w2 = r * r + square;
  const Eigen::Matrix2d bend = r * A - 2 * g * g.transpose() - r * r * Eigen::Matrix2d::Identity();
  return {bend.determinant() / (r * r * w2 * w2),
          (2 + (square + g.dot(A * g) / r) / w2 - A.trace() / r) / (2 * std::sqrt(w2))};
}

}  // namespace dsns
