#pragma once
/// A moving surface seen through a registration: O F(gamma(s), zeta(t)).
#include <dsns/elastic/time_warp.hpp>
#include <dsns/sphere/diffeomorphism.hpp>
#include <dsns/surface/motion.hpp>

#include <utility>

namespace dsns {

/// Refers to the moving surface, which must outlive it.
template <AnimatedSurface F>
class RegisteredSurface : public Transformed<Reparametrized<TimeWarped<const F&, TimeWarp>, SphereDiffeomorphism>> {
  using Resampled = Reparametrized<TimeWarped<const F&, TimeWarp>, SphereDiffeomorphism>;

 public:
  RegisteredSurface(const F& surface, const Mat3& rotation, SphereDiffeomorphism gamma, TimeWarp zeta = {})
      : Transformed<Resampled>(Resampled({surface, std::move(zeta)}, std::move(gamma)), rotation, Vec3d::Zero()) {}
  RegisteredSurface(const F&& surface, const Mat3& rotation, SphereDiffeomorphism gamma, TimeWarp zeta = {}) = delete;
};

}  // namespace dsns
