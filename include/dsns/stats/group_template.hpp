#pragma once
/// The member of a group from which its mean starts, and an order of the members of their own: whatever order they come in, the
/// same member is chosen and sums run over them alike, so that a mean does not depend on it, to the bit.
#include <dsns/core/errors.hpp>
#include <dsns/elastic/srnf.hpp>
#include <dsns/sphere/quadrature.hpp>
#include <dsns/surface/jets.hpp>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <numeric>
#include <vector>

namespace dsns {

/// What a moving surface measures at equidistant times, whatever its parametrisation and place: the area, the principal standard
/// deviations of its points, and the fourth root of the mean fourth power of their distance from the centroid.
template <AnimatedSurface F>
Eigen::VectorXd motion_descriptor(const F& surface, int times = 5) {
  require(times >= 1, "motion_descriptor: ", times, " times, give at least one");
  const SphereQuadrature q = sphere_quadrature(32);
  const ChartBatch charts = charts_at(q.points);
  Eigen::VectorXd out(5 * times);
  for (int k = 0; k < times; ++k) {
    const SurfaceTangents f = tangents(surface, charts, times > 1 ? double(k) / (times - 1) : 0.0);
    const Eigen::VectorXd areas = area_densities(f).cwiseProduct(q.weights);
    const double area = areas.sum();
    const Mat3X x = f.f.colwise() - Vec3d(f.f * areas / area);
    const Eigen::SelfAdjointEigenSolver<Mat3> spread(x * areas.asDiagonal() * x.transpose() / area,
                                                     Eigen::EigenvaluesOnly);
    out.segment<5>(5 * k) << std::sqrt(area), spread.eigenvalues().cwiseMax(0).cwiseSqrt(),
        std::pow(x.colwise().squaredNorm().array().square().matrix().dot(areas) / area, 0.25);
  }
  return out;
}

struct GroupTemplate {
  std::size_t member = 0;          ///< nearest to all others
  std::vector<std::size_t> order;  ///< all members, by their descriptors
};

/// The medoid: the member with the least sum of distances of descriptors.
/// accuracy the same member and the same order of members whatever order they are given in [stats/group_registration_test]
inline GroupTemplate choose_template(const std::vector<Eigen::VectorXd>& descriptors) {
  require(!descriptors.empty(), "choose_template: no members, give at least one");
  const std::size_t n = descriptors.size();
  const auto before = [&](std::size_t a, std::size_t b) {
    return std::lexicographical_compare(descriptors[a].begin(), descriptors[a].end(), descriptors[b].begin(),
                                        descriptors[b].end());
  };
  GroupTemplate chosen;
  chosen.order.resize(n);
  std::iota(chosen.order.begin(), chosen.order.end(), std::size_t(0));
  std::stable_sort(chosen.order.begin(), chosen.order.end(), before);
  double least = -1;
  for (const std::size_t i : chosen.order) {
    double sum = 0;
    for (const std::size_t j : chosen.order) sum += (descriptors[i] - descriptors[j]).norm();
    if (least >= 0 && sum >= least) continue;
    least = sum;
    chosen.member = i;
  }
  return chosen;
}

}  // namespace dsns
