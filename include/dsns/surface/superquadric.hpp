#pragma once
/// Superquadrics whose exponent leaves them smooth: rounded boxes.
#include <dsns/core/errors.hpp>
#include <dsns/surface/curvature_formulas.hpp>
#include <dsns/surface/jets.hpp>
#include <dsns/surface/smooth_functions.hpp>

#include <cmath>

namespace dsns {

/// |X/a|^p + |Y/b|^p + |Z/c|^p = 1 for an even exponent p, the sphere projected on it along rays before it is stretched.
/// Analytic everywhere; for other p the powers are not smooth on the coordinate planes (C2 but not C4 for p between 2 and 4,
/// not even C2 below 2). From p = 4 on it is flat where the axes meet it, K = H = 0.
template <class N>
class SuperquadricOf {
 public:
  static constexpr bool works_in_lanes = true;

  /// axes     half the extent along x, y and z, positive
  /// throws   InvalidArgument unless the exponent is even and at least 2
  SuperquadricOf(const Vec3<N>& axes, int exponent) : axes_(axes), exponent_(exponent) {
    require(exponent >= 2 && exponent % 2 == 0, "Superquadric: exponent ", exponent,
            ", give an even one: others are not smooth");
  }

  const Vec3<N>& axes() const { return axes_; }
  int exponent() const { return exponent_; }

  /// s / (|x|^p + |y|^p + |z|^p)^(1/p), the point before it is stretched by the axes.
  template <class T>
  Vec3<T> projected(const Vec3<T>& s) const {
    using std::pow;
    T sum(0.0);
    for (int k = 0; k < 3; ++k) sum = sum + detail::integer_power(s[k], exponent_);
    const T scale = pow(sum, -1.0 / exponent_);
    return {s[0] * scale, s[1] * scale, s[2] * scale};
  }

  template <class T>
  Vec3<T> operator()(const Vec3<T>& s) const {
    const Vec3<T> y = projected(s);
    return {axes_[0] * y[0], axes_[1] * y[1], axes_[2] * y[2]};
  }

 private:
  Vec3<N> axes_;
  int exponent_;
};
using Superquadric = SuperquadricOf<double>;

namespace detail {

inline PointCurvature superquadric_curvature(const Superquadric& q, const Vec3d& s) {
  const Vec3d y = q.projected(s);
  const int p = q.exponent();
  Vec3d gradient;
  Mat3 hessian = Mat3::Zero();
  for (int k = 0; k < 3; ++k) {  // a common factor p is left out
    const double power = integer_power(y[k], p - 2);
    gradient[k] = power * y[k] / q.axes()[k];
    hessian(k, k) = (p - 1) * power / (q.axes()[k] * q.axes()[k]);
  }
  return level_set_curvature(gradient, hessian);
}

}  // namespace detail

/// Closed forms at the image of s, those of the level set.
/// accuracy 1e-11 of the largest [surface/analytic_test]
inline double gaussian_curvature(const Superquadric& q, const Vec3d& s) {
  return detail::superquadric_curvature(q, s).gaussian;
}
inline double mean_curvature(const Superquadric& q, const Vec3d& s) {
  return detail::superquadric_curvature(q, s).mean;
}

static_assert(Surface<Superquadric>);

}  // namespace dsns
