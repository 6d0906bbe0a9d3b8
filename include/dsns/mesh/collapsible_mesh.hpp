#pragma once
/// A closed mesh whose vertices can be removed one by one and put back in reverse.
#include <dsns/mesh/triangle_mesh.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace dsns::detail {

/// Squared lengths of the edges opposite the three corners.
using SquaredLengths = std::array<double, 3>;

/// Area of a triangle from its edges (Heron); 0 where rounding makes them impossible.
inline double area_from_lengths(const SquaredLengths& l) {
  const double sixteen = 2 * (l[0] * l[1] + l[1] * l[2] + l[2] * l[0]) - l[0] * l[0] - l[1] * l[1] - l[2] * l[2];
  return std::sqrt(std::max(sixteen, 0.0)) / 4;
}

/// Vertices in R^d, d = 3 x frames: lengths and areas of the concatenated frames, so that no frame is squeezed.
struct ConcatenatedFrames {
  Eigen::MatrixXd points;  // d x n

  double squared_distance(int i, int j) const { return (points.col(i) - points.col(j)).squaredNorm(); }
  SquaredLengths squared_lengths(int i, int j, int k) const {
    return {squared_distance(j, k), squared_distance(k, i), squared_distance(i, j)};
  }
};

/// Triangulation with removable vertices. Faces and vertices keep their numbers throughout.
class CollapsibleMesh {
 public:
  CollapsibleMesh(const Faces& faces, Index vertex_count, Eigen::VectorXd masses)
      : faces_(faces),
        masses_(std::move(masses)),
        alive_(static_cast<std::size_t>(faces.cols()), 1),
        stars_(static_cast<std::size_t>(vertex_count)) {
    for (Index f = 0; f < faces.cols(); ++f)
      for (int k = 0; k < 3; ++k) star_of(faces(k, f)).push_back(static_cast<int>(f));
  }

  Index vertex_slots() const { return static_cast<Index>(stars_.size()); }
  Index face_slots() const { return faces_.cols(); }
  bool has_face(int f) const { return alive_[static_cast<std::size_t>(f)] != 0; }
  bool has_vertex(int v) const { return !star(v).empty(); }
  int degree(int v) const { return static_cast<int>(star(v).size()); }
  double mass(int f) const { return masses_[f]; }
  double& mass(int f) { return masses_[f]; }
  /// Faces at a vertex, in no order.
  const std::vector<int>& star(int v) const { return stars_[static_cast<std::size_t>(v)]; }
  int vertex(int f, int corner) const { return faces_(corner, f); }
  int corner(int f, int v) const { return faces_(0, f) == v ? 0 : faces_(1, f) == v ? 1 : 2; }
  bool contains(int f, int v) const { return faces_(0, f) == v || faces_(1, f) == v || faces_(2, f) == v; }
  /// The vertices after v and before it in a face.
  int next(int f, int v) const { return faces_((corner(f, v) + 1) % 3, f); }
  int previous(int f, int v) const { return faces_((corner(f, v) + 2) % 3, f); }
  /// Neighbours of a vertex, each once.
  std::vector<int> ring(int v) const {
    std::vector<int> neighbours;
    neighbours.reserve(star(v).size());
    for (const int f : star(v)) neighbours.push_back(next(f, v));
    return neighbours;
  }

  /// One undoable step: `vertex` moved onto `target`.
  struct Collapse {
    int vertex, target;
    std::vector<int> star;       // faces at `vertex` before
    std::vector<double> masses;  // and what they carried
  };

  /// Moves v onto u: the two faces between them go, the others at v become faces of u.
  Collapse collapse(int v, int u) {
    Collapse step{v, u, star(v), {}};
    for (const int f : step.star) {
      step.masses.push_back(mass(f));
      if (contains(f, u)) {
        alive_[static_cast<std::size_t>(f)] = 0;
        for (int k = 0; k < 3; ++k)
          if (faces_(k, f) != v) drop(faces_(k, f), f);
      } else {
        faces_(corner(f, v), f) = u;
        star_of(u).push_back(f);
      }
    }
    star_of(v).clear();
    return step;
  }

  /// Undoes the last collapse that has not been undone.
  void undo(const Collapse& step) {
    for (std::size_t i = 0; i < step.star.size(); ++i) {
      const int f = step.star[i];
      mass(f) = step.masses[i];
      if (has_face(f)) {
        faces_(corner(f, step.target), f) = step.vertex;
        drop(step.target, f);
        continue;
      }
      alive_[static_cast<std::size_t>(f)] = 1;
      for (int k = 0; k < 3; ++k)
        if (faces_(k, f) != step.vertex) star_of(faces_(k, f)).push_back(f);
    }
    star_of(step.vertex) = step.star;
  }

 private:
  std::vector<int>& star_of(int v) { return stars_[static_cast<std::size_t>(v)]; }
  void drop(int v, int f) {
    std::vector<int>& at = star_of(v);
    at.erase(std::find(at.begin(), at.end(), f));
  }

  Faces faces_;
  Eigen::VectorXd masses_;
  std::vector<char> alive_;
  std::vector<std::vector<int>> stars_;
};

}  // namespace dsns::detail
