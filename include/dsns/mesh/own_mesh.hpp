#pragma once
/// Results back on the mesh that the user gave: all of its vertices, seams and loose pieces included.
///
///   const RepairResult repaired = repair(given);
///   const OwnMesh own(given, repaired);
///   const Mat3X vertices = own.moved(result);   // result: vertices of repaired.sequence, moved; as many as given has
#include <dsns/mesh/repair.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace dsns {

namespace detail {

/// Barycentric coordinates of the triangle's point nearest to p, in a space of any dimension.
/// source   Ericson 2005, section 5.1.5
template <class Vector>
Vec3d nearest_in_triangle(const Vector& p, const Vector& a, const Vector& b, const Vector& c) {
  const auto share = [](double x, double y) { return x + y > 0 ? x / (x + y) : 0.0; };
  const Vector ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const auto dot = [](const Vector& x, const Vector& y) { return double(x.dot(y)); };
  const double d1 = dot(ab, ap), d2 = dot(ac, ap), d3 = dot(ab, bp), d4 = dot(ac, bp), d5 = dot(ab, cp),
               d6 = dot(ac, cp);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    const double t = share(d1, -d3);
    return {1 - t, t, 0};
  }
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    const double t = share(d2, -d6);
    return {1 - t, 0, t};
  }
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double t = share(d4 - d3, d5 - d6);
    return {0, 1 - t, t};
  }
  const double sum = va + vb + vc;
  return {va / sum, vb / sum, vc / sum};
}

/// The axes of a triangle: along its first edge, across it, and its normal, times its size. Turns and grows with it.
inline Mat3 triangle_axes(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Vec3d normal = (b - a).cross(c - a);
  const double size = std::sqrt(normal.norm());
  Mat3 axes;
  axes.col(0) = (b - a).stableNormalized();
  axes.col(2) = normal.stableNormalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return size * axes;
}

}  // namespace detail

/// How each vertex given hangs on the repaired mesh. Vertices that the repair kept are vertices of it; others, such as
/// those of loose pieces, follow the nearest triangle of the first frame as if fixed to it.
class OwnMesh {
 public:
  OwnMesh() = default;

  /// throws   InvalidArgument unless `repaired` is the repair of `given`
  OwnMesh(const MeshSequence& given, const RepairResult& repaired)
      : faces_(repaired.sequence.faces), vertex_(repaired.repaired_vertex) {
    require(static_cast<Index>(vertex_.size()) == given.vertex_count(), "OwnMesh: the repair was of ", vertex_.size(),
            " vertices, the mesh has ", given.vertex_count());
    const Mat3X& ground = repaired.sequence.frames.front();
    for (std::size_t v = 0; v < vertex_.size(); ++v)
      if (vertex_[v] < 0) hang(static_cast<Index>(v), given.frames.front().col(static_cast<Index>(v)), ground);
  }

  /// Vertices given, 3 x n.
  Index vertex_count() const { return static_cast<Index>(vertex_.size()); }
  /// The vertex of the repaired mesh that a given one became; -1 where it was dropped.
  /// throws   InvalidArgument where there is no such vertex
  Index repaired_vertex(Index given) const {
    require(given >= 0 && given < vertex_count(), "OwnMesh: there is no vertex ", given, ", only ", vertex_count(),
            " of them");
    return vertex_[std::size_t(given)];
  }

  /// The given mesh's vertices for moved vertices of the repaired one, 3 x n.
  /// throws   InvalidArgument for another number of them
  Mat3X moved(const Mat3X& repaired) const {
    require(faces_.size() == 0 || faces_.maxCoeff() < repaired.cols(), "OwnMesh: ", repaired.cols(),
            " vertices, the repaired mesh has more");
    Mat3X out(3, vertex_count());
    for (Index v = 0; v < out.cols(); ++v)
      if (vertex_[std::size_t(v)] >= 0) out.col(v) = repaired.col(vertex_[std::size_t(v)]);
    for (const Hanging& h : hanging_) {
      const Vec3d a = repaired.col(faces_(0, h.face)), b = repaired.col(faces_(1, h.face)),
                  c = repaired.col(faces_(2, h.face));
      out.col(h.vertex) = h.barycentric[0] * a + h.barycentric[1] * b + h.barycentric[2] * c +
                          detail::triangle_axes(a, b, c) * h.offset;
    }
    return out;
  }

 private:
  struct Hanging {
    Index vertex, face;
    Vec3d barycentric, offset;  // the offset along the triangle's axes
  };

  void hang(Index vertex, const Vec3d& p, const Mat3X& ground) {
    Hanging best{vertex, 0, Vec3d(1, 0, 0), Vec3d::Zero()};
    double least = std::numeric_limits<double>::infinity();
    for (Index f = 0; f < faces_.cols(); ++f) {
      const Vec3d a = ground.col(faces_(0, f)), b = ground.col(faces_(1, f)), c = ground.col(faces_(2, f));
      const Mat3 axes = detail::triangle_axes(a, b, c);
      const double size = axes.col(2).norm();
      if (!(size > 0)) continue;
      const Vec3d weights = detail::nearest_in_triangle(p, a, b, c);
      const Vec3d offset = p - (weights[0] * a + weights[1] * b + weights[2] * c);
      if (!(offset.squaredNorm() < least)) continue;
      least = offset.squaredNorm();
      best.face = f;
      best.barycentric = weights;
      best.offset = axes.transpose() * offset / (size * size);
    }
    hanging_.push_back(best);
  }

  Faces faces_;
  std::vector<Index> vertex_;  // of the repaired mesh, by vertex given; -1: hanging
  std::vector<Hanging> hanging_;
};

}  // namespace dsns
