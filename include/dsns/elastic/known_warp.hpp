#pragma once
/// The experiment that judges spatial registration: a surface is warped and turned by a map that is known, registration finds
/// what it can, and the map that it found is compared with the truth. An energy alone does not tell: it can fall while the
/// correspondence worsens.
#include <dsns/elastic/spatial_registration.hpp>
#include <dsns/sphere/sphere_map.hpp>

namespace dsns {

/// The surface f becomes O f(gamma(s)). On a surface with symmetries the truth is not unique.
struct KnownWarp {
  Mat3 rotation;
  SphereDiffeomorphism gamma;  ///< a turn of the sphere, then the warp
  double size;                 ///< of the warp alone: root mean square over the sphere, radians
};

/// How far a known warp turns the body and its sphere.
enum class KnownTurns {
  any,   ///< both drawn uniformly from all rotations
  none,  ///< the warp alone
};

/// The warp of random_diffeomorphism(seed, degree, size), with rotations of the same seed.
/// throws   as random_diffeomorphism
inline KnownWarp known_warp(std::uint64_t seed, int degree, double size, KnownTurns turns = KnownTurns::any) {
  std::mt19937_64 random(seed);
  KnownWarp out{Mat3::Identity(), SphereDiffeomorphism(), size};
  if (turns == KnownTurns::any) {
    out.rotation = random_rotation(random);
    out.gamma = SphereDiffeomorphism(random_rotation(random));
  }
  const SphereDiffeomorphism warp = random_diffeomorphism(seed, degree, size);
  for (const SphereVectorField& v : warp.increments()) out.gamma.append(v);
  return out;
}

/// What registration made of a known warp. Angles are in radians, over the whole sphere.
struct WarpRecovery {
  double size = 0;             ///< of the warp
  double missed = 0;           ///< by the map found, root mean square
  double missed_most = 0;      ///< largest of 2000 evenly spread points
  double missed_rotation = 0;  ///< angle between both rotations of the body
  double min_jacobian = 0;     ///< of the map found, at 20000 points on which nothing else looks
};

/// Compares a registration with the truth.
/// accuracy what knows the turns of a warp of size w, but not the warp, misses it by w, to 1 % [elastic/known_warp_test]
inline WarpRecovery recovery(const KnownWarp& truth, const Mat3& rotation, const SphereDiffeomorphism& gamma) {
  const AngularDistance miss = angular_distance(gamma, truth.gamma, fibonacci_sphere(2000));
  return {truth.size, miss.rms, miss.largest, rotation_angle(rotation * truth.rotation.transpose()),
          min_jacobian(gamma, fibonacci_sphere(20000).points)};
}

}  // namespace dsns
