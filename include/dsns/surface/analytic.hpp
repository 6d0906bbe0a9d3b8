#pragma once
/// Surfaces given by formulas: the ground truth of tests, and bodies for demonstrations.
#include <dsns/surface/jets.hpp>

#include <vector>

namespace dsns {

/// (a x, b y, c z) for s = (x, y, z).
struct Ellipsoid {
  double a = 1, b = 1, c = 1;

  template <class T>
  Vec3<T> operator()(const Vec3<T>& s) const {
    return {a * s.x(), b * s.y(), c * s.z()};
  }
};

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

/// A limb of a LimbedBody: a smooth bump around the unit vector `root`, pulled along `reach` and swung along `swing`.
struct Limb {
  Vec3d root;                   ///< where on the sphere it grows, unit
  double sharpness = 8;         ///< the bump is exp(sharpness (s . root - 1)): about 1/sqrt(sharpness) radians wide
  Vec3d reach;                  ///< displacement of its tip from the trunk
  Vec3d swing = Vec3d::Zero();  ///< amplitude of the tip's motion
  double phase = 0;             ///< of the motion, in cycles
};

/// A moving body: an ellipsoidal trunk with limbs that swing `cycles` times per clip. The pace varies within the clip:
/// its clock runs as t + pace sin(2 pi t) / (2 pi), |pace| < 1.
struct LimbedBody {
  Vec3d axes{1, 1, 1};
  std::vector<Limb> limbs;
  double cycles = 1;
  double pace = 0;

  template <class T>
  Vec3<T> operator()(const Vec3<T>& s, const T& t) const {
    using std::exp, std::sin;
    Vec3<T> p{axes.x() * s.x(), axes.y() * s.y(), axes.z() * s.z()};
    const T clock = t + pace / (2 * pi) * sin(2 * pi * t);
    for (const Limb& limb : limbs) {
      const T along = limb.root.x() * s.x() + limb.root.y() * s.y() + limb.root.z() * s.z();
      const T bump = exp(limb.sharpness * (along - 1.0));
      const T swing = sin(2 * pi * (cycles * clock + limb.phase));
      for (int k = 0; k < 3; ++k) p[k] += bump * (limb.reach[k] + limb.swing[k] * swing);
    }
    return p;
  }
};

static_assert(Surface<Ellipsoid> && AnimatedSurface<LimbedBody>);

}  // namespace dsns
