#pragma once
/// Curvatures of a surface from its 2-jets. The sign is that of the outward normal's own change: a sphere of radius r has
/// both principal curvatures 1/r and mean curvature H = 1/r.
///
///   const Curvature c = curvature(Ellipsoid{1, 2, 5}, points);                       // c.gaussian, c.mean
///   const PrincipalAxes p = principal_curvatures(Ellipsoid{1, 2, 5}, points);        // p.k1 >= p.k2, p.t1, p.t2
#include <dsns/geometry/tangent_tensor.hpp>

namespace dsns {

/// The differential of the unit normal as a map of the tangent planes, -I^-1 II.
/// throws   DegenerateSurface where the surface is not immersed
/// source   do Carmo 1976, section 3-2, with the outward normal and so the other sign
inline TangentTensor shape_operator(const SurfaceJets& j) {
  const SecondFundamentalForm b = second_fundamental_form(j);
  return tangent_tensor(j, -b.L, -b.M, -b.N);
}

/// Gaussian and mean curvature of n points.
struct Curvature {
  Eigen::VectorXd gaussian;  ///< K, length^-2
  Eigen::VectorXd mean;      ///< H, length^-1; a sphere of radius r has H = 1/r
};

/// K = (LN - M^2) / (EG - F^2), H = -(EN - 2FM + GL) / (2 (EG - F^2)): determinant and half the trace of the shape operator.
/// accuracy 1e-11 relative on ellipsoids up to 1:300, at the poles too [geometry/curvature_test]
/// throws   DegenerateSurface where EG - F^2 vanishes
/// source   do Carmo 1976, section 3-3
inline Curvature curvature(const SurfaceJets& j) {
  const TangentTensor s = shape_operator(j);
  return {s.determinant(), s.trace() / 2};
}

/// Principal curvatures k1 >= k2, length^-1, with their unit directions; at umbilic points the rule of principal_axes.
/// accuracy 1e-11 relative, directions conjugate to 1e-11, on ellipsoids up to 1:300 [geometry/curvature_test]
/// throws   DegenerateSurface where the surface is not immersed
inline PrincipalAxes principal_curvatures(const SurfaceJets& j) { return principal_axes(shape_operator(j)); }

/// The curvatures of a surface at the unit columns of s.
template <Surface S>
Curvature curvature(const S& surface, const Mat3X& s) {
  return curvature(jets(surface, charts_at(s)));
}
template <Surface S>
PrincipalAxes principal_curvatures(const S& surface, const Mat3X& s) {
  return principal_curvatures(jets(surface, charts_at(s)));
}

}  // namespace dsns
