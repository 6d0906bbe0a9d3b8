#pragma once
/// Surfaces that every ray from the origin meets once: r(s) s with a radius r > 0.
#include <dsns/core/errors.hpp>
#include <dsns/sphere/harmonics.hpp>
#include <dsns/sphere/quadrature.hpp>
#include <dsns/surface/curvature_formulas.hpp>
#include <dsns/surface/jets.hpp>

#include <algorithm>
#include <cmath>

namespace dsns {

/// The radius is a sum of harmonics, r(s) = sum_k c_k Y_k(s), proved positive when the surface is made.
class StarShaped {
 public:
  static constexpr bool works_in_lanes = true;

  /// coefficients (degree + 1)^2, index l^2 + l + m.
  /// throws   InvalidArgument where their number is not a square, or the radius cannot be proved positive
  explicit StarShaped(Eigen::VectorXd coefficients) : coefficients_(std::move(coefficients)) {
    degree_ = harmonic_degree(coefficients_.size());
    least_radius_ = lower_bound();
    require(least_radius_ > 0, "StarShaped: the radius is proved to be no more than ", least_radius_,
            " from below, it must be positive: give a larger first coefficient");
  }

  int degree() const { return degree_; }
  const Eigen::VectorXd& coefficients() const { return coefficients_; }
  /// A number that the radius is nowhere below.
  double least_radius() const { return least_radius_; }

  template <class T>
  Vec3<T> operator()(const Vec3<T>& s) const {
    const auto y = harmonics<T>(s, degree_);
    T r(0.0);
    for (Index k = 0; k < y.size(); ++k) r = r + coefficients_[k] * y[k];
    return {r * s.x(), r * s.y(), r * s.z()};
  }

 private:
  /// The least radius on a grid eight times finer than the bandwidth, less what the steepest slope makes of the way to the next
  /// node. Degree l alone is no steeper than |c_l| sqrt(l(l + 1)(2l + 1) / (8 pi)), by the addition theorem.
  double lower_bound() const {
    const int n = 8 * (degree_ + 1);
    const GaussLegendre rule = gauss_legendre(n);
    // From the pole to the first circle of latitude, then half between circles.
    double gap = std::acos(rule.nodes[n - 1]);
    for (int i = 1; i < n; ++i) gap = std::max(gap, (std::acos(rule.nodes[i - 1]) - std::acos(rule.nodes[i])) / 2);
    double slope = 0;
    for (int l = 1; l <= degree_; ++l)
      slope += coefficients_.segment(Index(l) * l, 2 * l + 1).norm() * std::sqrt(l * (l + 1) * (2 * l + 1) / (8 * pi));
    const double on_grid = (harmonics(sphere_quadrature(n).points, degree_) * coefficients_).minCoeff();
    return on_grid - slope * (gap + pi / (2 * n));
  }

  Eigen::VectorXd coefficients_;
  int degree_;
  double least_radius_;
};

/// A unit sphere with bumps and dents, r = 1 + amplitude sin(f x) sin(f y) sin(f z), |amplitude| < 1.
template <class N>
struct BumpySphereOf {
  static constexpr bool works_in_lanes = true;
  N amplitude = 0.2;
  double frequency = 4;

  template <class T>
  Vec3<T> operator()(const Vec3<T>& s) const {
    using std::sin;
    const T bump = sin(frequency * s.x()) * sin(frequency * s.y()) * sin(frequency * s.z());
    const T r = 1.0 + amplitude * bump;
    return {r * s.x(), r * s.y(), r * s.z()};
  }
};
using BumpySphere = BumpySphereOf<double>;

namespace detail {

inline PointCurvature radial_curvature(const StarShaped& f, const Vec3d& s) {
  const FunctionJets<1> r = harmonic_sum_jets<1>(f.coefficients(), charts_at(s));
  Eigen::Matrix2d hessian;
  hessian << r.fuu[0], r.fuv[0], r.fuv[0], r.fvv[0];
  return star_shaped_curvature(r.f[0], {r.fu[0], r.fv[0]}, hessian);
}

inline PointCurvature radial_curvature(const BumpySphere& f, const Vec3d& s) {
  const Vec3d a = (f.frequency * s.array()).sin(), b = f.frequency * (f.frequency * s.array()).cos();
  const double product = f.amplitude * a.prod(), square = f.frequency * f.frequency;
  const Vec3d gradient = f.amplitude * Vec3d(b[0] * a[1] * a[2], a[0] * b[1] * a[2], a[0] * a[1] * b[2]);
  Mat3 hessian = -square * product * Mat3::Identity();
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    hessian(i, j) = hessian(j, i) = f.amplitude * a[k] * b[i] * b[j];
  }
  const TangentFrame frame = tangent_frame(s);
  Eigen::Matrix<double, 3, 2> tangents;
  tangents << frame.e1, frame.e2;
  return star_shaped_curvature(
      1 + product, tangents.transpose() * gradient,
      tangents.transpose() * hessian * tangents - s.dot(gradient) * Eigen::Matrix2d::Identity());
}

}  // namespace detail

/// Closed forms at the image of s, from the derivatives of the radius in R^3.
/// accuracy 1e-11 of the largest [surface/analytic_test]
inline double gaussian_curvature(const StarShaped& f, const Vec3d& s) {
  return detail::radial_curvature(f, s).gaussian;
}
inline double mean_curvature(const StarShaped& f, const Vec3d& s) { return detail::radial_curvature(f, s).mean; }
inline double gaussian_curvature(const BumpySphere& f, const Vec3d& s) {
  return detail::radial_curvature(f, s).gaussian;
}
inline double mean_curvature(const BumpySphere& f, const Vec3d& s) { return detail::radial_curvature(f, s).mean; }

static_assert(Surface<StarShaped> && Surface<BumpySphere>);

}  // namespace dsns
