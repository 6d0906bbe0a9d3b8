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

/// A closed band of n squares between vertices 0, 2, 4, ... and 1, 3, 5, ...
inline Faces cylinder(int n) {
  Faces faces(3, 2 * n);
  for (int i = 0; i < n; ++i) {
    const int low = 2 * i, high = low + 1, next_low = 2 * ((i + 1) % n), next_high = next_low + 1;
    faces.col(2 * i) << low, next_low, next_high;
    faces.col(2 * i + 1) << low, next_high, high;
  }
  return faces;
}

/// The same band with its last square turned over.
inline Faces moebius_strip(int n) {
  Faces faces = cylinder(n);
  faces.col(2 * n - 2) << 2 * n - 2, 1, 0;
  faces.col(2 * n - 1) << 2 * n - 2, 0, 2 * n - 1;
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

/// A slab with `holes` square holes through it: genus = holes. Built of unit cubes, whose outer sides are split in two.
inline TriangleMesh slab_with_holes(int holes) {
  const auto solid = [&](int x, int y, int z) {
    const bool inside = x >= 0 && x < 2 * holes + 1 && y >= 0 && y < 3 && z == 0;
    return inside && !(x % 2 == 1 && y == 1);
  };
  const int nx = 2 * holes + 2, ny = 4;
  const auto corner = [&](int x, int y, int z) { return x + nx * (y + ny * z); };
  TriangleMesh mesh{Mat3X(3, nx * ny * 2), Faces(3, 0)};
  for (int z = 0; z < 2; ++z)
    for (int y = 0; y < ny; ++y)
      for (int x = 0; x < nx; ++x) mesh.vertices.col(corner(x, y, z)) << x, y, z;
  const auto add = [&](int a, int b, int c, int d) {
    mesh.faces.conservativeResize(3, mesh.faces.cols() + 2);
    mesh.faces.rightCols<2>() << a, a, b, c, c, d;
  };
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 2 * holes + 1; ++x) {
      if (!solid(x, y, 0)) continue;
      const auto at = [&](int i, int j, int k) { return corner(x + i, y + j, k); };
      add(at(0, 0, 1), at(1, 0, 1), at(1, 1, 1), at(0, 1, 1));
      add(at(0, 0, 0), at(0, 1, 0), at(1, 1, 0), at(1, 0, 0));
      if (!solid(x - 1, y, 0)) add(at(0, 0, 0), at(0, 0, 1), at(0, 1, 1), at(0, 1, 0));
      if (!solid(x + 1, y, 0)) add(at(1, 0, 0), at(1, 1, 0), at(1, 1, 1), at(1, 0, 1));
      if (!solid(x, y - 1, 0)) add(at(0, 0, 0), at(1, 0, 0), at(1, 0, 1), at(0, 0, 1));
      if (!solid(x, y + 1, 0)) add(at(0, 1, 0), at(0, 1, 1), at(1, 1, 1), at(1, 1, 0));
    }
  return mesh;
}

}  // namespace dsns::test
