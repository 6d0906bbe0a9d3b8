#pragma once
/// Vertices and polygons as files give them, one after the other.
#include <dsns/core/errors.hpp>
#include <dsns/mesh/triangle_mesh.hpp>

#include <array>
#include <cmath>
#include <filesystem>
#include <vector>

namespace dsns::detail {

class MeshBuilder {
 public:
  explicit MeshBuilder(const std::filesystem::path& path) : path_(path) {}

  Index vertex_count() const { return static_cast<Index>(points_.size()); }
  void add_vertex(const Vec3d& p) {
    require<FileError>(p.allFinite(), path_.string(), ": vertex ", points_.size(),
                       " is not at a finite place: export the file again");
    points_.push_back(p);
  }
  /// A polygon becomes a fan of triangles. Vertices may be defined later.
  void add_polygon(const std::vector<int>& corners) {
    require<FileError>(corners.size() >= 3, path_.string(), ": face ", polygons_, " has ", corners.size(),
                       " vertices, give at least 3");
    for (std::size_t k = 2; k < corners.size(); ++k) triangles_.push_back({corners[0], corners[k - 1], corners[k]});
    ++polygons_;
  }
  /// throws   FileError where there is no mesh, or a face names a vertex that there is not
  TriangleMesh mesh() const {
    require<FileError>(!points_.empty() && !triangles_.empty(), path_.string(), " has ", points_.size(),
                       " vertices and ", triangles_.size(), " faces: give a file with a mesh");
    TriangleMesh mesh{Mat3X(3, static_cast<Index>(points_.size())), Faces(3, static_cast<Index>(triangles_.size()))};
    for (std::size_t v = 0; v < points_.size(); ++v) mesh.vertices.col(static_cast<Index>(v)) = points_[v];
    for (std::size_t f = 0; f < triangles_.size(); ++f)
      for (int k = 0; k < 3; ++k) {
        const int v = triangles_[f][static_cast<std::size_t>(k)];
        require<FileError>(v >= 0 && v < vertex_count(), path_.string(), ": a face names vertex ", v, ", there are ",
                           vertex_count(), " from 0 on: export the file again");
        mesh.faces(k, static_cast<Index>(f)) = v;
      }
    return mesh;
  }

 private:
  std::filesystem::path path_;
  std::vector<Vec3d> points_;
  std::vector<std::array<int, 3>> triangles_;
  std::size_t polygons_ = 0;
};

}  // namespace dsns::detail
