#pragma once
/// Does a map of the sphere, known at points only and not even continuous, keep the orientation? A body and its mirror image
/// have the same intrinsic geometry: no residual tells a correspondence from a flipped one, but this does.
#include <dsns/sphere/charts.hpp>

#include <algorithm>
#include <numeric>
#include <vector>

namespace dsns {

/// The linear parts of a map around points of the sphere, from least squares over their nearest neighbours.
class MapOrientation {
 public:
  /// s        3 x n unit vectors, spread as the map's domain is to be counted
  /// throws   InvalidArgument where there are fewer points than neighbours
  explicit MapOrientation(Mat3X s, int neighbours = 30) : s_(std::move(s)) {
    require(neighbours >= 3 && s_.cols() >= neighbours, "MapOrientation: ", neighbours, " neighbours of ", s_.cols(),
            " points, give at least 3 and no more than there are");
    std::vector<Index> order(static_cast<std::size_t>(s_.cols()));
    for (Index i = 0; i < s_.cols(); ++i) {
      const Eigen::VectorXd closeness = s_.transpose() * s_.col(i);
      std::iota(order.begin(), order.end(), Index(0));
      std::nth_element(order.begin(), order.begin() + (neighbours - 1), order.end(),
                       [&](Index a, Index b) { return closeness[a] > closeness[b]; });
      groups_.emplace_back(order.begin(), order.begin() + neighbours);
    }
  }

  /// Mean over the points of the sign of det of the map's linear part, in [-1, 1]: 1 where every point keeps its orientation.
  /// images   of the points, 3 x n unit vectors
  double operator()(const Mat3X& images) const {
    require(images.cols() == s_.cols(), "MapOrientation: ", images.cols(), " images of ", s_.cols(), " points");
    double sum = 0;
    for (const auto& group : groups_) {
      const auto a = around_mean(s_, group), b = around_mean(images, group);
      const double det = (a * b.transpose()).determinant();
      sum += det > 0 ? 1 : det < 0 ? -1 : 0;
    }
    return sum / double(groups_.size());
  }

 private:
  using Planar = Eigen::Matrix<double, 2, Eigen::Dynamic>;

  /// Components in the tangent plane at the group's mean, centred.
  static Planar around_mean(const Mat3X& points, const std::vector<Index>& group) {
    const Mat3X members = points(Eigen::all, group);
    const Vec3d mean = members.rowwise().mean();
    const TangentFrame frame = tangent_frame(mean.norm() > 0 ? mean.normalized() : Vec3d::UnitX());
    Planar plane(2, members.cols());
    plane.row(0) = frame.e1.transpose() * (members.colwise() - mean);
    plane.row(1) = frame.e2.transpose() * (members.colwise() - mean);
    return plane;
  }

  Mat3X s_;
  std::vector<std::vector<Index>> groups_;
};

}  // namespace dsns
