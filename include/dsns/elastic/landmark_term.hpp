#pragma once
/// Landmarks in the energy of a spatial registration: sum of w |gamma(p) - target|^2, chords, in units of the squared norm of the
/// fields. Their points are moved with the nodes of the quadrature, behind which they stand.
#include <dsns/elastic/spatial_descent.hpp>

namespace dsns::detail {

class LandmarkTerm {
 public:
  LandmarkTerm() = default;
  LandmarkTerm(SphereLandmarks landmarks, double norm) : landmarks_(std::move(landmarks)), norm_(norm) {}

  /// The nodes and behind them the landmarks.
  Mat3X behind(const Mat3X& nodes) const {
    Mat3X all(3, nodes.cols() + landmarks_.size());
    all << nodes, landmarks_.points;
    return all;
  }

  /// images   of nodes and landmarks, or of nodes alone, which costs nothing
  double energy(const Mat3X& images, Index nodes) const {
    if (images.cols() == nodes) return 0;
    return norm_ * (landmarks_.targets - images.rightCols(landmarks_.size()))
                       .colwise()
                       .squaredNorm()
                       .dot(landmarks_.weights.transpose());
  }

  /// charts   at the images of nodes and landmarks, or of nodes alone
  void add_to(NormalEquations& system, const ChartBatch& charts, Index nodes) const {
    const Index n = charts.size() - nodes, count = harmonic_count(system.degree) - 1;
    if (n == 0) return;
    const ChartBatch at{charts.s.rightCols(n), charts.e1.rightCols(n), charts.e2.rightCols(n)};
    const HarmonicTangents basis = harmonic_tangents(at, system.degree);
    const Mat3X missed = landmarks_.targets - at.s;
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(2 * n, system.right.size());
    Eigen::VectorXd wanted(2 * n), weights(2 * n);
    rows.topLeftCorner(n, count) = basis.yu.rightCols(count);
    rows.block(0, count, n, count) = -basis.yv.rightCols(count);
    rows.bottomLeftCorner(n, count) = basis.yv.rightCols(count);
    rows.block(n, count, n, count) = basis.yu.rightCols(count);
    wanted << missed.cwiseProduct(at.e1).colwise().sum().transpose(),
        missed.cwiseProduct(at.e2).colwise().sum().transpose();
    weights << norm_ * landmarks_.weights, norm_ * landmarks_.weights;
    system.matrix.triangularView<Eigen::Lower>() += rows.transpose() * weights.asDiagonal() * rows;
    system.right += rows.transpose() * weights.cwiseProduct(wanted);
  }

 private:
  SphereLandmarks landmarks_;
  double norm_ = 0;
};

}  // namespace dsns::detail
