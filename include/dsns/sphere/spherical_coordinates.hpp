#pragma once
/// Spherical coordinates as in the paper: colatitude u in [0, pi] from +z, longitude v in (-pi, pi] from +x,
///   s(u, v) = (sin u cos v, sin u sin v, cos u),
/// the unit frame s_u, s_v / sin u, and derivatives in (u, v) against those in the library's charts, in closed form:
///   F_u = F1,   F_v = sin u F2,   F_uu = F11,   F_uv = sin u F12 + cos u F2,   F_vv = sin^2 u F22 - sin u cos u F1,
/// with 1, 2 the chart aligned with the coordinates (charts_of_coordinates). At a pole the longitude is 0 by convention, the
/// frame is that of the meridian v = 0, and everything stays finite but nothing with sin u comes back: use charts there.
#include <dsns/core/errors.hpp>
#include <dsns/sphere/charts.hpp>

#include <cmath>

namespace dsns {

/// Angles in radians.
struct SphericalCoordinates {
  double u = 0;  ///< colatitude
  double v = 0;  ///< longitude
};

/// Colatitude and longitude of a direction; the longitude of a pole is 0.
/// accuracy 1e-15 radians, also near the poles where acos(z) has lost half the digits [sphere/spherical_coordinates_test]
inline SphericalCoordinates spherical_coordinates(const Vec3d& s) {
  const double sine = std::hypot(s.x(), s.y());
  return {std::atan2(sine, s.z()), sine > 0 ? std::atan2(s.y(), s.x()) : 0.0};
}

/// s with its derivatives in the coordinates at one (u, v).
struct SphericalJet {
  Vec3d s, su, sv, suu, suv, svv;
};

inline SphericalJet spherical_jet(const SphericalCoordinates& c) {
  const double sin_u = std::sin(c.u), cos_u = std::cos(c.u), sin_v = std::sin(c.v), cos_v = std::cos(c.v);
  return {{sin_u * cos_v, sin_u * sin_v, cos_u}, {cos_u * cos_v, cos_u * sin_v, -sin_u},
          {-sin_u * sin_v, sin_u * cos_v, 0},    {-sin_u * cos_v, -sin_u * sin_v, -cos_u},
          {-cos_u * sin_v, cos_u * cos_v, 0},    {-sin_u * cos_v, -sin_u * sin_v, 0}};
}

/// The unit vectors s_u and s_v / sin u at a direction: the tangent plane's frame (e1, e2). At a pole those of v = 0.
inline TangentFrame spherical_frame(const Vec3d& s) {
  const double sine = std::hypot(s.x(), s.y());
  const double cos_v = sine > 0 ? s.x() / sine : 1, sin_v = sine > 0 ? s.y() / sine : 0;
  return {Vec3d(s.z() * cos_v, s.z() * sin_v, -sine).normalized(), Vec3d(-sin_v, cos_v, 0)};
}

/// Charts at the columns of s whose frames are spherical_frame: away from the poles derivatives in them are F_u and
/// F_v / sin u. The frame turns ever faster towards a pole, so fields of its components are not smooth there.
/// throws   InvalidArgument where a column is not a unit vector to 1e-9
inline ChartBatch charts_of_coordinates(const Mat3X& s) {
  ChartBatch charts = charts_at(s);
  for (Index i = 0; i < s.cols(); ++i) {
    const TangentFrame frame = spherical_frame(s.col(i));
    charts.e1.col(i) = frame.e1;
    charts.e2.col(i) = frame.e2;
  }
  return charts;
}

/// First and second derivatives of a function (a number or a vector V) of two variables: of a chart, or of (u, v).
template <class V>
struct SecondOrder {
  V u, v, uu, uv, vv;
};

/// Derivatives in one chart from those in another at the same point whose frame is turned by `angle` against the first's:
/// e1' = cos e1 + sin e2, e2' = -sin e1 + cos e2. Charts differ in first order only.
template <class V>
SecondOrder<V> turned(const SecondOrder<V>& d, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {V(c * d.u + s * d.v), V(c * d.v - s * d.u), V(c * c * d.uu + 2 * c * s * d.uv + s * s * d.vv),
          V(c * s * (d.vv - d.uu) + (c * c - s * s) * d.uv), V(s * s * d.uu - 2 * c * s * d.uv + c * c * d.vv)};
}

/// Derivatives in (u, v) at colatitude u from those in the chart aligned with the coordinates; finite also at the poles.
template <class V>
SecondOrder<V> coordinate_derivatives(const SecondOrder<V>& d, double colatitude) {
  const double s = std::sin(colatitude), c = std::cos(colatitude);
  return {d.u, V(s * d.v), d.uu, V(s * d.uv + c * d.v), V(s * s * d.vv - s * c * d.u)};
}

/// Derivatives in the chart aligned with the coordinates from those in (u, v): F_u, F_v / sin u and so on.
/// accuracy loses 1 / sin u and 1 / sin^2 u of the digits in first and second order
/// throws   InvalidArgument at a pole, where (u, v) are no coordinates
template <class V>
SecondOrder<V> chart_derivatives(const SecondOrder<V>& d, double colatitude) {
  const double s = std::sin(colatitude), c = std::cos(colatitude);
  require(colatitude > 0 && s > 1e-15, "chart_derivatives: colatitude ", colatitude,
          " is a pole, take derivatives in a chart there");
  const V v = V(d.v / s);
  return {d.u, v, d.uu, V((d.uv - c * v) / s), V((d.vv / s + c * d.u) / s)};
}

}  // namespace dsns
