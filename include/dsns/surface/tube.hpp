#pragma once
/// Tubes about a bent line, closed at both ends.
#include <dsns/core/errors.hpp>
#include <dsns/surface/curvature_formulas.hpp>
#include <dsns/surface/jets.hpp>
#include <dsns/surface/smooth_functions.hpp>

namespace dsns {

/// Part of a circle of any curvature, 0 included: through the origin along z there, bending towards x, y = 0.
template <class N>
struct ArcOf {
  N length = 2, curvature = 0;
};
using Arc = ArcOf<double>;

/// With w = z length / 2 along the arc, n1 and n2 its normals (in the plane and along y) and c the arc,
///   p = c(w) + radius q(z) (x n1(w) + y n2),   q = sqrt(1 + z^2 + ... + z^(2k - 2)),
/// so that discs of radius `radius` sqrt(1 - z^(2k)) sit across the arc. Analytic, also at the poles, which are the ends;
/// immersed for |curvature| radius < 1, and embedded where also |curvature| length < 2 pi. The larger k, the longer the part of
/// even width and the flatter the ends: those of k = length / (2 radius) are as round as half a ball.
template <class N>
class TubeOf {
 public:
  static constexpr bool works_in_lanes = true;

  /// flatness k >= 1
  /// throws   InvalidArgument unless length and radius are positive, |curvature| radius < 1 and k >= 1
  TubeOf(const ArcOf<N>& spine, const N& radius, int flatness = 2)
      : spine_(spine), radius_(radius), flatness_(flatness) {
    const auto r = value(radius), bend = value(spine.curvature) * r;
    require(detail::everywhere(value(spine.length) > 0 && r > 0), "Tube: length and radius must be positive");
    require(detail::everywhere(bend < 1 && bend > -1), "Tube: curvature times radius must lie between -1 and 1, else ",
            "the discs across the arc meet one another: give a smaller radius");
    require(flatness >= 1, "Tube: flatness ", flatness, ", give at least 1");
  }

  const ArcOf<N>& spine() const { return spine_; }
  const N& radius() const { return radius_; }
  int flatness() const { return flatness_; }

  /// radius q(z).
  template <class T>
  T spread(const T& z) const {
    using std::sqrt;
    const T z2 = z * z;
    T sum(1.0);
    for (int k = 1; k < flatness_; ++k) sum = 1.0 + z2 * sum;
    return radius_ * sqrt(sum);
  }

  template <class T>
  Vec3<T> operator()(const Vec3<T>& s) const {
    using std::cos, std::sin;
    const T r = spread(s.z()), a = r * s.x(), b = r * s.y();
    const T w = 0.5 * spine_.length * s.z(), angle = spine_.curvature * w;
    const T half = w * detail::sinc(T(0.5 * angle));
    return {0.5 * spine_.curvature * half * half + a * cos(angle), b, w * detail::sinc(angle) - a * sin(angle)};
  }

 private:
  ArcOf<N> spine_;
  N radius_;
  int flatness_;
};
using Tube = TubeOf<double>;

namespace detail {

/// The tube is the level set a^2 / r^2 + b^2 / r^2 + z^(2k) = 1 of the coordinates (a, b) across the arc and w along it, whose
/// scale factors are 1, 1 and h = 1 - curvature a.
inline PointCurvature tube_curvature(const Tube& tube, const Vec3d& s) {
  const int k = tube.flatness();
  const double bend = tube.spine().curvature, to_z = 2 / tube.spine().length, r2 = tube.radius() * tube.radius();
  const double spread = tube.spread(s.z()), a = spread * s.x(), b = spread * s.y(), h = 1 - bend * a;
  const double power = integer_power(s.z(), 2 * k - 2);
  const double along = 2 * k * power * s.z() * to_z, twice = 2 * k * (2 * k - 1) * power * to_z * to_z;
  Mat3 hessian = Mat3::Zero();
  hessian(0, 0) = hessian(1, 1) = 2 / r2;
  hessian(2, 2) = twice / (h * h) - 2 * a / r2 * bend / h;
  hessian(0, 2) = hessian(2, 0) = bend * along / (h * h);
  return level_set_curvature({2 * a / r2, 2 * b / r2, along / h}, hessian);
}

}  // namespace detail

/// Closed forms at the image of s, those of a level set in coordinates about the arc.
/// accuracy 1e-11 of the largest [surface/analytic_test]
inline double gaussian_curvature(const Tube& tube, const Vec3d& s) { return detail::tube_curvature(tube, s).gaussian; }
inline double mean_curvature(const Tube& tube, const Vec3d& s) { return detail::tube_curvature(tube, s).mean; }

static_assert(Surface<Tube>);

}  // namespace dsns
