#pragma once
/// How fast a moving surface moves, stretches and grows, from its exact velocities. Rates are per clip: t runs from 0 to 1.
#include <dsns/geometry/curvature.hpp>
#include <dsns/geometry/integrals.hpp>

namespace dsns {

/// The velocity's part along the outward normal, n values.
/// throws   DegenerateSurface where the surface is not immersed
inline Eigen::VectorXd normal_velocities(const MotionJets& j) {
  return unit_normals(j).cwiseProduct(j.ft).colwise().sum().transpose();
}

/// d/dt |f_u x f_v| at fixed points of the sphere.
/// throws   DegenerateSurface where the surface is not immersed
inline Eigen::VectorXd area_density_rates(const MotionJets& j) {
  const Mat3X n = unit_normals(j);
  Eigen::VectorXd rate(n.cols());
  for (Index i = 0; i < n.cols(); ++i) {
    const Vec3d fu = j.fu.col(i), fv = j.fv.col(i), ftu = j.ftu.col(i), ftv = j.ftv.col(i);
    rate[i] = n.col(i).dot(ftu.cross(fv) + fu.cross(ftv));
  }
  return rate;
}

/// dE/dt, dF/dt, dG/dt at fixed points of the sphere and fixed charts.
inline FirstFundamentalForm metric_rates(const MotionJets& j) {
  const auto product = [](const Mat3X& a, const Mat3X& b) {
    return Eigen::VectorXd(a.cwiseProduct(b).colwise().sum().transpose());
  };
  return {2 * product(j.fu, j.ftu), product(j.fu, j.ftv) + product(j.ftu, j.fv), 2 * product(j.fv, j.ftv)};
}

/// Half the rate of the metric as a tensor of the tangent planes: how fast a piece of the surface stretches in each direction,
/// per clip. Zero for rigid motions; the trace is the relative rate of area; principal_axes gives the extreme rates.
/// accuracy 1e-12 on affine motions [geometry/motion_test]
/// throws   DegenerateSurface where the surface is not immersed
inline TangentTensor strain_rates(const MotionJets& j) {
  const FirstFundamentalForm rate = metric_rates(j);
  return tangent_tensor(j, rate.E / 2, rate.F / 2, rate.G / 2);
}

/// Rates of a closed surface's measures at one time, per clip.
struct MeasureRates {
  double area = 0;               ///< integral of the rate of the area density
  double area_by_curvature = 0;  ///< integral of 2 H v_n: the same, for tangential motion only slides the points
  double volume = 0;             ///< integral of v_n
};

/// accuracy equal to differences of area and volume to 1e-8; both area rates as far as the quadrature resolves the surface
///          [geometry/motion_test]
/// throws   DegenerateSurface where the surface is not immersed
template <AnimatedSurface F>
MeasureRates measure_rates(const F& surface, const SphereQuadrature& q, double t) {
  const ChartBatch c = charts_at(q.points);
  const MotionJets j = motion_jets(surface, c, t);
  const Eigen::VectorXd flow = normal_velocities(j).cwiseProduct(area_densities(j)).cwiseProduct(q.weights);
  return {area_density_rates(j).dot(q.weights), 2 * curvature(jets(surface, c, t)).mean.dot(flow), flow.sum()};
}

}  // namespace dsns
