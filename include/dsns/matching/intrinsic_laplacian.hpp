#pragma once
/// The Laplacian of a triangle mesh from its edge lengths alone.
#include <dsns/matching/intrinsic_delaunay.hpp>
#include <dsns/matching/matching_body.hpp>

#include <Eigen/SparseCore>
#include <tuple>

namespace dsns {

/// The weak Laplacian of piecewise linear functions: integral of |grad u|^2 = u^T stiffness u, integral of u^2 = sum m u^2.
struct IntrinsicLaplacian {
  Eigen::SparseMatrix<double> stiffness;  ///< n x n, symmetric, rows sum to 0
  Eigen::VectorXd masses;                 ///< lumped, n
};

/// The lowest eigenfunctions but the constant: -Laplacian(phi_k) = lambda_k phi_k, sum of m phi_j phi_k = delta_jk sum m.
struct IntrinsicSpectrum {
  Eigen::VectorXd eigenvalues;     ///< ascending, k, length^-2
  Eigen::MatrixXd eigenfunctions;  ///< at the vertices, n x k

  Index size() const { return eigenvalues.size(); }
};

/// The cotangent Laplacian of given triangles, as they are.
/// accuracy the finite elements of a mesh in space to 1e-12 [matching/intrinsic_laplacian_test]
inline IntrinsicLaplacian intrinsic_laplacian(const IntrinsicTriangulation& triangulation, Index vertices) {
  const Faces& faces = triangulation.faces;
  require(triangulation.lengths.cols() == faces.cols(), "intrinsic_laplacian: lengths of ",
          triangulation.lengths.cols(), " faces for ", faces.cols());
  IntrinsicLaplacian out{Eigen::SparseMatrix<double>(vertices, vertices), Eigen::VectorXd::Zero(vertices)};
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(std::size_t(12 * faces.cols()));
  for (Index f = 0; f < faces.cols(); ++f) {
    const Vec3d length = triangulation.lengths.col(f);
    double four_areas = 0;
    for (int k = 0; k < 3; ++k) {
      const int u = faces((k + 1) % 3, f), v = faces((k + 2) % 3, f);
      const double cotangent = detail::opposite_cotangent(length[k], length[(k + 1) % 3], length[(k + 2) % 3]);
      four_areas += cotangent * length[k] * length[k];
      for (const auto& [row, column, sign] : {std::tuple{u, u, 1}, {v, v, 1}, {u, v, -1}, {v, u, -1}})
        entries.emplace_back(row, column, 0.5 * sign * cotangent);
    }
    for (int k = 0; k < 3; ++k) out.masses[faces(k, f)] += four_areas / 12;
  }
  out.stiffness.setFromTriplets(entries.begin(), entries.end());
  return out;
}

/// Of a body's mean lengths, after Delaunay flips.
inline IntrinsicLaplacian intrinsic_laplacian(const MatchingBody& body) {
  return intrinsic_laplacian(intrinsic_delaunay({body.faces(), body.edge_lengths()}), body.vertex_count());
}

}  // namespace dsns
