#pragma once
/// Sphere, spheroid and ellipsoid with their curvatures. N is the scalar of the parameters: a function of time gives
/// differentiating ones (surface/motion.hpp).
#include <dsns/surface/jets.hpp>

#include <cmath>

namespace dsns {

/// radius s, radius > 0.
template <class N>
struct SphereOf {
  static constexpr bool works_in_lanes = true;
  N radius = 1;

  template <class T>
  Vec3<T> operator()(const Vec3<T>& s) const {
    return {radius * s.x(), radius * s.y(), radius * s.z()};
  }
};
using Sphere = SphereOf<double>;

inline double gaussian_curvature(const Sphere& sphere, const Vec3d&) { return 1 / (sphere.radius * sphere.radius); }
inline double mean_curvature(const Sphere& sphere, const Vec3d&) { return 1 / sphere.radius; }

/// (a x, a y, c z) for s = (x, y, z), a and c > 0: an ellipsoid of revolution about the z axis.
template <class N>
struct SpheroidOf {
  static constexpr bool works_in_lanes = true;
  N a = 1, c = 1;

  template <class T>
  Vec3<T> operator()(const Vec3<T>& s) const {
    return {a * s.x(), a * s.y(), c * s.z()};
  }
};
using Spheroid = SpheroidOf<double>;

/// The product of the curvatures a c / w^3 of the meridian and c / (a w) across it, w^2 = a^2 z^2 + c^2 (1 - z^2).
inline double gaussian_curvature(const Spheroid& e, const Vec3d& s) {
  const double w2 = std::pow(e.a * s.z(), 2) + std::pow(e.c, 2) * (std::pow(s.x(), 2) + std::pow(s.y(), 2));
  return std::pow(e.c / w2, 2);
}
/// Their mean.
inline double mean_curvature(const Spheroid& e, const Vec3d& s) {
  const double w2 = std::pow(e.a * s.z(), 2) + std::pow(e.c, 2) * (std::pow(s.x(), 2) + std::pow(s.y(), 2));
  return e.c * (e.a * e.a + w2) / (2 * e.a * std::pow(w2, 1.5));
}

/// (a x, b y, c z) for s = (x, y, z).
template <class N>
struct EllipsoidOf {
  static constexpr bool works_in_lanes = true;
  N a = 1, b = 1, c = 1;

  template <class T>
  Vec3<T> operator()(const Vec3<T>& s) const {
    return {a * s.x(), b * s.y(), c * s.z()};
  }
};
using Ellipsoid = EllipsoidOf<double>;

/// Closed-form Gaussian curvature at the image of s: 1 / (a b c (X^2/a^4 + Y^2/b^4 + Z^2/c^4))^2.
inline double gaussian_curvature(const Ellipsoid& e, const Vec3d& s) {
  const double w = std::pow(s.x() / e.a, 2) + std::pow(s.y() / e.b, 2) + std::pow(s.z() / e.c, 2);
  return 1 / std::pow(e.a * e.b * e.c * w, 2);
}

/// Closed-form mean curvature at the image of s; a sphere of radius r has H = 1/r.
inline double mean_curvature(const Ellipsoid& e, const Vec3d& s) {
  const double w = std::pow(s.x() / e.a, 2) + std::pow(s.y() / e.b, 2) + std::pow(s.z() / e.c, 2);
  const double r2 = std::pow(e.a * s.x(), 2) + std::pow(e.b * s.y(), 2) + std::pow(e.c * s.z(), 2);
  const double trace = e.a * e.a + e.b * e.b + e.c * e.c;
  return (trace - r2) / (2 * std::pow(e.a * e.b * e.c, 2) * std::pow(w, 1.5));
}

static_assert(Surface<Sphere> && Surface<Spheroid> && Surface<Ellipsoid>);

}  // namespace dsns
