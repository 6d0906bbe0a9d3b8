#pragma once
/// How much of a triangle mesh's area is folded or has collapsed. Averages and extrapolations of surfaces that do not correspond
/// everywhere are torn there: neighbouring triangles lie on one another, or have shrunk to nothing. A limb that swings is neither.
#include <dsns/mesh/diagnosis.hpp>
#include <dsns/mesh/triangle_mesh.hpp>

#include <cmath>
#include <utility>
#include <vector>

namespace dsns {

struct FoldOptions {
  double cosine =
      -0.5;  ///< two triangles fold where that of their normals is less: their sides meet at under 60 degrees
  double collapsed =
      0.01;  ///< a triangle has collapsed that keeps less than this share of its area, that of the whole being equal
};

/// Shares of the area of meshes that have these triangles. Neither changes with the place, the turn or the size of a mesh.
/// accuracy closed forms of a hinge and of a fan [mesh/folds_test]
class FoldedShare {
 public:
  explicit FoldedShare(Faces faces, const FoldOptions& options = {}) : faces_(std::move(faces)), options_(options) {
    const auto sides = detail::sorted_sides(faces_);
    detail::for_each_edge(sides, [&](auto first, auto last) {
      if (last - first == 2) neighbours_.emplace_back(first->face, (first + 1)->face);
    });
  }

  const Faces& faces() const { return faces_; }

  /// Of the mesh's area, that of triangles which fold with a neighbour.
  double folded(const Mat3X& vertices) const {
    const Mat3X normals = face_normals(vertices, faces_);
    const Eigen::VectorXd areas = normals.colwise().norm();
    std::vector<char> folds(std::size_t(faces_.cols()), 0);
    for (const auto& [f, g] : neighbours_)
      if (normals.col(f).dot(normals.col(g)) < options_.cosine * areas[f] * areas[g])
        folds[std::size_t(f)] = folds[std::size_t(g)] = 1;
    double sum = 0;
    for (Index f = 0; f < areas.size(); ++f) sum += folds[std::size_t(f)] * areas[f];
    return share(sum, areas.sum());
  }

  /// Of the area of a reference, that of triangles which have collapsed in the mesh.
  double collapsed(const Mat3X& vertices, const Mat3X& reference) const {
    const Eigen::VectorXd areas = face_normals(vertices, faces_).colwise().norm(),
                          whole = face_normals(reference, faces_).colwise().norm();
    const double least = options_.collapsed * share(areas.sum(), whole.sum());
    double sum = 0;
    for (Index f = 0; f < areas.size(); ++f)
      if (areas[f] < least * whole[f]) sum += whole[f];
    return share(sum, whole.sum());
  }

 private:
  static double share(double part, double whole) {
    require(whole > 0 && std::isfinite(whole), "FoldedShare: the mesh has area ", whole / 2, ", it must be positive");
    return part / whole;
  }

  Faces faces_;
  FoldOptions options_;
  std::vector<std::pair<Index, Index>> neighbours_;
};

}  // namespace dsns
