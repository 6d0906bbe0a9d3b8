#pragma once
/// The same polyhedral surface cut into better triangles: intrinsic Delaunay flips. Edges become straight lines across several
/// of the old faces, vertices and metric stay, and the cotangent Laplacian has no negative weight whatever the mesh was.
#include <dsns/core/errors.hpp>
#include <dsns/core/types.hpp>

#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

namespace dsns {

/// Triangles with the length of the edge opposite to each corner; both 3 x m. Two corners of a triangle may be one vertex.
struct IntrinsicTriangulation {
  Faces faces;
  Mat3X lengths;
};

namespace detail {

/// Cotangent of the angle opposite to length a; lengths that no triangle has count as those of a needle.
inline double opposite_cotangent(double a, double b, double c) {
  const double a2 = a * a, b2 = b * b, c2 = c * c, smallest = 1e-12 * (a2 + b2 + c2);
  const double sixteen_squares = 4 * a2 * b2 - (a2 + b2 - c2) * (a2 + b2 - c2);
  return (b2 + c2 - a2) / std::sqrt(std::max(sixteen_squares, smallest * smallest));
}

class DelaunayFlips {
 public:
  explicit DelaunayFlips(IntrinsicTriangulation t) : t_(std::move(t)), twin_(3, t_.faces.cols()) {
    std::map<std::pair<int, int>, HalfEdge> open;
    for (int f = 0; f < t_.faces.cols(); ++f)
      for (int k = 0; k < 3; ++k) {
        const int from = t_.faces((k + 1) % 3, f), to = t_.faces((k + 2) % 3, f);
        const auto other = open.find({to, from});
        if (other == open.end()) {
          const bool added = open.try_emplace({from, to}, 3 * f + k).second;
          require(added, "intrinsic_delaunay: two faces have the directed edge ", from, " ", to);
          continue;
        }
        glue(3 * f + k, other->second);
        open.erase(other);
      }
    require(open.empty(), "intrinsic_delaunay: the mesh is open, give a closed one");
  }

  IntrinsicTriangulation run() {
    std::vector<HalfEdge> waiting;
    for (HalfEdge h = 0; h < 3 * static_cast<int>(t_.faces.cols()); ++h)
      if (h < twin(h)) waiting.push_back(h);
    // Flips end by themselves in exact arithmetic; rounding on degenerate triangles could repeat some for ever.
    for (Index left = 100 * t_.faces.cols(); left > 0 && !waiting.empty(); --left) {
      const HalfEdge h = waiting.back();
      waiting.pop_back();
      if (face(h) == face(twin(h)) || cotangent(h) + cotangent(twin(h)) >= -1e-9) continue;
      for (const HalfEdge around : flip(h)) waiting.push_back(around);
    }
    return std::move(t_);
  }

 private:
  using HalfEdge = int;  // 3 face + corner, opposite to the corner

  static int face(HalfEdge h) { return h / 3; }
  HalfEdge twin(HalfEdge h) const { return twin_(h % 3, face(h)); }
  void glue(HalfEdge a, HalfEdge b) {
    twin_(a % 3, face(a)) = b;
    twin_(b % 3, face(b)) = a;
  }
  int vertex(HalfEdge h, int turn) const { return t_.faces((h + turn) % 3, face(h)); }
  double length(HalfEdge h, int turn) const { return t_.lengths((h % 3 + turn) % 3, face(h)); }
  double cotangent(HalfEdge h) const { return opposite_cotangent(length(h, 0), length(h, 1), length(h, 2)); }

  /// Faces (a, b, c) and (d, c, b) around the edge bc become (a, b, d) and (a, d, c). Returns the four edges around.
  std::array<HalfEdge, 4> flip(HalfEdge h) {
    const HalfEdge g = twin(h);
    const int a = vertex(h, 3), b = vertex(h, 1), c = vertex(h, 2), d = vertex(g, 3), f1 = face(h), f2 = face(g);
    const double bc = length(h, 0), ac = length(h, 1), ab = length(h, 2), db = length(g, 1), dc = length(g, 2);
    const auto along = [&](double to_b, double to_c) { return (to_b * to_b + bc * bc - to_c * to_c) / (2 * bc); };
    const auto height = [](double side, double x) { return std::sqrt(std::max(0.0, side * side - x * x)); };
    const double xa = along(ab, ac), xd = along(db, dc);
    const double ad = std::hypot(xa - xd, height(ab, xa) + height(db, xd));

    const auto beside = [](HalfEdge e, int turn) { return 3 * face(e) + (e + turn) % 3; };
    const std::array<HalfEdge, 4> before{beside(h, 2), beside(h, 1), beside(g, 1), beside(g, 2)},  // ab, ac, db, dc
        after{3 * f1 + 2, 3 * f2 + 1, 3 * f1, 3 * f2};
    std::array<HalfEdge, 4> outside{};
    for (std::size_t i = 0; i < 4; ++i) {
      outside[i] = twin(before[i]);
      for (std::size_t j = 0; j < 4; ++j)  // two of the four may be glued to each other
        if (outside[i] == before[j]) {
          outside[i] = after[j];
          break;
        }
    }
    t_.faces.col(f1) << a, b, d;
    t_.faces.col(f2) << a, d, c;
    t_.lengths.col(f1) << db, ad, ab;
    t_.lengths.col(f2) << dc, ac, ad;
    glue(3 * f1 + 1, 3 * f2 + 2);
    for (std::size_t i = 0; i < 4; ++i) glue(after[i], outside[i]);
    return after;
  }

  IntrinsicTriangulation t_;
  Eigen::Matrix<int, 3, Eigen::Dynamic> twin_;
};

}  // namespace detail

/// Flips edges until the angles opposite to each add up to at most pi.
/// accuracy total area and vertices unchanged to 1e-12, no negative weight [matching/intrinsic_delaunay_test]
/// source   Bobenko and Springborn 2007; Fisher et al. 2007
inline IntrinsicTriangulation intrinsic_delaunay(IntrinsicTriangulation triangulation) {
  return detail::DelaunayFlips(std::move(triangulation)).run();
}

}  // namespace dsns
