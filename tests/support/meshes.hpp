#pragma once
/// Meshes with known topology.
#include <dsns/mesh/triangle_mesh.hpp>

#include <cmath>

namespace dsns::test {

/// Outward torus with tube radius 1 around a circle of radius 3.
inline TriangleMesh torus(int around, int across) {
  TriangleMesh mesh{Mat3X(3, around * across), Faces(3, 2 * around * across)};
  const auto at = [&](int i, int j) { return i % around * across + j % across; };
  Index f = 0;
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < across; ++j) {
      const double u = 2 * pi * i / around, v = 2 * pi * j / across, r = 3 + std::cos(v);
      mesh.vertices.col(at(i, j)) << r * std::cos(u), r * std::sin(u), std::sin(v);
      mesh.faces.col(f++) << at(i, j), at(i + 1, j), at(i + 1, j + 1);
      mesh.faces.col(f++) << at(i, j), at(i + 1, j + 1), at(i, j + 1);
    }
  return mesh;
}

/// A closed band of n squares over 2 n vertices: a cylinder, or a Moebius strip where it is twisted.
inline Faces ribbon(int n, bool twisted) {
  Faces faces(3, 2 * n);
  for (int i = 0; i < n; ++i) {
    const bool swapped = twisted && i == n - 1;
    const int low = 2 * i, high = 2 * i + 1, next = 2 * ((i + 1) % n);
    const int next_low = swapped ? next + 1 : next, next_high = swapped ? next : next + 1;
    faces.col(2 * i) << low, next_low, next_high;
    faces.col(2 * i + 1) << low, next_high, high;
  }
  return faces;
}

inline TriangleMesh joined(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh both{Mat3X(3, a.vertices.cols() + b.vertices.cols()), Faces(3, a.faces.cols() + b.faces.cols())};
  both.vertices << a.vertices, b.vertices;
  both.faces << a.faces, (b.faces.array() + int(a.vertices.cols())).matrix();
  return both;
}

/// The mesh and its copies at other sizes as a sequence of `frames` frames, growing by `growth` a frame.
inline MeshSequence growing(const TriangleMesh& mesh, int frames = 3, double growth = 0.5) {
  MeshSequence sequence;
  sequence.faces = mesh.faces;
  sequence.name = "growing";
  for (int k = 0; k < frames; ++k) sequence.frames.push_back((1 + growth * k) * mesh.vertices);
  return sequence;
}

}  // namespace dsns::test
