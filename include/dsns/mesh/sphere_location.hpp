#pragma once
/// In which triangle of a triangulated sphere does a unit vector lie?
#include <dsns/mesh/sphere_certificate.hpp>

#include <algorithm>
#include <array>
#include <numeric>
#include <vector>

namespace dsns {

/// A point of a triangulated sphere: s = normalised(sum of barycentric[k] * vertex k of the face); values >= 0, sum 1.
struct SphereHit {
  Index face = 0;
  Vec3d barycentric = Vec3d::Zero();
};

/// Point location in a tree of bounding caps: O(log n) triangles a query where they are well shaped. Every unit vector
/// has a face; on edges and vertices one of the faces there. Queries are const and safe from several threads.
class SphereLocation {
 public:
  using Hit = SphereHit;

  /// sphere   3 x n unit vectors, faces a certified triangulation of the sphere
  /// throws   UnusableMesh where certify() says that it is not one to one
  SphereLocation(Mat3X sphere, Faces faces) : sphere_(std::move(sphere)), faces_(std::move(faces)) {
    const SphereMapCertificate certificate = certify(sphere_, faces_);
    require<UnusableMesh>(certificate.bijective(), "SphereLocation: the map is not one to one, ", certificate.flips,
                          " triangles are turned over and the area misses the sphere's by ", certificate.area_defect);
    order_.resize(static_cast<std::size_t>(faces_.cols()));
    std::iota(order_.begin(), order_.end(), 0);
    nodes_.reserve(order_.size());
    build(0, static_cast<int>(order_.size()));
  }

  const Mat3X& sphere() const { return sphere_; }
  const Faces& faces() const { return faces_; }

  /// accuracy  barycentrics 1e-14, against a search through all faces [mesh/sphere_location_test]
  /// throws    InvalidArgument unless s is a unit vector
  Hit operator()(const Vec3d& s) const {
    const double length = s.norm();
    require(std::abs(length - 1) < 1e-9, "SphereLocation: a query has length ", length, ", give unit vectors");
    Candidate best;
    std::array<int, 64> stack;  // the tree is balanced: its depth is that of 2^31 faces at most
    std::size_t waiting = 0;
    stack[waiting++] = 0;
    while (waiting > 0 && !(best.least >= 0)) {
      const Node& node = nodes_[static_cast<std::size_t>(stack[--waiting])];
      if (node.right == 0) {
        for (int k = node.first; k < node.last; ++k) improve(best, s, order_[static_cast<std::size_t>(k)]);
        continue;
      }
      const int left = static_cast<int>(&node - nodes_.data()) + 1;
      const Node &a = nodes_[static_cast<std::size_t>(left)], &b = nodes_[static_cast<std::size_t>(node.right)];
      const double depth_a = s.dot(a.axis) - length * a.cosine, depth_b = s.dot(b.axis) - length * b.cosine;
      const bool a_first = depth_a > depth_b;  // the more central cap is searched first, so it is pushed last
      if (std::min(depth_a, depth_b) >= 0) stack[waiting++] = a_first ? node.right : left;
      if (std::max(depth_a, depth_b) >= 0) stack[waiting++] = a_first ? left : node.right;
    }
    const Vec3d inside = best.weights.cwiseMax(0);  // a rounding below 0 on an edge
    return {best.face, inside / inside.sum()};
  }

  /// The hits of the n columns of s.
  std::vector<Hit> hits(const Mat3X& s) const {
    std::vector<Hit> out(static_cast<std::size_t>(s.cols()));
    for (Index i = 0; i < s.cols(); ++i) out[static_cast<std::size_t>(i)] = (*this)(Vec3d(s.col(i)));
    return out;
  }

 private:
  /// A cap around all vertices of its faces: not larger than a half sphere it holds their triangles too. Leaves have no
  /// right child; the left child is the next node.
  struct Node {
    Vec3d axis;
    double cosine;
    int first, last, right;
  };
  struct Candidate {
    Index face = 0;
    double least = -std::numeric_limits<double>::infinity();  // of the weights, relative to their sum
    Vec3d weights = Vec3d::Zero();
  };

  int build(int first, int last) {
    const int index = static_cast<int>(nodes_.size());
    nodes_.push_back(cap(first, last));
    if (last - first <= 4) return index;
    const auto begin = order_.begin();
    const int axis = longest_axis(first, last), middle = first + (last - first) / 2;
    std::nth_element(begin + first, begin + middle, begin + last, [&](int f, int g) {
      const double a = centre(f)[axis], b = centre(g)[axis];
      return a != b ? a < b : f < g;
    });
    build(first, middle);
    const int right = build(middle, last);
    nodes_[static_cast<std::size_t>(index)].right = right;
    return index;
  }

  Vec3d vertex(int f, int k) const { return sphere_.col(faces_(k, f)); }
  Vec3d centre(int f) const { return vertex(f, 0) + vertex(f, 1) + vertex(f, 2); }

  int longest_axis(int first, int last) const {
    Vec3d low = Vec3d::Constant(4), high = -low;
    for (int k = first; k < last; ++k) {
      const Vec3d c = centre(order_[static_cast<std::size_t>(k)]);
      low = low.cwiseMin(c);
      high = high.cwiseMax(c);
    }
    int axis = 0;
    (high - low).maxCoeff(&axis);
    return axis;
  }

  Node cap(int first, int last) const {
    Vec3d sum = Vec3d::Zero();
    for (int k = first; k < last; ++k) sum += centre(order_[static_cast<std::size_t>(k)]);
    Node node{sum.stableNormalized(), 1, first, last, 0};
    for (int k = first; k < last; ++k)
      for (int j = 0; j < 3; ++j)
        node.cosine = std::min(node.cosine, node.axis.dot(vertex(order_[static_cast<std::size_t>(k)], j).normalized()));
    node.cosine = node.cosine > 0 ? node.cosine - 1e-14 : -2;  // slack for rounding; beyond a half sphere no bound
    return node;
  }

  /// weights[k] = det(s, the other two): differences first, so that a query at a vertex gets exact zeros.
  void improve(Candidate& best, const Vec3d& s, int f) const {
    const Vec3d a = vertex(f, 0), b = vertex(f, 1), c = vertex(f, 2);
    const Vec3d weights((s - b).dot(b.cross(c - b)), (s - c).dot(c.cross(a - c)), (s - a).dot(a.cross(b - a)));
    const double sum = weights.sum();
    if (!(sum > 0) || !(weights.minCoeff() / sum > best.least)) return;
    best = {f, weights.minCoeff() / sum, weights};
  }

  Mat3X sphere_;
  Faces faces_;
  std::vector<int> order_;  // faces, those of a node contiguous
  std::vector<Node> nodes_;
};

}  // namespace dsns
