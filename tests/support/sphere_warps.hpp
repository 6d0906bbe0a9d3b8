#pragma once
/// Known diffeomorphisms of the sphere.
#include <dsns/sphere/diffeomorphism.hpp>

namespace dsns::test {

/// A random warp of given degree and size in degrees, after a turn.
inline SphereDiffeomorphism turned_warp(std::uint64_t seed, int degree, double size, const Vec3d& turn) {
  SphereDiffeomorphism gamma(rotation_exp(turn));
  const SphereDiffeomorphism warp = random_diffeomorphism(seed, degree, size * pi / 180);
  for (const SphereVectorField& v : warp.increments()) gamma.append(v);
  return gamma;
}

}  // namespace dsns::test
