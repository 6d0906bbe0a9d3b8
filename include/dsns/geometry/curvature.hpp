#pragma once
/// Normals and curvatures of a surface from its 2-jets.
#include <dsns/surface/jets.hpp>

namespace dsns {

/// n = f_u x f_v, 3 x n: outward for an outward surface, its length the area density against the sphere's own area.
inline Mat3X area_normals(const SurfaceJets& j) {
  Mat3X n(3, j.size());
  for (Index i = 0; i < n.cols(); ++i) n.col(i) = Vec3d(j.fu.col(i)).cross(Vec3d(j.fv.col(i)));
  return n;
}

/// Unit normals, 3 x n.
/// throws   DegenerateSurface where f_u and f_v are dependent
inline Mat3X unit_normals(const SurfaceJets& j) {
  Mat3X n = area_normals(j);
  for (Index i = 0; i < n.cols(); ++i) {
    const double density = n.col(i).norm();
    require<DegenerateSurface>(density > 0, "unit_normals: the area density is ", density, " at point ", i,
                               ", the surface is not immersed there");
    n.col(i) /= density;
  }
  return n;
}

/// Gaussian and mean curvature of n points.
struct Curvature {
  Eigen::VectorXd gaussian;  ///< K, length^-2
  Eigen::VectorXd mean;      ///< H, length^-1; a sphere of radius r has H = 1/r
};

/// K = (LN - M^2) / (EG - F^2), H = -(EN - 2FM + GL) / (2 (EG - F^2)) with the outward normal.
/// accuracy 1e-12 relative [geometry/curvature_test: ellipsoid, also at the poles]
/// throws   DegenerateSurface where EG - F^2 vanishes
/// source   do Carmo 1976, section 3-3
inline Curvature curvature(const SurfaceJets& j) {
  const Mat3X normals = unit_normals(j);
  Curvature c{Eigen::VectorXd(j.size()), Eigen::VectorXd(j.size())};
  for (Index i = 0; i < j.size(); ++i) {
    const Vec3d n = normals.col(i);
    const double E = j.fu.col(i).squaredNorm(), F = j.fu.col(i).dot(j.fv.col(i)), G = j.fv.col(i).squaredNorm();
    const double L = n.dot(j.fuu.col(i)), M = n.dot(j.fuv.col(i)), N = n.dot(j.fvv.col(i));
    const double det = E * G - F * F;
    c.gaussian[i] = (L * N - M * M) / det;
    c.mean[i] = -(E * N - 2 * F * M + G * L) / (2 * det);
  }
  return c;
}

/// The curvatures of a surface at the unit columns of s.
template <Surface S>
Curvature curvature(const S& surface, const Mat3X& s) {
  return curvature(jets(surface, charts_at(s)));
}

}  // namespace dsns
