#pragma once
/// Points of the unit sphere with an orthonormal tangent frame each: the coordinates of every derivative in dsns.
/// The chart of a point is s(u, v) = exp_s(u e1 + v e2), so at the point s_u = e1, s_v = e2, s_uu = s_vv = -s, s_uv = 0.
/// No pole is special, and |f_u x f_v| is the area density against the sphere's own area.
#include <dsns/core/errors.hpp>
#include <dsns/core/types.hpp>

#include <cmath>

namespace dsns {

/// n points with their frames; all 3 x n, e1 x e2 = s.
struct ChartBatch {
  Mat3X s, e1, e2;
  Index size() const { return s.cols(); }
};

/// Two unit vectors that span the tangent plane at the unit vector s, right-handed with it.
struct TangentFrame {
  Vec3d e1, e2;
};

inline TangentFrame tangent_frame(const Vec3d& s) {
  const Vec3d away = std::abs(s.z()) < 0.9 ? Vec3d::UnitZ() : Vec3d::UnitX();
  const Vec3d e1 = away.cross(s).normalized();
  return {e1, s.cross(e1)};
}

/// Charts at the columns of s.
/// throws   InvalidArgument where a column is not a unit vector to 1e-9
inline ChartBatch charts_at(const Mat3X& s) {
  ChartBatch charts{s, Mat3X(3, s.cols()), Mat3X(3, s.cols())};
  for (Index i = 0; i < s.cols(); ++i) {
    const Vec3d point = s.col(i);
    require(std::abs(point.norm() - 1) < 1e-9, "charts_at: column ", i, " has length ", point.norm(),
            ", normalise the points first");
    const TangentFrame frame = tangent_frame(point);
    charts.e1.col(i) = frame.e1;
    charts.e2.col(i) = frame.e2;
  }
  return charts;
}

/// Point at colatitude u in [0, pi] (from +z) and longitude v, the spherical coordinates of the paper.
inline Vec3d spherical_point(double colatitude, double longitude) {
  return {std::sin(colatitude) * std::cos(longitude), std::sin(colatitude) * std::sin(longitude), std::cos(colatitude)};
}

/// Angle in radians between unit vectors, accurate also near 0 and pi.
inline double angle_between(const Vec3d& a, const Vec3d& b) { return 2 * std::atan2((a - b).norm(), (a + b).norm()); }

}  // namespace dsns
