#pragma once
/// What kind of surface a triangle soup is: pieces, holes, genus. Nothing here looks at positions.
#include <dsns/core/errors.hpp>
#include <dsns/core/types.hpp>

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

namespace dsns {

struct MeshDiagnosis {
  Index vertices = 0;  ///< that a face uses
  Index faces = 0;
  Index edges = 0;
  int components = 0;                  ///< pieces that hang together by shared edges
  int boundary_loops = 0;              ///< holes
  Index boundary_edges = 0;            ///< edges with one face
  Index nonmanifold_edges = 0;         ///< edges with three faces or more, or twice in one face
  Index nonmanifold_vertices = 0;      ///< vertices whose faces form more than one fan
  int euler_characteristic = 0;        ///< V - E + F; 2 for a sphere
  bool closed = false;                 ///< every edge has two faces
  bool consistently_oriented = false;  ///< the two faces of an edge run through it in opposite directions
  std::optional<int> genus;            ///< handles, where the surface is closed, oriented, of one piece and manifold
};

namespace detail {

/// Disjoint sets over 0..n-1 with path halving; the smallest member of a set represents it.
class DisjointSets {
 public:
  explicit DisjointSets(Index n) : parent_(static_cast<std::size_t>(n)) {
    std::iota(parent_.begin(), parent_.end(), Index{0});
  }
  Index find(Index i) {
    while (parent(i) != i) i = parent(i) = parent(parent(i));
    return i;
  }
  void unite(Index i, Index j) {
    i = find(i);
    j = find(j);
    parent(std::max(i, j)) = std::min(i, j);
  }

 private:
  Index& parent(Index i) { return parent_[static_cast<std::size_t>(i)]; }
  std::vector<Index> parent_;
};

/// One side of a face: from its corner k to corner k + 1. Sides of one undirected edge are equal in (low, high).
struct FaceSide {
  int low, high;
  Index face;
  int corner;
  bool forward;  ///< runs from low to high
};

inline bool same_edge(const FaceSide& a, const FaceSide& b) { return a.low == b.low && a.high == b.high; }

/// All 3m sides, sorted so that the sides of one edge are neighbours.
inline std::vector<FaceSide> sorted_sides(const Faces& faces) {
  std::vector<FaceSide> sides;
  sides.reserve(static_cast<std::size_t>(faces.size()));
  for (Index f = 0; f < faces.cols(); ++f)
    for (int k = 0; k < 3; ++k) {
      const int a = faces(k, f), b = faces((k + 1) % 3, f);
      sides.push_back({std::min(a, b), std::max(a, b), f, k, a < b});
    }
  std::sort(sides.begin(), sides.end(), [](const FaceSide& a, const FaceSide& b) {
    return std::tie(a.low, a.high, a.face, a.corner) < std::tie(b.low, b.high, b.face, b.corner);
  });
  return sides;
}

/// Calls visit(first, last) with the range of sides of every undirected edge.
template <class Visit>
void for_each_edge(const std::vector<FaceSide>& sides, const Visit& visit) {
  for (auto first = sides.begin(); first != sides.end();) {
    const auto last = std::find_if_not(first, sides.end(), [&](const FaceSide& s) { return same_edge(*first, s); });
    visit(first, last);
    first = last;
  }
}

/// Corner 3 f + k of the side's own face at one of the side's two vertices.
inline Index corner_at(const FaceSide& side, int vertex) {
  const int from = side.forward ? side.low : side.high;
  return 3 * side.face + (from == vertex ? side.corner : (side.corner + 1) % 3);
}

/// Corners joined around their vertex wherever their faces share an edge: a set is one fan of faces.
inline DisjointSets vertex_fans(const std::vector<FaceSide>& sides, Index face_count) {
  DisjointSets fans(3 * face_count);
  for_each_edge(sides, [&](auto first, auto last) {
    for (auto side = first + 1; side != last; ++side)
      for (const int end : {first->low, first->high}) fans.unite(corner_at(*first, end), corner_at(*side, end));
  });
  return fans;
}

/// Faces joined wherever they share an edge.
inline DisjointSets face_pieces(const std::vector<FaceSide>& sides, Index face_count) {
  DisjointSets pieces(face_count);
  for_each_edge(sides, [&](auto first, auto last) {
    for (auto side = first + 1; side != last; ++side) pieces.unite(first->face, side->face);
  });
  return pieces;
}

inline int count_boundary_loops(const std::vector<FaceSide>& sides, DisjointSets& fans, Index face_count) {
  DisjointSets loops(3 * face_count);
  std::vector<Index> ends;
  for_each_edge(sides, [&](auto first, auto last) {
    if (last - first != 1) return;
    ends.push_back(fans.find(corner_at(*first, first->low)));
    ends.push_back(fans.find(corner_at(*first, first->high)));
    loops.unite(ends[ends.size() - 2], ends.back());
  });
  for (Index& end : ends) end = loops.find(end);
  std::sort(ends.begin(), ends.end());
  return static_cast<int>(std::unique(ends.begin(), ends.end()) - ends.begin());
}

}  // namespace detail

/// Counts of a triangle mesh. Vertices that no face uses are not counted.
/// faces    3 x m, indices into vertex_count vertices
/// throws   InvalidArgument where a face names a vertex that does not exist
/// example  icosphere(2): 162 vertices, 480 edges, closed, genus 0 [mesh/diagnosis_test]
inline MeshDiagnosis diagnose(const Faces& faces, Index vertex_count) {
  for (Index f = 0; f < faces.cols(); ++f)
    for (int k = 0; k < 3; ++k)
      require(faces(k, f) >= 0 && faces(k, f) < vertex_count, "diagnose: face ", f, " names vertex ", faces(k, f),
              ", but there are ", vertex_count, " vertices: give indices from 0 to ", vertex_count - 1);
  MeshDiagnosis result;
  result.faces = faces.cols();
  result.consistently_oriented = true;
  const auto sides = detail::sorted_sides(faces);
  detail::for_each_edge(sides, [&](auto first, auto last) {
    ++result.edges;
    if (last - first == 1) ++result.boundary_edges;
    if (last - first > 2 || (last - first == 2 && first->face == (first + 1)->face)) ++result.nonmanifold_edges;
    if (last - first == 2 && first->forward == (first + 1)->forward) result.consistently_oriented = false;
  });
  result.closed = faces.cols() > 0 && result.boundary_edges == 0 && result.nonmanifold_edges == 0;

  auto pieces = detail::face_pieces(sides, faces.cols());
  for (Index f = 0; f < faces.cols(); ++f) result.components += pieces.find(f) == f ? 1 : 0;

  auto fans = detail::vertex_fans(sides, faces.cols());
  std::vector<int> fans_at(static_cast<std::size_t>(vertex_count), 0);
  for (Index c = 0; c < 3 * faces.cols(); ++c)
    if (fans.find(c) == c) ++fans_at[static_cast<std::size_t>(faces(c % 3, c / 3))];
  for (const int count : fans_at) {
    if (count > 0) ++result.vertices;
    if (count > 1) ++result.nonmanifold_vertices;
  }
  result.boundary_loops = detail::count_boundary_loops(sides, fans, faces.cols());
  result.euler_characteristic = static_cast<int>(result.vertices - result.edges + result.faces);
  if (result.closed && result.consistently_oriented && result.components == 1 && result.nonmanifold_vertices == 0)
    result.genus = (2 - result.euler_characteristic) / 2;
  return result;
}

}  // namespace dsns
