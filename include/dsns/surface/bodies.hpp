#pragma once
/// Moving bodies given by a formula: ground truth and demonstrations.
#include <dsns/surface/jets.hpp>

#include <vector>

namespace dsns {

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
  static constexpr bool works_in_lanes = true;
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

static_assert(AnimatedSurface<LimbedBody>);

}  // namespace dsns
