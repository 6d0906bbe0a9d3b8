#pragma once
/// Symmetric tensors of the tangent planes, such as the shape operator and the strain rate, without a trace of the chart they
/// were computed in.
#include <dsns/geometry/fundamental_forms.hpp>

#include <algorithm>
#include <cmath>

namespace dsns {

/// At n points, T(t1) = xx t1 + xy t2 and T(t2) = xy t1 + yy t2 in an orthonormal basis with t1 x t2 the outward normal:
/// t1 is the direction in R^3 in which the chart is stretched most; where it is stretched alike in all directions (to 1e-10
/// of it), that of f_u.
struct TangentTensor {
  Mat3X t1, t2;
  Eigen::VectorXd xx, xy, yy;

  Index size() const { return xx.size(); }
  Eigen::VectorXd trace() const { return xx + yy; }
  Eigen::VectorXd determinant() const { return xx.cwiseProduct(yy) - xy.cwiseAbs2(); }
};

/// Eigenvalues of a symmetric tangent tensor and their unit directions in R^3, k1 >= k2, t1 x t2 = n.
struct PrincipalAxes {
  Eigen::VectorXd k1, k2;
  Mat3X t1, t2;
};

namespace detail {

/// Cosine (not negative) and sine of the angle from the first axis to the larger eigenvalue's of ((xx, xy), (xy, yy)); the
/// first axis itself where both eigenvalues are equal to 1e-10 of their size.
struct AxisAngle {
  double c, s;
};

inline AxisAngle larger_axis(double xx, double xy, double yy) {
  const double half = (xx - yy) / 2, r = std::hypot(half, xy);
  if (r <= 0.5e-10 * (std::abs(xx) + std::abs(yy))) return {1, 0};
  const double cos2 = half / r, sin2 = xy / r;  // of twice the angle: half-angle formulas without cancellation
  if (cos2 >= 0) {
    const double c = std::sqrt((1 + cos2) / 2);
    return {c, sin2 / (2 * c)};
  }
  const double s = std::copysign(std::sqrt((1 - cos2) / 2), sin2);
  return {sin2 / (2 * s), s};
}

}  // namespace detail

/// The tensor <T f_i, f_j> = ((uu, uv), (uv, vv)) of n charts. The chart's frame is first turned so that f_u and f_v are
/// orthogonal: bodies as flat as 1:300 lose no digits to EG - F^2.
/// throws   DegenerateSurface where the surface is not immersed
template <HasTangents J>
TangentTensor tangent_tensor(const J& j, const Eigen::VectorXd& uu, const Eigen::VectorXd& uv,
                             const Eigen::VectorXd& vv) {
  const Index size = j.fu.cols();
  TangentTensor out{Mat3X(3, size), Mat3X(3, size), Eigen::VectorXd(size), Eigen::VectorXd(size),
                    Eigen::VectorXd(size)};
  for (Index i = 0; i < size; ++i) {
    const Vec3d fu = j.fu.col(i), fv = j.fv.col(i);
    const auto [c, s] = detail::larger_axis(fu.squaredNorm(), fu.dot(fv), fv.squaredNorm());
    const Vec3d p = c * fu + s * fv, q = c * fv - s * fu, n = p.cross(q);
    const double a = p.norm(), density = n.norm();
    require<DegenerateSurface>(density > 0, "tangent_tensor: the area density is ", density, " at point ", i,
                               ", the surface is not immersed there");
    const Vec3d t1 = p / a, t2 = (n / density).cross(t1);
    const double d = density / a, skew = t1.dot(q) / a;  // q = skew p + d t2, skew 0 but for rounding
    const double A = c * c * uu[i] + 2 * c * s * uv[i] + s * s * vv[i];
    const double B = c * s * (vv[i] - uu[i]) + (c * c - s * s) * uv[i];
    const double C = s * s * uu[i] - 2 * c * s * uv[i] + c * c * vv[i];
    out.t1.col(i) = t1;
    out.t2.col(i) = t2;
    out.xx[i] = A / (a * a);
    out.xy[i] = (B - skew * A) / (a * d);
    out.yy[i] = (C - 2 * skew * B + skew * skew * A) / (d * d);
  }
  return out;
}

/// The larger eigenvalue in size from the mean, the other from the determinant: no cancellation where one is much smaller.
/// Where both are equal to 1e-10 of their size (umbilic points, of curvatures), the axes are the tensor's basis.
inline PrincipalAxes principal_axes(const TangentTensor& t) {
  const Index size = t.size();
  const Eigen::VectorXd determinant = t.determinant();
  PrincipalAxes out{Eigen::VectorXd(size), Eigen::VectorXd(size), Mat3X(3, size), Mat3X(3, size)};
  for (Index i = 0; i < size; ++i) {
    const double mean = (t.xx[i] + t.yy[i]) / 2, r = std::hypot((t.xx[i] - t.yy[i]) / 2, t.xy[i]);
    const double large = mean >= 0 ? mean + r : mean - r;
    const double small = large == 0 ? 0 : determinant[i] / large;
    out.k1[i] = std::max(large, small);
    out.k2[i] = std::min(large, small);
    const auto [c, s] = detail::larger_axis(t.xx[i], t.xy[i], t.yy[i]);
    out.t1.col(i) = c * t.t1.col(i) + s * t.t2.col(i);
    out.t2.col(i) = c * t.t2.col(i) - s * t.t1.col(i);
  }
  return out;
}

}  // namespace dsns
