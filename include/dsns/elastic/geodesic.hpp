#pragma once
/// Geodesics between curves that are registered in time: straight lines in (start, q), sent back by integrating q |q|.
/// Curves of surfaces make this a path of curves in the space of their principal components, with the warp quotiented out,
/// not a geodesic of surfaces in the elastic metric of space.
#include <dsns/elastic/elastic_energy.hpp>

namespace dsns {

class CurveGeodesic {
 public:
  /// The second curve is taken along `warp`, the result of register_temporally(first, second).
  CurveGeodesic(const Curve& first, const Curve& second, const TimeWarp& warp)
      : grid_(time_grid()),
        start1_(first.start()),
        start2_(second.start()),
        q1_(warped_srvf(first, {}, grid_)),
        q2_(warped_srvf(second, warp, grid_)),
        energy_(elastic_energy(first, second, warp)) {}

  /// sqrt(|a1(0) - a2(0)|^2 + |q1 - q2 * zeta|^2): the first term in squared units of a, the second in units of a.
  double distance() const { return std::hypot(start_distance(), motion_distance()); }
  /// |a1(0) - a2(0)|.
  double start_distance() const { return (start1_ - start2_).norm(); }
  /// |q1 - q2 * zeta|.
  double motion_distance() const { return std::sqrt(energy_); }

  /// Points of the curve at fraction tau of the way, K x times().size(); tau = 0 is the first, 1 the second, registered.
  Eigen::MatrixXd points(double tau) const {
    return integrate_srvf((1 - tau) * start1_ + tau * start2_, (1 - tau) * q1_ + tau * q2_, grid_);
  }
  const Eigen::VectorXd& times() const { return grid_.times; }

 private:
  TimeGrid grid_;
  Eigen::VectorXd start1_, start2_;
  Eigen::MatrixXd q1_, q2_;
  double energy_;
};

/// Columns of values at equidistant times from 0 to 1, interpolated linearly at t.
inline Eigen::VectorXd interpolate(const Eigen::MatrixXd& values, double t) {
  const double u = std::clamp(t, 0.0, 1.0) * double(values.cols() - 1);
  const Index left = std::min(static_cast<Index>(u), values.cols() - 2);
  return values.col(left) + (u - double(left)) * (values.col(left + 1) - values.col(left));
}

}  // namespace dsns
