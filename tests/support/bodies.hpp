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
