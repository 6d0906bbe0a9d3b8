#pragma once
/// Points on a closed triangle mesh, moved by local steps: a point never jumps from one sheet of the surface to another that
/// happens to be near in space, as a search through all triangles would let it.
#include <dsns/mesh/own_mesh.hpp>

#include <vector>

namespace dsns {

/// A place on a mesh: barycentric coordinates on a face.
struct SurfacePoint {
  Index face = 0;
  Vec3d barycentric = Vec3d(1, 0, 0);
};

inline Vec3d position(const Mat3X& vertices, const Faces& faces, const SurfacePoint& p) {
  Vec3d sum = Vec3d::Zero();
  for (int k = 0; k < 3; ++k) sum += p.barycentric[k] * vertices.col(faces(k, p.face));
  return sum;
}

/// Refers to nothing: owns the mesh.
class SurfaceWalk {
 public:
  explicit SurfaceWalk(TriangleMesh mesh) : mesh_(std::move(mesh)), around_(std::size_t(mesh_.vertices.cols())) {
    for (Index f = 0; f < mesh_.faces.cols(); ++f)
      for (int k = 0; k < 3; ++k) around_[std::size_t(mesh_.faces(k, f))].push_back(f);
  }

  const TriangleMesh& mesh() const { return mesh_; }
  const std::vector<Index>& faces_around(Index vertex) const { return around_[std::size_t(vertex)]; }
  Vec3d position(const SurfacePoint& p) const { return dsns::position(mesh_.vertices, mesh_.faces, p); }

  /// The point nearest to x that descending from face to neighbouring face finds.
  SurfacePoint nearest(const Vec3d& x, SurfacePoint start) const {
    SurfacePoint best = on_face(x, start.face);
    double least = (position(best) - x).squaredNorm();
    for (bool moved = true; moved;) {
      moved = false;
      const Eigen::Vector3i corners = mesh_.faces.col(best.face);
      for (const int v : corners)
        for (const Index f : around_[std::size_t(v)]) {
          const SurfacePoint trial = on_face(x, f);
          const double distance = (position(trial) - x).squaredNorm();
          if (!(distance < least * (1 - 1e-12))) continue;
          least = distance;
          best = trial;
          moved = true;
        }
    }
    return best;
  }

 private:
  SurfacePoint on_face(const Vec3d& x, Index f) const {
    const auto corner = [&](int k) -> Vec3d { return mesh_.vertices.col(mesh_.faces(k, f)); };
    return {f, detail::nearest_in_triangle<Vec3d>(x, corner(0), corner(1), corner(2))};
  }

  TriangleMesh mesh_;
  std::vector<std::vector<Index>> around_;
};

}  // namespace dsns
