#pragma once
/// A closed mesh taken down to a tetrahedron by half-edge collapses that can be undone one by one, the faces carrying
/// their share of the surface all the way: the coarse-to-fine order of the spherical parameterization.
#include <dsns/mesh/collapsible_mesh.hpp>

#include <functional>
#include <queue>
#include <tuple>

namespace dsns::detail {

/// Chooses the collapses. Cost of v -> u: (quadric error of u in v's planes + 0.02 M_v |uv|^2) times a penalty on high
/// degrees, over the quality of the worst triangle it makes.
/// source   quadrics: Garland and Heckbert 1997, here one per frame and weighted by mass
class CollapsePlan {
 public:
  CollapsePlan(CollapsibleMesh& mesh, const ConcatenatedFrames& frames)
      : mesh_(mesh),
        frames_(frames),
        stamp_(static_cast<std::size_t>(mesh.vertex_slots()), 0),
        mark_(stamp_.size(), 0) {
    const Index blocks = frames.points.rows() / 3;
    quadrics_ = Eigen::MatrixXd::Zero(10 * blocks, mesh.vertex_slots());
    for (int f = 0; f < mesh.face_slots(); ++f)
      for (Index b = 0; b < blocks; ++b) add_plane(f, b);
  }

  /// Collapses until four vertices are left; a triangulated sphere always has an edge that may go.
  std::vector<CollapsibleMesh::Collapse> run() {
    int left = static_cast<int>(mesh_.vertex_slots());
    std::vector<CollapsibleMesh::Collapse> steps;
    steps.reserve(static_cast<std::size_t>(left));
    while (left > 4) {
      if (queue_.empty())  // at the start, and where distant collapses have made edges free again
        for (int v = 0; v < mesh_.vertex_slots(); ++v) push(v);
      require<UnusableMesh>(!queue_.empty(), "the mesh cannot be simplified to a tetrahedron: it is no sphere");
      const auto [cost, v, u, stamp] = queue_.top();
      queue_.pop();
      if (stamp != stamp_[static_cast<std::size_t>(v)]) continue;
      mark_ring(v);
      if (!mesh_.has_vertex(u) || !keeps_topology(u)) {
        push(v);
        continue;
      }
      const std::vector<int> ring = mesh_.ring(v);
      steps.push_back(mesh_.collapse(v, u));
      share_mass(steps.back());
      quadrics_.col(u) += quadrics_.col(v);
      ++stamp_[static_cast<std::size_t>(v)];
      for (const int w : ring) push(w);
      --left;
    }
    return steps;
  }

 private:
  static constexpr int max_degree = 16;  // of a vertex to remove; one of degree 5 or less is always removable

  // cost, vertex, target, stamp: ties fall to the smaller vertex, whatever the standard library
  using Candidate = std::tuple<double, int, int, int>;

  void add_plane(int f, Index block) {
    const auto at = [&](int k) { return Vec3d(frames_.points.block<3, 1>(3 * block, mesh_.vertex(f, k))); };
    const Vec3d normal = (at(1) - at(0)).cross(at(2) - at(0)).stableNormalized();
    if (!(normal.squaredNorm() > 0.5)) return;  // a face without area has no plane
    const Eigen::Vector4d plane(normal.x(), normal.y(), normal.z(), -normal.dot(at(0)));
    int slot = 0;
    for (int i = 0; i < 4; ++i)
      for (int j = i; j < 4; ++j, ++slot)
        for (int k = 0; k < 3; ++k)
          quadrics_(10 * block + slot, mesh_.vertex(f, k)) += (i == j ? 1 : 2) * mesh_.mass(f) * plane[i] * plane[j];
  }

  double quadric_error(int v, int u) const {
    double sum = 0;
    for (Index b = 0; 10 * b < quadrics_.rows(); ++b) {
      const auto q = quadrics_.block<10, 1>(10 * b, v);
      const Vec3d x = frames_.points.block<3, 1>(3 * b, u);
      sum += x[0] * (q[0] * x[0] + q[1] * x[1] + q[2] * x[2] + q[3]) + x[1] * (q[4] * x[1] + q[5] * x[2] + q[6]) +
             x[2] * (q[7] * x[2] + q[8]) + q[9];
    }
    return std::max(sum, 0.0);
  }

  double cost(int v, int u) const {
    double worst = 1, mass = 0;
    for (const int f : mesh_.star(v)) {
      mass += mesh_.mass(f);
      if (mesh_.contains(f, u)) continue;
      const SquaredLengths l = frames_.squared_lengths(u, mesh_.next(f, v), mesh_.previous(f, v));
      const double sum = l[0] + l[1] + l[2];
      worst = std::min(worst, sum > 0 ? 4 * std::sqrt(3.0) * area_from_lengths(l) / sum : 0);
    }
    const double excess = std::max(0, mesh_.degree(v) - 6), joint = std::max(0, mesh_.degree(v) + mesh_.degree(u) - 12);
    const double penalty = 1 + 0.15 * excess * excess + 0.3 * joint * joint;
    return (quadric_error(v, u) + 0.02 * mass * frames_.squared_distance(v, u)) * penalty / (0.02 + worst);
  }

  void mark_ring(int v) {
    ++token_;
    for (const int f : mesh_.star(v)) mark(mesh_.next(f, v)) = token_;
  }
  /// Link condition: u has two neighbours among the marked ring.
  bool keeps_topology(int u) {
    int common = 0;
    for (const int f : mesh_.star(u)) common += mark(mesh_.next(f, u)) == token_;
    return common == 2;
  }
  int& mark(int v) { return mark_[static_cast<std::size_t>(v)]; }

  /// Queues the cheapest collapse of v and outdates what was queued for it.
  void push(int v) {
    const int stamp = ++stamp_[static_cast<std::size_t>(v)];
    if (!mesh_.has_vertex(v) || mesh_.degree(v) > max_degree) return;
    mark_ring(v);
    double best_cost = 0;
    int best = -1;
    for (const int u : mesh_.ring(v)) {
      if (!keeps_topology(u)) continue;
      const double c = cost(v, u);
      if (best < 0 || c < best_cost) best = u, best_cost = c;
    }
    if (best >= 0) queue_.emplace(best_cost, v, best, stamp);
  }

  /// What the removed vertex's faces carried goes to those that stay: half by what they had, half by their new areas.
  void share_mass(const CollapsibleMesh::Collapse& step) {
    double total = 0, kept = 0, area = 0;
    std::vector<std::pair<int, double>> stay;
    for (std::size_t i = 0; i < step.star.size(); ++i) {
      const int f = step.star[i];
      total += step.masses[i];
      if (!mesh_.has_face(f)) continue;
      stay.emplace_back(
          f, area_from_lengths(frames_.squared_lengths(mesh_.vertex(f, 0), mesh_.vertex(f, 1), mesh_.vertex(f, 2))));
      kept += step.masses[i];
      area += stay.back().second;
    }
    for (const auto& [f, a] : stay) {
      const double by_area = area > 0 ? a / area : 1.0 / double(stay.size());
      mesh_.mass(f) = 0.5 * total * (mesh_.mass(f) / kept + by_area);
    }
  }

  CollapsibleMesh& mesh_;
  const ConcatenatedFrames& frames_;
  Eigen::MatrixXd quadrics_;  // per vertex and frame the upper triangle of the 4 x 4 form, off-diagonals doubled
  std::vector<int> stamp_, mark_;
  int token_ = 0;
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> queue_;
};

}  // namespace dsns::detail
