#pragma once
/// Square-root normal fields: h(s) = n / sqrt|n|, n = f_u x f_v in an orthonormal frame of the sphere, so that the integral
/// of |h|^2 is the area. A rotation O acts as O h, a diffeomorphism as (h * gamma)(s) = sqrt(J(s)) h(gamma(s)); both keep
/// the L2 norm, and h of f o gamma is h * gamma.
/// source   Jermyn, Kurtek, Klassen, Srivastava 2012; the factor sqrt(J) as derived there
#include <dsns/geometry/fundamental_forms.hpp>

namespace dsns {

/// h with its derivatives along the chart's frame; all 3 x n.
struct SrnfJets {
  Mat3X h, hu, hv;
};

/// accuracy derivatives 1e-7 against central differences [elastic/srnf_test]
/// throws   DegenerateSurface where the surface is not immersed
inline SrnfJets srnf(const SurfaceJets& j) {
  const Index n = j.size();
  SrnfJets out{Mat3X(3, n), Mat3X(3, n), Mat3X(3, n)};
  for (Index i = 0; i < n; ++i) {
    const Vec3d fu = j.fu.col(i), fv = j.fv.col(i), fuu = j.fuu.col(i), fuv = j.fuv.col(i), fvv = j.fvv.col(i);
    const Vec3d normal = fu.cross(fv);
    const double density = normal.norm();
    require<DegenerateSurface>(density > 0, "srnf: the area density is ", density, " at point ", i,
                               ", the surface is not immersed there");
    const double root = std::sqrt(density);
    // The chart's own metric is orthonormal to second order, so dn needs no correction for the frame.
    const auto derivative = [&](const Vec3d& dn) -> Vec3d {
      return dn / root - normal * (normal.dot(dn) / (2 * density * density * root));
    };
    out.h.col(i) = normal / root;
    out.hu.col(i) = derivative(fuu.cross(fv) + fu.cross(fuv));
    out.hv.col(i) = derivative(fuv.cross(fv) + fu.cross(fvv));
  }
  return out;
}

/// The field alone, 3 x n: first derivatives of the surface are enough.
/// throws   DegenerateSurface where the surface is not immersed
inline Mat3X srnf(const SurfaceTangents& j) { return unit_normals(j) * area_densities(j).cwiseSqrt().asDiagonal(); }
template <Surface S>
Mat3X srnf(const S& surface, const Mat3X& s) {
  return srnf(tangents(surface, charts_at(s)));
}

}  // namespace dsns
