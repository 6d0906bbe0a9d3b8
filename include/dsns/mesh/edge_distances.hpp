#pragma once
/// Geodesic distances on a triangle mesh by shortest paths along its edges and across each edge between the opposite corners.
#include <dsns/mesh/editable_mesh.hpp>

#include <cmath>
#include <limits>
#include <queue>
#include <vector>

namespace dsns {

/// accuracy paths are on the surface, so distances are never too short; on an icosphere they are up to 4.6 % too long, 1.5 % in
///          the mean [mesh/edge_distances_test]
class EdgeDistances {
 public:
  explicit EdgeDistances(const TriangleMesh& mesh) : links_(std::size_t(mesh.vertices.cols())) {
    const detail::EditableMesh topology(mesh.faces, mesh.vertices.cols());
    for (const auto& [a, b] : topology.edges()) {
      const auto w = topology.wings(a, b);
      const auto at = [&](int v) -> Vec3d { return mesh.vertices.col(v); };
      link(a, b, (at(b) - at(a)).norm());
      if (w.left >= 0 && w.right >= 0) link(w.left, w.right, unfolded(at(a), at(b), at(w.left), at(w.right)));
    }
  }

  /// Distances from one vertex to all, in the mesh's unit; infinite where there is no way.
  Eigen::VectorXd from(Index source) const {
    Eigen::VectorXd distance = Eigen::VectorXd::Constant(Index(links_.size()), std::numeric_limits<double>::infinity());
    using Entry = std::pair<double, int>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
    distance[source] = 0;
    open.emplace(0.0, static_cast<int>(source));
    while (!open.empty()) {
      const auto [d, v] = open.top();
      open.pop();
      if (d > distance[v]) continue;
      for (const Link& l : links_[std::size_t(v)])
        if (d + l.length < distance[l.to]) open.emplace(distance[l.to] = d + l.length, l.to);
    }
    return distance;
  }

 private:
  struct Link {
    int to;
    double length;
  };
  void link(int a, int b, double length) {
    links_[std::size_t(a)].push_back({b, length});
    links_[std::size_t(b)].push_back({a, length});
  }

  /// From p to q over the edge a b, both faces laid flat; over one of its ends where the straight way misses the edge.
  static double unfolded(const Vec3d& a, const Vec3d& b, const Vec3d& p, const Vec3d& q) {
    const double length = (b - a).norm();
    if (!(length > 0)) return (p - a).norm() + (q - a).norm();
    const Vec3d e = (b - a) / length;
    const double pu = e.dot(p - a), qu = e.dot(q - a), pv = (p - a - pu * e).norm(), qv = (q - a - qu * e).norm();
    const double crossing = pv + qv > 0 ? (pu * qv + qu * pv) / (pv + qv) : pu;
    if (crossing >= 0 && crossing <= length) return std::hypot(pu - qu, pv + qv);
    const Vec3d& end = crossing < 0 ? a : b;
    return (p - end).norm() + (q - end).norm();
  }

  std::vector<std::vector<Link>> links_;
};

}  // namespace dsns
