#pragma once
/// An icosphere whose vertices move on the sphere: an elastic energy that no rotation raises, and a barrier that rises where
/// triangles shrink and that none can cross.
#include <dsns/mesh/piecewise_linear_diffeomorphism.hpp>

#include <Eigen/SparseCore>

namespace dsns::detail {

/// b(J) = -w (x - 1)^2 ln x with x = J / threshold below the threshold, 0 above it: twice continuously differentiable, and
/// infinite where J is not positive.
/// accuracy slope and curvature 1e-5 against central differences [matching/elastic_sphere_test]
/// source   Li et al. 2020 (incremental potential contact), equation 6
struct JacobianBarrier {
  double threshold = 0.1, weight = 1e-3;

  double operator()(double J) const {
    if (J >= threshold) return 0;
    if (!(J > 0)) return std::numeric_limits<double>::infinity();
    const double x = J / threshold;
    return -weight * (x - 1) * (x - 1) * std::log(x);
  }
  /// First and second derivative, for 0 < J < threshold.
  double slope(double J) const {
    const double x = J / threshold;
    return -weight / threshold * (x - 1) * (2 * std::log(x) + (x - 1) / x);
  }
  double curvature(double J) const {
    const double x = J / threshold, y = (x - 1) / x;
    return weight / (threshold * threshold) * (-2 * std::log(x) - 4 * y + y * y);
  }
};

/// The elastic energy of images y, 3 x n, is the mean over the sphere of |(Laplacian + 2) y|^2: coordinates that are harmonics
/// of degree l count with ((l - 1)(l + 2))^2. It is 0 for rotations, and grows as the fourth power of detail.
/// accuracy rotations 1e-3, degree 6 to 4 %, on a level-4 icosphere [matching/elastic_sphere_test]
class ElasticSphere {
 public:
  struct Corner {
    int face, place;  ///< faces(place, face) is the vertex
  };

  explicit ElasticSphere(int level) : sphere_(icosphere(level)), stars_(std::size_t(size())) {
    const Faces& faces = sphere_.faces;
    masses_ = vertex_areas(sphere_.vertices, faces);
    const double total = masses_.sum();
    masses_ /= total;
    face_masses_ = face_normals(sphere_.vertices, faces).colwise().norm() / (2 * total);
    determinants_.setOnes(faces.cols());
    std::vector<Eigen::Triplet<double>> entries;
    for (int f = 0; f < faces.cols(); ++f) {
      const Mat3 P = corners(sphere_.vertices, f);
      determinants_[f] = jacobian(sphere_.vertices, f);
      for (int k = 0; k < 3; ++k) {
        const int k1 = (k + 1) % 3, k2 = (k + 2) % 3, a = faces(k1, f), b = faces(k2, f);
        const Vec3d u = P.col(k1) - P.col(k), v = P.col(k2) - P.col(k);
        const double weight = u.dot(v) / u.cross(v).norm() / (2 * total);  // half the cotangent, for the edge opposite
        entries.insert(entries.end(), {{a, b, -weight}, {b, a, -weight}, {a, a, weight}, {b, b, weight}});
        stars_[std::size_t(faces(k, f))].push_back({f, k});
      }
    }
    for (int i = 0; i < size(); ++i) entries.emplace_back(i, i, -2 * masses_[i]);
    Eigen::SparseMatrix<double> A(size(), size());
    A.setFromTriplets(entries.begin(), entries.end());
    energy_ = A * masses_.cwiseInverse().asDiagonal() * A;
    energy_.makeCompressed();
  }

  Index size() const { return sphere_.vertices.cols(); }
  const Mat3X& vertices() const { return sphere_.vertices; }
  const Faces& faces() const { return sphere_.faces; }
  const std::vector<Corner>& star(Index vertex) const { return stars_[std::size_t(vertex)]; }
  const Eigen::VectorXd& masses() const { return masses_; }            ///< of the vertices, sum 1
  const Eigen::VectorXd& face_masses() const { return face_masses_; }  ///< sum 1
  /// The energy of y is the sum of (y Q) . y with this Q, symmetric, of pairs of vertices up to two edges apart.
  const Eigen::SparseMatrix<double>& energy() const { return energy_; }

  Mat3 corners(const Mat3X& y, Index face) const {
    Mat3 out;
    for (int k = 0; k < 3; ++k) out.col(k) = y.col(sphere_.faces(k, face));
    return out;
  }
  /// det(images) / det(corners): the face's Jacobian, up to O(edge^2).
  double jacobian(const Mat3X& y, Index face) const {
    const Mat3 Y = corners(y, face);
    return determinant(Y.col(0), Y.col(1), Y.col(2)) / determinants_[face];
  }
  double determinant_of(Index face) const { return determinants_[face]; }

 private:
  TriangleMesh sphere_;
  std::vector<std::vector<Corner>> stars_;
  Eigen::VectorXd masses_, face_masses_, determinants_;
  Eigen::SparseMatrix<double> energy_;
};

}  // namespace dsns::detail
