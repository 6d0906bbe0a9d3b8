#pragma once
/// A closed triangle mesh whose edges can be split, collapsed and flipped; it stays a closed manifold of its genus throughout.
#include <dsns/mesh/triangle_mesh.hpp>

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

namespace dsns::detail {

/// Vertices and faces keep their numbers; a vertex that is gone has no faces. Positions are the caller's.
class EditableMesh {
 public:
  using Triangle = std::array<int, 3>;

  EditableMesh(const Faces& faces, Index vertices) : around_(std::size_t(vertices)) {
    for (Index f = 0; f < faces.cols(); ++f) add({faces(0, f), faces(1, f), faces(2, f)});
  }

  int vertex_count() const { return static_cast<int>(around_.size()); }
  bool alive(int v) const { return !around_[std::size_t(v)].empty(); }
  const std::vector<int>& faces_around(int v) const { return around_[std::size_t(v)]; }
  const Triangle& face(int f) const { return faces_[std::size_t(f)]; }
  /// On a closed mesh a vertex has as many neighbours as faces.
  int valence(int v) const { return static_cast<int>(faces_around(v).size()); }

  std::vector<int> neighbours(int v) const {
    std::vector<int> out;
    for (const int f : faces_around(v)) out.push_back(after(f, v));
    return out;
  }
  bool joined(int a, int b) const {
    return std::any_of(faces_around(a).begin(), faces_around(a).end(), [&](int f) { return holds(f, b); });
  }

  /// The corners opposite to the edge: left of a to b, and right.
  struct Wings {
    int left_face, right_face, left, right;
  };
  Wings wings(int a, int b) const {
    Wings w{-1, -1, -1, -1};
    for (const int f : faces_around(a)) {
      if (after(f, a) == b) w.left_face = f, w.left = after(f, b);
      if (after(f, b) == a) w.right_face = f, w.right = after(f, a);
    }
    return w;
  }

  /// A new vertex in the middle of an edge; returns its number.
  int split(int a, int b) {
    const Wings w = wings(a, b);
    const int m = vertex_count();
    around_.emplace_back();
    remove(w.left_face);
    remove(w.right_face);
    add({a, m, w.left});
    add({m, b, w.left});
    add({b, m, w.right});
    add({m, a, w.right});
    return m;
  }

  /// Whether joining both ends leaves a manifold: only the wings are neighbours of both, and no vertex falls below three faces.
  bool can_collapse(int a, int b) const {
    int common = 0;
    for (const int v : neighbours(a)) common += v != b && joined(b, v) ? 1 : 0;
    const Wings w = wings(a, b);
    return common == 2 && valence(w.left) > 3 && valence(w.right) > 3 && valence(a) + valence(b) > 7;
  }
  /// Puts b in place of a.
  void collapse(int a, int b) {
    const std::vector<int> old = faces_around(a);
    for (const int f : old) {
      Triangle t = face(f);
      remove(f);
      if (t[0] == b || t[1] == b || t[2] == b) continue;
      std::replace(t.begin(), t.end(), a, b);
      add(t);
    }
  }

  bool can_flip(int a, int b) const {
    const Wings w = wings(a, b);
    return valence(a) > 3 && valence(b) > 3 && !joined(w.left, w.right);
  }
  /// The edge a to b becomes the one between its wings.
  void flip(int a, int b) {
    const Wings w = wings(a, b);
    remove(w.left_face);
    remove(w.right_face);
    add({a, w.right, w.left});
    add({b, w.left, w.right});
  }

  /// Every edge once, ends in rising order.
  std::vector<std::pair<int, int>> edges() const {
    std::vector<std::pair<int, int>> out;
    for (int v = 0; v < vertex_count(); ++v)
      for (const int u : neighbours(v))
        if (v < u) out.emplace_back(v, u);
    return out;
  }

 private:
  bool holds(int f, int v) const {
    const Triangle& t = face(f);
    return t[0] == v || t[1] == v || t[2] == v;
  }
  /// The corner after v.
  int after(int f, int v) const {
    const Triangle& t = face(f);
    return t[0] == v ? t[1] : t[1] == v ? t[2] : t[2] == v ? t[0] : -1;
  }
  void add(const Triangle& t) {
    const int f = static_cast<int>(faces_.size());
    faces_.push_back(t);
    for (const int v : t) around_[std::size_t(v)].push_back(f);
  }
  void remove(int f) {
    for (const int v : face(f)) std::erase(around_[std::size_t(v)], f);
  }

  std::vector<Triangle> faces_;
  std::vector<std::vector<int>> around_;
};

}  // namespace dsns::detail
