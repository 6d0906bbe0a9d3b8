#pragma once
/// Deformation transfer: what happens to each triangle of one mesh from its rest to a later frame happens to the same triangle
/// of another shape with the same connectivity.
#include <dsns/mesh/triangle_mesh.hpp>

#include <Eigen/LU>
#include <Eigen/SparseCholesky>
#include <array>
#include <cmath>

namespace dsns {

/// The deformation of triangles is a 3 x 3 matrix: edges go to edges, the normal to the normal, lengthened like the root of the
/// area. The result has, in least squares over the target's area, gradients that are the target's own deformed so: a Poisson
/// equation with one factorization for all frames.
/// accuracy 1e-10 where source and target are one shape, or the deformation is a similarity [mesh/deformation_transfer_test]
/// source   Sumner, Popovic 2004; as a Poisson equation Botsch, Sumner, Pauly, Gross 2006
class DeformationTransfer {
 public:
  /// Both 3 x n with the same faces. Triangles of either without area do as their neighbours, or nothing.
  /// throws   DegenerateSurface where the target is not one piece with area everywhere
  DeformationTransfer(Mat3X source_rest, Mat3X target_rest, Faces faces)
      : source_(std::move(source_rest)), target_(std::move(target_rest)), faces_(std::move(faces)) {
    require(source_.cols() == target_.cols() && faces_.cols() > 0 && faces_.minCoeff() >= 0 &&
                faces_.maxCoeff() < target_.cols(),
            "DeformationTransfer: ", source_.cols(), " and ", target_.cols(), " vertices with ", faces_.cols(),
            " faces, give two shapes of one mesh");
    const Mat3X normals = face_normals(target_, faces_);
    const double smallest = 1e-12 * normals.colwise().norm().mean();
    std::vector<Eigen::Triplet<double>> entries;
    gradients_.resize(std::size_t(faces_.cols()));
    for (Index f = 0; f < faces_.cols(); ++f) {
      const double twice_area = normals.col(f).norm();
      auto& g = gradients_[std::size_t(f)];
      for (int k = 0; k < 3; ++k) {
        const Vec3d opposite = target_.col(faces_((k + 2) % 3, f)) - target_.col(faces_((k + 1) % 3, f));
        g[std::size_t(k)] = twice_area > smallest ? Vec3d(normals.col(f).cross(opposite) / (twice_area * twice_area))
                                                  : Vec3d(Vec3d::Zero());
      }
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          entries.emplace_back(faces_(i, f), faces_(j, f), twice_area / 2 * g[std::size_t(i)].dot(g[std::size_t(j)]));
    }
    // A constant may be added to a solution: the first vertex is held, and the centroid set afterwards.
    Eigen::SparseMatrix<double> laplacian(target_.cols(), target_.cols());
    entries.emplace_back(0, 0, 1.0);
    laplacian.setFromTriplets(entries.begin(), entries.end());
    solver_.compute(laplacian);
    require<DegenerateSurface>(
        solver_.info() == Eigen::Success,
        "DeformationTransfer: the target has vertices without area around them; repair it first");
    areas_ = vertex_areas(target_, faces_);
    areas_ /= areas_.sum();
  }

  /// The target deformed as the source is from its rest to `frame`. Its centroid moves as the source's does, in proportion to
  /// the roots of the areas.
  Mat3X operator()(const Mat3X& frame) const {
    require(frame.cols() == source_.cols(), "DeformationTransfer: a frame of ", frame.cols(), " vertices for ",
            source_.cols());
    const std::vector<Mat3> deformations = deformations_to(frame);
    const Mat3X normals = face_normals(target_, faces_);
    Eigen::MatrixX3d right = Eigen::MatrixX3d::Zero(target_.cols(), 3);
    for (Index f = 0; f < faces_.cols(); ++f) {
      const auto& g = gradients_[std::size_t(f)];
      const double weight = normals.col(f).norm() / 2;
      // The gradient of the target's own coordinates is the projection on its plane.
      Mat3 own = Mat3::Zero();
      for (int k = 0; k < 3; ++k) own += target_.col(faces_(k, f)) * g[std::size_t(k)].transpose();
      const Mat3 wanted = deformations[std::size_t(f)] * own;
      for (int k = 0; k < 3; ++k) right.row(faces_(k, f)) += weight * (wanted * g[std::size_t(k)]).transpose();
    }
    Mat3X out = solver_.solve(right).transpose();
    const Vec3d moved = (frame - source_) * source_areas() * scale();
    out.colwise() += target_ * areas_ + moved - out * areas_;
    return out;
  }

 private:
  Eigen::VectorXd source_areas() const {
    const Eigen::VectorXd a = vertex_areas(source_, faces_);
    return a / a.sum();
  }
  double scale() const { return std::sqrt(area({target_, faces_}) / area({source_, faces_})); }

  /// [edge edge normal / root of twice the area], and twice the area.
  Mat3 frame_of(const Mat3X& x, Index f) const {
    Mat3 m;
    m.col(0) = x.col(faces_(1, f)) - x.col(faces_(0, f));
    m.col(1) = x.col(faces_(2, f)) - x.col(faces_(0, f));
    const Vec3d n = m.col(0).cross(m.col(1));
    m.col(2) = n / std::sqrt(std::max(n.norm(), 1e-300));
    return m;
  }

  std::vector<Mat3> deformations_to(const Mat3X& frame) const {
    const Mat3X normals = face_normals(source_, faces_);
    const double smallest = 1e-8 * normals.colwise().norm().mean();
    std::vector<Mat3> out(std::size_t(faces_.cols()), Mat3::Identity());
    std::vector<Mat3> around(std::size_t(source_.cols()), Mat3::Zero());
    Eigen::VectorXd weights = Eigen::VectorXd::Zero(source_.cols());
    for (Index f = 0; f < faces_.cols(); ++f) {
      const double weight = normals.col(f).norm();
      if (!(weight > smallest)) continue;
      out[std::size_t(f)] = frame_of(frame, f) * frame_of(source_, f).inverse();
      for (int k = 0; k < 3; ++k) {
        around[std::size_t(faces_(k, f))] += weight * out[std::size_t(f)];
        weights[faces_(k, f)] += weight;
      }
    }
    for (Index f = 0; f < faces_.cols(); ++f) {
      if (normals.col(f).norm() > smallest) continue;
      Mat3 sum = Mat3::Zero();
      double weight = 0;
      for (int k = 0; k < 3; ++k) {
        sum += around[std::size_t(faces_(k, f))];
        weight += weights[faces_(k, f)];
      }
      if (weight > 0) out[std::size_t(f)] = sum / weight;
    }
    return out;
  }

  Mat3X source_, target_;
  Faces faces_;
  std::vector<std::array<Vec3d, 3>> gradients_;  // of the three hat functions of each of the target's triangles
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver_;
  Eigen::VectorXd areas_;
};

}  // namespace dsns
