#pragma once
/// A group's registrations are free by a turn of all bodies, a map of all spheres and a warp of all clocks. Centring makes that
/// choice: the mean then stands, lies on its sphere and keeps time as its members do on average.
#include <dsns/core/errors.hpp>
#include <dsns/sphere/fit_diffeomorphism.hpp>
#include <dsns/sphere/sphere_map.hpp>

#include <vector>

namespace dsns {

/// The Karcher mean on SO(3); of rotations far apart, the one nearest to their sum.
/// accuracy the mean of turns about one axis is the turn by their mean angle [stats/group_registration_test]
inline Mat3 karcher_mean(const std::vector<Mat3>& rotations) {
  require(!rotations.empty(), "karcher_mean: no rotations, give at least one");
  Mat3 sum = Mat3::Zero();
  for (const Mat3& O : rotations) sum += O;
  Mat3 mean = nearest_rotation(sum);
  for (int step = 0; step < 50; ++step) {
    Vec3d tangent = Vec3d::Zero();
    for (const Mat3& O : rotations) tangent += rotation_log(mean.transpose() * O) / double(rotations.size());
    mean = mean * rotation_exp(tangent);
    if (tangent.norm() < 1e-13) break;
  }
  return mean;
}

struct GaugeOptions {
  int degree = 8;           ///< of the fields by which spheres are centred
  int steps = 5;            ///< at most
  double tolerance = 1e-5;  ///< radians: centred where the mean field is shorter in the root mean square
};

struct CentredMaps {
  std::vector<SphereDiffeomorphism> maps;
  double before = 0, after = 0;  ///< root mean square of the mean field, radians
};

/// The maps gamma_i o phi, phi such that the mean over i of the tangents from s towards Q_i^T gamma_i(phi(s)) has no part in the
/// fields of the degree asked for; Q_i is the turn of its sphere nearest to each map, of which no mean is taken.
/// accuracy maps that differ from centred ones by one of 5 degrees come back to 1e-4 radians [stats/group_registration_test]
inline CentredMaps centred(std::vector<SphereDiffeomorphism> maps, const GaugeOptions& options = {}) {
  require(!maps.empty(), "centred: no maps, give at least one");
  const SphereQuadrature q = sphere_quadrature(2 * options.degree + 4);
  const ChartBatch charts = charts_at(q.points);
  const auto mean_field = [&] {
    Eigen::Matrix2Xd mean = Eigen::Matrix2Xd::Zero(2, q.size());
    for (const SphereDiffeomorphism& gamma : maps) {
      const Mat3X y = gamma.displacement(charts).y;
      const Mat3 turn = nearest_rotation(y * q.weights.asDiagonal() * q.points.transpose());
      mean += detail::tangents_towards(charts, turn.transpose() * y) / double(maps.size());
    }
    return detail::least_squares_field(charts, mean, q.weights, options.degree, 0);
  };
  const auto size = [&](const SphereVectorField& v) {
    return angular_distance(displace(v, charts).y, q.points, q.weights).rms;
  };
  CentredMaps out;
  SphereVectorField v = mean_field();
  out.before = out.after = size(v);
  for (int step = 0; step < options.steps && out.after > options.tolerance; ++step) {
    SphereDiffeomorphism back;
    back.append(detail::safe_increment({v.degree, -v.a, -v.b}, {}));
    std::vector<SphereDiffeomorphism> next;
    for (const SphereDiffeomorphism& gamma : maps) next.push_back(compose(gamma, back));
    std::swap(maps, next);
    v = mean_field();
    const double left = size(v);
    if (left >= out.after) {
      std::swap(maps, next);
      break;
    }
    out.after = left;
  }
  out.maps = std::move(maps);
  return out;
}

}  // namespace dsns
