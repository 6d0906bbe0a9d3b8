#pragma once
/// Triangulations of the unit sphere, and meshes of surfaces over them.
#include <dsns/mesh/triangle_mesh.hpp>

#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace dsns {

/// Icosahedron whose triangles are split in four `level` times: 10 * 4^level + 2 unit vertices, outward faces.
/// throws   InvalidArgument unless 0 <= level <= 8
inline TriangleMesh icosphere(int level) {
  require(level >= 0 && level <= 8, "icosphere: level is ", level, ", give one from 0 to 8");
  const double phi = (1 + std::sqrt(5.0)) / 2;
  std::vector<Vec3d> points;
  for (const double a : {-1.0, 1.0})
    for (const double b : {-phi, phi}) {
      points.emplace_back(Vec3d(0, a, b).normalized());
      points.emplace_back(Vec3d(a, b, 0).normalized());
      points.emplace_back(Vec3d(b, 0, a).normalized());
    }
  std::vector<std::array<int, 3>> triangles;  // the icosahedron's edge length is 2 / |(0, 1, phi)|
  const double edge = 2 / std::sqrt(1 + phi * phi) + 1e-9;
  const auto near = [&](int i, int j) { return (points[std::size_t(i)] - points[std::size_t(j)]).norm() < edge; };
  for (int i = 0; i < 12; ++i)
    for (int j = i + 1; j < 12; ++j)
      for (int k = j + 1; k < 12; ++k) {
        if (!near(i, j) || !near(j, k) || !near(k, i)) continue;
        const Vec3d &a = points[std::size_t(i)], &b = points[std::size_t(j)], &c = points[std::size_t(k)];
        triangles.push_back(a.dot(b.cross(c)) > 0 ? std::array{i, j, k} : std::array{i, k, j});
      }
  for (int split = 0; split < level; ++split) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int i, int j) {
      const auto [it, added] = middles.try_emplace(std::minmax(i, j), static_cast<int>(points.size()));
      if (added) points.emplace_back((points[std::size_t(i)] + points[std::size_t(j)]).normalized());
      return it->second;
    };
    std::vector<std::array<int, 3>> finer;
    for (const auto& [a, b, c] : triangles) {
      const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    triangles = std::move(finer);
  }
  TriangleMesh mesh{Mat3X(3, Index(points.size())), Faces(3, Index(triangles.size()))};
  for (std::size_t i = 0; i < points.size(); ++i) mesh.vertices.col(Index(i)) = points[i];
  for (std::size_t f = 0; f < triangles.size(); ++f)
    for (int k = 0; k < 3; ++k) mesh.faces(k, Index(f)) = triangles[f][std::size_t(k)];
  return mesh;
}

/// Unit sphere with one vertex at each pole and `rings` rings of `sectors` vertices between them, outward faces.
/// throws   InvalidArgument unless rings >= 1 and sectors >= 3
inline TriangleMesh latitude_longitude_sphere(int rings, int sectors) {
  require(rings >= 1 && sectors >= 3, "latitude_longitude_sphere: ", rings, " rings of ", sectors,
          " sectors, give at least 1 ring of 3");
  TriangleMesh mesh{Mat3X(3, 2 + rings * sectors), Faces(3, 2 * rings * sectors)};
  const int south = 1 + rings * sectors;
  mesh.vertices.col(0) = Vec3d::UnitZ();
  mesh.vertices.col(south) = -Vec3d::UnitZ();
  const auto at = [&](int ring, int sector) { return 1 + ring * sectors + sector % sectors; };
  Index f = 0;
  for (int r = 0; r < rings; ++r) {
    const double colatitude = pi * (r + 1) / (rings + 1);
    for (int k = 0; k < sectors; ++k) {
      const double longitude = 2 * pi * k / sectors;
      mesh.vertices.col(at(r, k)) << std::sin(colatitude) * std::cos(longitude),
          std::sin(colatitude) * std::sin(longitude), std::cos(colatitude);
      if (r == 0) mesh.faces.col(f++) << 0, at(r, k), at(r, k + 1);
      if (r + 1 < rings) {
        mesh.faces.col(f++) << at(r, k), at(r + 1, k), at(r + 1, k + 1);
        mesh.faces.col(f++) << at(r, k), at(r + 1, k + 1), at(r, k + 1);
      } else {
        mesh.faces.col(f++) << at(r, k), south, at(r, k + 1);
      }
    }
  }
  return mesh;
}

/// The mesh of a surface functor over a triangulated sphere.
template <class S>
TriangleMesh mesh_of(const S& surface, const TriangleMesh& sphere) {
  TriangleMesh mesh = sphere;
  for (Index v = 0; v < sphere.vertices.cols(); ++v) mesh.vertices.col(v) = surface(Vec3d(sphere.vertices.col(v)));
  return mesh;
}

/// The moving mesh of a functor F(s, t) over a triangulated sphere at `frames` equidistant times from 0 to 1.
template <class F>
MeshSequence sequence_of(const F& surface, const TriangleMesh& sphere, int frames) {
  require(frames >= 2, "sequence_of: ", frames, " frames, give at least 2");
  MeshSequence sequence;
  sequence.faces = sphere.faces;
  for (int k = 0; k < frames; ++k) {
    Mat3X vertices(3, sphere.vertices.cols());
    for (Index v = 0; v < vertices.cols(); ++v)
      vertices.col(v) = surface(Vec3d(sphere.vertices.col(v)), double(k) / (frames - 1));
    sequence.frames.push_back(std::move(vertices));
  }
  return sequence;
}

}  // namespace dsns
