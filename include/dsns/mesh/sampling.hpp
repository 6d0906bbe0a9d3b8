#pragma once
/// Random points on the faces of a moving mesh, as points of the sphere.
#include <dsns/mesh/triangle_mesh.hpp>

#include <random>

namespace dsns {

/// n unit vectors, 3 x n, whose images are spread by the faces' area, averaged over the frames; the faces that close holes
/// get none.
inline Mat3X sample_faces(const MeshSequence& sequence, const Mat3X& sphere, int n, std::mt19937_64& random) {
  const Index faces = sequence.faces.cols() - sequence.cap_faces;
  std::vector<double> areas(static_cast<std::size_t>(faces), 0.0);
  for (const Mat3X& frame : sequence.frames) {
    const Mat3X normals = face_normals(frame, sequence.faces);
    for (Index f = 0; f < faces; ++f) areas[static_cast<std::size_t>(f)] += normals.col(f).norm();
  }
  std::discrete_distribution<Index> face(areas.begin(), areas.end());
  std::uniform_real_distribution<double> uniform(0, 1);
  Mat3X s(3, n);
  for (Index i = 0; i < n; ++i) {
    const Index f = face(random);
    const double root = std::sqrt(uniform(random)), along = uniform(random);
    const Vec3d b(1 - root, root * (1 - along), root * along);
    s.col(i).setZero();
    for (int k = 0; k < 3; ++k) s.col(i) += b[k] * sphere.col(sequence.faces(k, f));
    s.col(i).normalize();
  }
  return s;
}

}  // namespace dsns
