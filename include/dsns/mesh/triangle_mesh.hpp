#pragma once
/// Triangle meshes and sequences of them: one connectivity, moving vertices.
#include <dsns/core/errors.hpp>
#include <dsns/core/types.hpp>

#include <string>
#include <vector>

namespace dsns {

/// vertices 3 x n (length unit of the file), faces 3 x m.
struct TriangleMesh {
  Mat3X vertices;
  Faces faces;
};

/// The same triangles at frames.size() equidistant times; the first frame is t = 0 and the last t = 1.
struct MeshSequence {
  std::vector<Mat3X> frames;  ///< each 3 x n
  Faces faces;                ///< 3 x m; the last cap_faces of them close holes of the input
  Index cap_faces = 0;
  double duration = 1;  ///< seconds from the first frame to the last
  std::string name;     ///< where it came from, for messages and file names

  Index vertex_count() const { return frames.empty() ? 0 : frames.front().cols(); }
  int frame_count() const { return static_cast<int>(frames.size()); }
  TriangleMesh frame(int k) const { return {frames.at(static_cast<std::size_t>(k)), faces}; }
};

/// Twice the area vector of each face: 3 x m, (b - a) x (c - a).
inline Mat3X face_normals(const Mat3X& vertices, const Faces& faces) {
  Mat3X normals(3, faces.cols());
  for (Index f = 0; f < faces.cols(); ++f) {
    const Vec3d a = vertices.col(faces(0, f));
    normals.col(f) = (vertices.col(faces(1, f)) - a).cross(vertices.col(faces(2, f)) - a);
  }
  return normals;
}

inline double area(const TriangleMesh& mesh) {
  return 0.5 * face_normals(mesh.vertices, mesh.faces).colwise().norm().sum();
}

/// Signed volume enclosed by a closed mesh; positive where the faces are counter-clockwise seen from outside.
inline double volume(const TriangleMesh& mesh) {
  double six = 0;
  for (Index f = 0; f < mesh.faces.cols(); ++f)
    six += mesh.vertices.col(mesh.faces(0, f))
               .dot(mesh.vertices.col(mesh.faces(1, f)).cross(mesh.vertices.col(mesh.faces(2, f))));
  return six / 6;
}

/// Area-weighted unit normals of the vertices, 3 x n; zero where a vertex has no face with area.
inline Mat3X vertex_normals(const Mat3X& vertices, const Faces& faces) {
  const Mat3X normals = face_normals(vertices, faces);
  Mat3X sum = Mat3X::Zero(3, vertices.cols());
  for (Index f = 0; f < faces.cols(); ++f)
    for (int k = 0; k < 3; ++k) sum.col(faces(k, f)) += normals.col(f);
  for (Index v = 0; v < sum.cols(); ++v) sum.col(v).stableNormalize();
  return sum;
}

/// One third of the area around each vertex, n values that sum to the mesh's area.
inline Eigen::VectorXd vertex_areas(const Mat3X& vertices, const Faces& faces) {
  const Mat3X normals = face_normals(vertices, faces);
  Eigen::VectorXd areas = Eigen::VectorXd::Zero(vertices.cols());
  for (Index f = 0; f < faces.cols(); ++f)
    for (int k = 0; k < 3; ++k) areas[faces(k, f)] += normals.col(f).norm() / 6;
  return areas;
}

}  // namespace dsns
