#pragma once
/// What the derivatives of a surface in its charts say of its metric and its bending: fundamental forms, normals, the dual
/// basis, Christoffel symbols. Indices u and v are those of the charts (sphere/charts.hpp): E, F, G, L, M, N and the symbols
/// depend on the frame e1, e2 of each point; normals, densities and all that curvature.hpp and operators.hpp make of them
/// do not.
#include <dsns/surface/jets.hpp>

#include <concepts>

namespace dsns {

/// SurfaceTangents, SurfaceJets and MotionJets: whatever has f_u and f_v at n points.
template <class J>
concept HasTangents = std::same_as<decltype(J::fu), Mat3X> && std::same_as<decltype(J::fv), Mat3X>;

/// n = f_u x f_v, 3 x n: outward for an outward surface, its length the area density against the sphere's own area.
template <HasTangents J>
Mat3X area_normals(const J& j) {
  Mat3X n(3, j.fu.cols());
  for (Index i = 0; i < n.cols(); ++i) n.col(i) = Vec3d(j.fu.col(i)).cross(Vec3d(j.fv.col(i)));
  return n;
}

/// |f_u x f_v| = sqrt(EG - F^2) at n points.
template <HasTangents J>
Eigen::VectorXd area_densities(const J& j) {
  return area_normals(j).colwise().norm().transpose();
}

/// Unit normals, 3 x n.
/// throws   DegenerateSurface where f_u and f_v are dependent
template <HasTangents J>
Mat3X unit_normals(const J& j) {
  Mat3X n = area_normals(j);
  for (Index i = 0; i < n.cols(); ++i) {
    const double density = n.col(i).norm();
    require<DegenerateSurface>(density > 0, "unit_normals: the area density is ", density, " at point ", i,
                               ", the surface is not immersed there");
    n.col(i) /= density;
  }
  return n;
}

/// The metric of n charts: E = <f_u, f_u>, F = <f_u, f_v>, G = <f_v, f_v>.
struct FirstFundamentalForm {
  Eigen::VectorXd E, F, G;
};

template <HasTangents J>
FirstFundamentalForm first_fundamental_form(const J& j) {
  return {j.fu.colwise().squaredNorm().transpose(), j.fu.cwiseProduct(j.fv).colwise().sum().transpose(),
          j.fv.colwise().squaredNorm().transpose()};
}

/// L = <n, f_uu>, M = <n, f_uv>, N = <n, f_vv> with the outward unit normal n: negative definite where a body is convex.
struct SecondFundamentalForm {
  Eigen::VectorXd L, M, N;
};

/// throws   DegenerateSurface where the surface is not immersed
/// source   do Carmo 1976, section 3-3
inline SecondFundamentalForm second_fundamental_form(const SurfaceJets& j) {
  const Mat3X n = unit_normals(j);
  const auto along_normal = [&](const Mat3X& second) {
    return Eigen::VectorXd(n.cwiseProduct(second).colwise().sum().transpose());
  };
  return {along_normal(j.fuu), along_normal(j.fuv), along_normal(j.fvv)};
}

/// First derivatives of E, F and G along each point's chart s(u, v) = exp_s(u e1 + v e2), at its origin.
struct MetricDerivatives {
  Eigen::VectorXd Eu, Ev, Fu, Fv, Gu, Gv;
};

/// accuracy 1e-11 against the metric of that chart as a 2-jet [geometry/fundamental_forms_test]
inline MetricDerivatives metric_derivatives(const SurfaceJets& j) {
  const auto product = [](const Mat3X& a, const Mat3X& b) {
    return Eigen::VectorXd(a.cwiseProduct(b).colwise().sum().transpose());
  };
  return {2 * product(j.fu, j.fuu),
          2 * product(j.fu, j.fuv),
          product(j.fuu, j.fv) + product(j.fu, j.fuv),
          product(j.fuv, j.fv) + product(j.fu, j.fvv),
          2 * product(j.fv, j.fuv),
          2 * product(j.fv, j.fvv)};
}

/// The basis of the tangent plane that is dual to f_u, f_v: <du, f_u> = <dv, f_v> = 1, <du, f_v> = <dv, f_u> = 0; the
/// gradients of the coordinates u and v on the surface, and <du, du>, <du, dv>, <dv, dv> the inverse of the metric. 3 x n.
struct DualBasis {
  Mat3X du, dv;
};

/// du = f_v x n / |n|^2, dv = n x f_u / |n|^2 with n = f_u x f_v.
/// throws   DegenerateSurface where the surface is not immersed
template <HasTangents J>
DualBasis dual_basis(const J& j) {
  const Index size = j.fu.cols();
  DualBasis d{Mat3X(3, size), Mat3X(3, size)};
  for (Index i = 0; i < size; ++i) {
    const Vec3d fu = j.fu.col(i), fv = j.fv.col(i), n = fu.cross(fv);
    const double square = n.squaredNorm();
    require<DegenerateSurface>(square > 0, "dual_basis: the area density is ", n.norm(), " at point ", i,
                               ", the surface is not immersed there");
    d.du.col(i) = fv.cross(n) / square;
    d.dv.col(i) = n.cross(fu) / square;
  }
  return d;
}

/// Gamma^k_ij = g^kl <f_ij, f_l> of n charts; the upper index comes first: u_vv is Gamma^u_vv.
struct ChristoffelSymbols {
  Eigen::VectorXd u_uu, u_uv, u_vv, v_uu, v_uv, v_vv;
};

/// accuracy 1e-11 against the formula with derivatives of the metric [geometry/fundamental_forms_test]
/// throws   DegenerateSurface where the surface is not immersed
/// source   do Carmo 1976, section 4-3
inline ChristoffelSymbols christoffel_symbols(const SurfaceJets& j) {
  const DualBasis d = dual_basis(j);
  const auto part = [](const Mat3X& dual, const Mat3X& second) {
    return Eigen::VectorXd(dual.cwiseProduct(second).colwise().sum().transpose());
  };
  return {part(d.du, j.fuu), part(d.du, j.fuv), part(d.du, j.fvv),
          part(d.dv, j.fuu), part(d.dv, j.fuv), part(d.dv, j.fvv)};
}

}  // namespace dsns
