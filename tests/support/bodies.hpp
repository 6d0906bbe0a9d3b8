#pragma once
/// Closed genus-0 meshes of all kinds, and random points, for tests of sphere maps.
#include <dsns/mesh/sphere_mesh.hpp>

#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include "support/meshes.hpp"

namespace dsns::test {

/// A seed's uniform numbers, the same with every standard library.
class Uniform {
 public:
  explicit Uniform(unsigned seed) : engine_(seed) {}
  double operator()(double low, double high) { return low + (high - low) * double(engine_()) / 4294967296.0; }
  int below(int n) { return static_cast<int>((*this)(0, n)); }
  Vec3d unit_vector() {
    const double z = (*this)(-1, 1), angle = (*this)(0, 2 * pi), r = std::sqrt(1 - z * z);
    return Vec3d(r * std::cos(angle), r * std::sin(angle), z).normalized();
  }

 private:
  std::mt19937 engine_;
};

inline Mat3X random_unit_vectors(Index n, unsigned seed) {
  Uniform uniform(seed);
  Mat3X s(3, n);
  for (Index i = 0; i < n; ++i) s.col(i) = uniform.unit_vector();
  return s;
}

/// The mesh as a sequence of one frame.
inline MeshSequence still(const TriangleMesh& mesh) {
  MeshSequence sequence;
  sequence.frames = {mesh.vertices};
  sequence.faces = mesh.faces;
  return sequence;
}

inline TriangleMesh tetrahedron() {
  TriangleMesh mesh{Mat3X(3, 4), Faces(3, 4)};
  mesh.vertices << 1, -1, 1, -1, 1, 1, -1, -1, 1, -1, -1, 1;
  mesh.faces << 0, 0, 0, 1, 2, 3, 1, 2, 1, 2, 3, 3;
  return mesh;
}

inline TriangleMesh octahedron() { return latitude_longitude_sphere(1, 4); }

/// Vertices moved by up to `amount` in every coordinate.
inline TriangleMesh noisy(TriangleMesh mesh, double amount, unsigned seed) {
  Uniform uniform(seed);
  for (Index v = 0; v < mesh.vertices.cols(); ++v)
    for (int k = 0; k < 3; ++k) mesh.vertices(k, v) += uniform(-amount, amount);
  return mesh;
}

inline TriangleMesh stretched(TriangleMesh mesh, const Vec3d& factors) {
  mesh.vertices = factors.asDiagonal() * mesh.vertices;
  return mesh;
}

/// Faces pulled out of a level-1 icosphere into tapered prisms of `segments` storeys, `length` long.
inline TriangleMesh limbed_body(int limbs, int segments, double length) {
  const TriangleMesh trunk = icosphere(1);
  TriangleMesh body = trunk;
  body.vertices.conservativeResize(3, trunk.vertices.cols() + 3 * limbs * segments);
  body.faces.conservativeResize(3, trunk.faces.cols() + 6 * limbs * segments);
  Index v = trunk.vertices.cols(), f = trunk.faces.cols();
  for (int limb = 0; limb < limbs; ++limb) {
    const Index tip = limb * (trunk.faces.cols() / limbs);
    const Vec3d step = length / segments * trunk.vertices.col(trunk.faces(0, tip));
    for (int segment = 0; segment < segments; ++segment, v += 3) {
      const Eigen::Vector3i base = body.faces.col(tip), top = Eigen::Vector3i(0, 1, 2).array() + static_cast<int>(v);
      Mat3 corners;
      for (int k = 0; k < 3; ++k) corners.col(k) = body.vertices.col(base[k]);
      const Vec3d centre = corners.rowwise().mean();
      body.vertices.middleCols<3>(v) = (0.97 * (corners.colwise() - centre)).colwise() + (centre + step);
      for (int k = 0; k < 3; ++k) {
        const int next = (k + 1) % 3;
        body.faces.col(f++) << base[k], base[next], top[next];
        body.faces.col(f++) << base[k], top[next], top[k];
      }
      body.faces.col(tip) = top;
    }
  }
  return body;
}

/// A triangulation of the sphere drawn at random: vertices put into faces and edges flipped, with any number of
/// neighbours from 3 on; positions around a random ellipsoid with noise, so that faces lie and cross anyhow.
inline TriangleMesh random_triangulation(int vertices, unsigned seed) {
  Uniform uniform(seed);
  TriangleMesh mesh = tetrahedron();
  std::vector<Eigen::Vector3i> faces;
  for (Index f = 0; f < 4; ++f) faces.emplace_back(mesh.faces.col(f));
  const auto has_edge = [&](int a, int b) {
    for (const auto& f : faces)
      if ((f.array() == a).any() && (f.array() == b).any()) return true;
    return false;
  };
  const auto flip = [&](std::size_t f) {
    const int k = uniform.below(3), a = faces[f][k], b = faces[f][(k + 1) % 3], c = faces[f][(k + 2) % 3];
    for (std::size_t g = 0; g < faces.size(); ++g)
      for (int j = 0; j < 3; ++j) {
        if (faces[g][j] != b || faces[g][(j + 1) % 3] != a) continue;
        const int d = faces[g][(j + 2) % 3];
        if (has_edge(c, d)) return;
        faces[f] << a, d, c;
        faces[g] << d, b, c;
        return;
      }
  };
  for (int v = 4; v < vertices; ++v) {
    const auto f = static_cast<std::size_t>(uniform.below(static_cast<int>(faces.size())));
    const Eigen::Vector3i old = faces[f];
    faces[f] << old[0], old[1], v;
    faces.emplace_back(old[1], old[2], v);
    faces.emplace_back(old[2], old[0], v);
    for (int k = 0; k < 3; ++k) flip(static_cast<std::size_t>(uniform.below(static_cast<int>(faces.size()))));
  }
  mesh.vertices.resize(3, vertices);
  const Vec3d axes(uniform(0.1, 3), uniform(0.1, 3), uniform(0.1, 3));
  const double noise = uniform(0, 0.5);
  for (int v = 0; v < vertices; ++v)
    mesh.vertices.col(v) = axes.cwiseProduct(uniform.unit_vector()) + noise * uniform.unit_vector();
  mesh.faces.resize(3, Index(faces.size()));
  for (std::size_t f = 0; f < faces.size(); ++f) mesh.faces.col(Index(f)) = faces[f];
  return mesh;
}

/// The same surface with vertices and faces in random order and faces begun at a random corner.
inline TriangleMesh relabelled(const TriangleMesh& mesh, unsigned seed) {
  Uniform uniform(seed);
  const auto shuffled = [&](Index n) {
    std::vector<int> order(static_cast<std::size_t>(n));
    std::iota(order.begin(), order.end(), 0);
    for (int i = static_cast<int>(n) - 1; i > 0; --i)
      std::swap(order[std::size_t(i)], order[std::size_t(uniform.below(i + 1))]);
    return order;
  };
  const std::vector<int> vertex = shuffled(mesh.vertices.cols()), face = shuffled(mesh.faces.cols());
  TriangleMesh out = mesh;
  for (Index v = 0; v < mesh.vertices.cols(); ++v) out.vertices.col(vertex[std::size_t(v)]) = mesh.vertices.col(v);
  for (Index f = 0; f < mesh.faces.cols(); ++f) {
    const int turn = uniform.below(3);
    for (int k = 0; k < 3; ++k) out.faces((k + turn) % 3, face[std::size_t(f)]) = vertex[std::size_t(mesh.faces(k, f))];
  }
  return out;
}

}  // namespace dsns::test
