#pragma once
/// A closed mesh with other triangles: all edges near one length, corners near 60 degrees. Every new vertex knows its place on
/// the given mesh, so whatever is known there, other frames of a motion among it, carries over.
///
///   const Remeshing r = isotropic_remesh(mesh);
///   const MeshSequence other = remeshed(sequence, r);        // the same motion on the new triangles
///
/// source   Botsch and Kobbelt 2004: split, collapse, flip, smooth along the surface, again and again
#include <dsns/mesh/editable_mesh.hpp>
#include <dsns/mesh/sphere_topology.hpp>
#include <dsns/mesh/surface_walk.hpp>

#include <numeric>
#include <queue>

namespace dsns {

struct RemeshOptions {
  Index vertices = 0;  ///< about so many; 0: as the mesh has
  int rounds = 6;
};

struct Remeshing {
  TriangleMesh mesh;
  std::vector<SurfacePoint> places;  ///< of its vertices on the given mesh
};

namespace detail {

class Remesher {
 public:
  Remesher(const TriangleMesh& given, double length)
      : walk_(given), mesh_(given.faces, given.vertices.cols()), length_(length) {
    for (Index v = 0; v < given.vertices.cols(); ++v) {
      const Index f = walk_.faces_around(v).front();
      Vec3d corner = Vec3d::Zero();
      for (int k = 0; k < 3; ++k) corner[k] = given.faces(k, f) == v ? 1 : 0;
      places_.push_back({f, corner});
      x_.push_back(given.vertices.col(v));
    }
  }

  void round() {
    split_long();
    collapse_short();
    even_valences();
    smooth();
  }

  Remeshing result() const {
    std::vector<int> number(x_.size(), -1);
    Remeshing out;
    for (int v = 0; v < mesh_.vertex_count(); ++v)
      if (mesh_.alive(v)) {
        number[std::size_t(v)] = static_cast<int>(out.places.size());
        out.places.push_back(places_[std::size_t(v)]);
      }
    std::vector<Eigen::Vector3i> faces;
    for (int v = 0; v < mesh_.vertex_count(); ++v)
      for (const int f : mesh_.faces_around(v))
        if (const auto& t = mesh_.face(f); v == std::min({t[0], t[1], t[2]}))
          faces.emplace_back(number[std::size_t(t[0])], number[std::size_t(t[1])], number[std::size_t(t[2])]);
    out.mesh.faces.resize(3, Index(faces.size()));
    for (std::size_t f = 0; f < faces.size(); ++f) out.mesh.faces.col(Index(f)) = faces[f];
    out.mesh.vertices.resize(3, Index(out.places.size()));
    for (std::size_t v = 0; v < out.places.size(); ++v) out.mesh.vertices.col(Index(v)) = walk_.position(out.places[v]);
    return out;
  }

 private:
  const Vec3d& at(int v) const { return x_[std::size_t(v)]; }
  double distance(int a, int b) const { return (at(a) - at(b)).norm(); }
  static Vec3d normal(const Vec3d& a, const Vec3d& b, const Vec3d& c) { return (b - a).cross(c - a); }
  Vec3d normal(const EditableMesh::Triangle& t) const { return normal(at(t[0]), at(t[1]), at(t[2])); }

  /// Whether a vertex at x keeps every face around `v` upright, those that also hold `without` left aside.
  bool upright(int v, const Vec3d& x, int without = -1) const {
    constexpr double least_cosine = 0.2;
    for (const int f : mesh_.faces_around(v)) {
      const auto& t = mesh_.face(f);
      if (t[0] == without || t[1] == without || t[2] == without) continue;
      const auto corner = [&](std::size_t k) { return t[k] == v ? x : at(t[k]); };
      const Vec3d before = normal(t), after = normal(corner(0), corner(1), corner(2));
      if (!(after.dot(before) > least_cosine * after.norm() * before.norm())) return false;
    }
    return true;
  }

  /// The longest first: in another order needles are cut into more and more needles.
  void split_long() {
    using Entry = std::pair<double, std::pair<int, int>>;
    std::priority_queue<Entry> open;
    for (const auto& edge : mesh_.edges()) open.push({distance(edge.first, edge.second), edge});
    while (!open.empty() && open.top().first > 4.0 / 3 * length_) {
      const auto [length, edge] = open.top();
      const auto [a, b] = edge;
      open.pop();
      if (!mesh_.joined(a, b)) continue;
      // The middle of a chord over a dent may lead back to an end; halves must be shorter than the whole.
      const Vec3d middle = (at(a) + at(b)) / 2;
      const SurfacePoint one = walk_.nearest(middle, places_[std::size_t(a)]),
                         two = walk_.nearest(middle, places_[std::size_t(b)]);
      const Vec3d x1 = walk_.position(one), x2 = walk_.position(two);
      const bool first = (x1 - middle).norm() <= (x2 - middle).norm();
      const Vec3d x = first ? x1 : x2;
      if (std::max((x - at(a)).norm(), (x - at(b)).norm()) > 0.7 * length) continue;
      const int m = mesh_.split(a, b);
      x_.push_back(x);
      places_.push_back(first ? one : two);
      for (const int v : mesh_.neighbours(m))
        if (const double d = distance(m, v); d < 0.95 * length) open.push({d, {m, v}});
    }
  }

  /// The shortest first, until no short edge can go.
  void collapse_short() {
    for (bool any = true; any;) {
      any = false;
      std::vector<std::pair<double, std::pair<int, int>>> shorts;
      for (const auto& [a, b] : mesh_.edges())
        if (const double d = distance(a, b); d < 0.8 * length_) shorts.push_back({d, {a, b}});
      std::sort(shorts.begin(), shorts.end());
      for (const auto& [d, edge] : shorts) any = collapsed(edge.first, edge.second) || any;
    }
  }
  bool collapsed(int a, int b) {
    if (!mesh_.alive(a) || !mesh_.alive(b) || !mesh_.joined(a, b) || distance(a, b) >= 0.8 * length_) return false;
    for (const auto& [gone, kept] : {std::pair(a, b), std::pair(b, a)}) {
      const auto ring = mesh_.neighbours(gone);
      const bool stretches =
          std::any_of(ring.begin(), ring.end(), [&, k = kept](int v) { return distance(k, v) > 4.0 / 3 * length_; });
      if (stretches || !mesh_.can_collapse(gone, kept) || !upright(gone, at(kept), kept)) continue;
      mesh_.collapse(gone, kept);
      return true;
    }
    return false;
  }

  void even_valences() {
    const auto off = [&](int v, int change) { return std::pow(mesh_.valence(v) + change - 6, 2); };
    for (const auto& [a, b] : mesh_.edges()) {
      if (!mesh_.joined(a, b) || !mesh_.can_flip(a, b)) continue;
      const auto w = mesh_.wings(a, b);
      if (off(a, -1) + off(b, -1) + off(w.left, 1) + off(w.right, 1) >=
          off(a, 0) + off(b, 0) + off(w.left, 0) + off(w.right, 0))
        continue;
      const Vec3d before = normal(mesh_.face(w.left_face)) + normal(mesh_.face(w.right_face));
      const Vec3d one = normal(at(a), at(w.right), at(w.left)), two = normal(at(b), at(w.left), at(w.right));
      constexpr double least_cosine = 0.5;
      if (one.dot(before) > least_cosine * one.norm() * before.norm() &&
          two.dot(before) > least_cosine * two.norm() * before.norm())
        mesh_.flip(a, b);
    }
  }

  void smooth() {
    for (int v = 0; v < mesh_.vertex_count(); ++v) {
      if (!mesh_.alive(v)) continue;
      Vec3d mean = Vec3d::Zero(), n = Vec3d::Zero();
      for (const int u : mesh_.neighbours(v)) mean += at(u) / mesh_.valence(v);
      for (const int f : mesh_.faces_around(v)) n += normal(mesh_.face(f));
      n.stableNormalize();
      const Vec3d to = mean + n * n.dot(at(v) - mean);
      const SurfacePoint place = walk_.nearest(to, places_[std::size_t(v)]);
      const Vec3d x = walk_.position(place);
      if (!upright(v, x)) continue;
      places_[std::size_t(v)] = place;
      x_[std::size_t(v)] = x;
    }
  }

  SurfaceWalk walk_;
  EditableMesh mesh_;
  double length_;
  std::vector<Vec3d> x_;
  std::vector<SurfacePoint> places_;
};

}  // namespace detail

/// returns  a closed genus-0 mesh whose vertices lie on the given one
/// accuracy 95 % of the edges within a factor of 1.8, numbers of vertices to 10 %, on an ellipsoid of bad triangles and on limbs
///          [mesh/isotropic_remesh_test]
/// throws   UnusableMesh unless the mesh is one closed surface of genus 0 with area
inline Remeshing isotropic_remesh(const TriangleMesh& mesh, const RemeshOptions& options = {}) {
  require_sphere_topology(mesh.faces, mesh.vertices.cols());
  require(options.vertices == 0 || options.vertices >= 12, "isotropic_remesh: ", options.vertices,
          " vertices, give at least 12");
  const double total = area(mesh), wanted = double(options.vertices > 0 ? options.vertices : mesh.vertices.cols());
  require<UnusableMesh>(total > 0 && std::isfinite(total), "isotropic_remesh: the mesh has an area of ", total,
                        ", it must be positive");
  // n vertices have 2 n equilateral faces of sqrt(3) / 4 length^2; splits and collapses settle somewhat below that length.
  detail::Remesher remesher(mesh, 1.08 * std::sqrt(2 * total / (std::sqrt(3.0) * wanted)));
  for (int round = 0; round < options.rounds; ++round) remesher.round();
  return remesher.result();
}

/// The motion of the given mesh on the new triangles. Those with all corners on faces that close holes close holes.
inline MeshSequence remeshed(const MeshSequence& sequence, const Remeshing& remeshing) {
  MeshSequence out;
  out.duration = sequence.duration;
  out.name = sequence.name;
  const Index first_cap = sequence.faces.cols() - sequence.cap_faces;
  std::vector<Index> order(std::size_t(remeshing.mesh.faces.cols()));
  std::iota(order.begin(), order.end(), 0);
  const auto caps = std::stable_partition(order.begin(), order.end(), [&](Index f) {
    return (remeshing.mesh.faces.col(f).array().unaryExpr(
                [&](int v) { return remeshing.places[std::size_t(v)].face < first_cap ? 1 : 0; }))
        .any();
  });
  out.faces = remeshing.mesh.faces(Eigen::all, order);
  out.cap_faces = order.end() - caps;
  for (const Mat3X& frame : sequence.frames) {
    Mat3X x(3, Index(remeshing.places.size()));
    for (Index v = 0; v < x.cols(); ++v) x.col(v) = position(frame, sequence.faces, remeshing.places[std::size_t(v)]);
    out.frames.push_back(std::move(x));
  }
  return out;
}

}  // namespace dsns
