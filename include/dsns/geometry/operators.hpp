#pragma once
/// Differential operators of the surface's own metric: gradient, divergence, Laplace-Beltrami. A function on the surface is a
/// function u(s) on the sphere (to write it in terms of the position, take s to f(s) inside): a functor with any scalar, or
/// coefficients over the real harmonics. A vector field along the surface is a functor s -> R^3, tangential or not.
///
///   const auto height = [&](const auto& s) { return body(s).z(); };
///   const Mat3X g = surface_gradient(body, height, points);
///   const Eigen::VectorXd l = laplace_beltrami(body, height, points);        // -2 H n_z
#include <dsns/geometry/fundamental_forms.hpp>
#include <dsns/sphere/harmonics.hpp>

namespace dsns {

/// A real function of a unit vector that takes a differentiating scalar.
template <class U>
concept SphereFunction = requires(const U& u, const Vec3<detail::SpatialJet>& s) {
  { u(s) } -> std::same_as<detail::SpatialJet>;
};

/// Values and derivatives at n points in their charts.
template <SphereFunction U>
FunctionJets<1> function_jets(const U& u, const ChartBatch& c) {
  const Eigen::RowVectorXd none(c.size());
  FunctionJets<1> out{none, none, none, none, none, none};
  for (Index i = 0; i < c.size(); ++i) {
    const detail::SpatialJet y = u(detail::chart_jet(c, i));
    out.f[i] = y.f;
    out.fu[i] = y.g[0];
    out.fv[i] = y.g[1];
    out.fuu[i] = y.h[0];
    out.fuv[i] = y.h[1];
    out.fvv[i] = y.h[2];
  }
  return out;
}

/// Of sum c_k Y_k.
/// throws   InvalidArgument unless the number of coefficients is (degree + 1)^2
inline FunctionJets<1> function_jets(const Eigen::VectorXd& coefficients, const ChartBatch& c) {
  return harmonic_sum_jets<1>(coefficients, c);
}

/// grad u = u_u du + u_v dv with the dual basis: the tangent vector in R^3 with <grad u, f_u> = u_u, 3 x n, unit of u per length.
/// throws   DegenerateSurface where the surface is not immersed
template <HasTangents J>
Mat3X surface_gradient(const J& j, const FunctionJets<1>& u) {
  const DualBasis d = dual_basis(j);
  return d.du * u.fu.asDiagonal() + d.dv * u.fv.asDiagonal();
}

/// div X = <du, X_u> + <dv, X_v>: the surface's divergence of the tangential part of X plus 2 H <X, n>.
/// throws   DegenerateSurface where the surface is not immersed
template <HasTangents J>
Eigen::VectorXd surface_divergence(const J& j, const SurfaceTangents& X) {
  const DualBasis d = dual_basis(j);
  return (d.du.cwiseProduct(X.fu) + d.dv.cwiseProduct(X.fv)).colwise().sum().transpose();
}

/// Laplace-Beltrami operator g^ij (u_ij - Gamma^k_ij u_k), negative on the round sphere: -l(l + 1) Y.
/// accuracy 1e-11 against div grad on ellipsoids [geometry/operators_test]
/// throws   DegenerateSurface where the surface is not immersed
inline Eigen::VectorXd laplace_beltrami(const SurfaceJets& j, const FunctionJets<1>& u) {
  const DualBasis d = dual_basis(j);
  const Mat3X gradient = d.du * u.fu.asDiagonal() + d.dv * u.fv.asDiagonal();
  Eigen::VectorXd out(j.size());
  for (Index i = 0; i < j.size(); ++i) {
    // Gamma^k_ij u_k = <f_ij, grad u>
    const double uu = u.fuu[i] - j.fuu.col(i).dot(gradient.col(i));
    const double uv = u.fuv[i] - j.fuv.col(i).dot(gradient.col(i));
    const double vv = u.fvv[i] - j.fvv.col(i).dot(gradient.col(i));
    out[i] = d.du.col(i).squaredNorm() * uu + 2 * d.du.col(i).dot(d.dv.col(i)) * uv + d.dv.col(i).squaredNorm() * vv;
  }
  return out;
}

/// Each of a surface at the unit columns of s; u is a functor or coefficients over the harmonics.
template <Surface S, class U>
Mat3X surface_gradient(const S& surface, const U& u, const Mat3X& s) {
  const ChartBatch c = charts_at(s);
  return surface_gradient(tangents(surface, c), function_jets(u, c));
}
template <Surface S, class U>
Eigen::VectorXd laplace_beltrami(const S& surface, const U& u, const Mat3X& s) {
  const ChartBatch c = charts_at(s);
  return laplace_beltrami(jets(surface, c), function_jets(u, c));
}
/// X is written as a surface is: a functor with any scalar, or with members `jets` or `tangents`.
template <Surface S, Surface Field>
Eigen::VectorXd surface_divergence(const S& surface, const Field& X, const Mat3X& s) {
  const ChartBatch c = charts_at(s);
  return surface_divergence(tangents(surface, c), tangents(X, c));
}

}  // namespace dsns
