#pragma once
/// Points of a shape's space of motions in patches of neighbours, for searches that would else visit all points.
#include <dsns/core/types.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace dsns::detail {

/// Each point belongs to the nearest of some centres, which are spread by farthest-point sampling.
class ShapePatches {
 public:
  struct Patch {
    Eigen::VectorXf centre;
    float radius = 0;
    std::vector<Index> members;
  };

  /// points   coordinates x n, at least one
  ShapePatches(const Eigen::MatrixXf& points, Index count) : points_(&points) {
    const Index n = points.cols();
    std::vector<Index> nearest(std::size_t(n), 0);
    Eigen::ArrayXf square = Eigen::ArrayXf::Constant(n, std::numeric_limits<float>::max());
    Index next = 0;
    for (Index k = 0; k < std::min(count, n); ++k) {
      patches_.push_back({points.col(next), 0, {}});
      for (Index i = 0; i < n; ++i) {
        const float d = (points.col(i) - patches_.back().centre).squaredNorm();
        if (d < square[i]) square[i] = d, nearest[std::size_t(i)] = k;
      }
      square.maxCoeff(&next);
    }
    for (Index i = 0; i < n; ++i) {
      Patch& patch = patches_[std::size_t(nearest[std::size_t(i)])];
      patch.members.push_back(i);
      patch.radius = std::max(patch.radius, std::sqrt(square[i]));
    }
  }

  const std::vector<Patch>& patches() const { return patches_; }
  /// No member of the patch is closer to the place than this.
  static float gap(const Patch& patch, const Eigen::Ref<const Eigen::VectorXf>& place) {
    return std::max(0.0f, (patch.centre - place).norm() - patch.radius) * (1 - 1e-5f);
  }

  /// The `count` points nearest to a place, at most all.
  std::vector<Index> nearest(const Eigen::Ref<const Eigen::VectorXf>& place, Index count) const {
    std::vector<std::pair<float, std::size_t>> gaps;
    for (std::size_t k = 0; k < patches_.size(); ++k) gaps.emplace_back(gap(patches_[k], place), k);
    std::sort(gaps.begin(), gaps.end());
    std::vector<std::pair<float, Index>> best;  // squares, a heap with the farthest on top
    for (const auto& [least, k] : gaps) {
      if (Index(best.size()) == count && least * least > best.front().first) break;
      for (const Index i : patches_[k].members) {
        const std::pair<float, Index> candidate{(points_->col(i) - place).squaredNorm(), i};
        if (Index(best.size()) == count) {
          if (!(candidate < best.front())) continue;
          std::pop_heap(best.begin(), best.end());
          best.pop_back();
        }
        best.push_back(candidate);
        std::push_heap(best.begin(), best.end());
      }
    }
    std::sort(best.begin(), best.end());
    std::vector<Index> out;
    for (const auto& [square, i] : best) out.push_back(i);
    return out;
  }

 private:
  const Eigen::MatrixXf* points_;
  std::vector<Patch> patches_;
};

/// Places for local functions among the points: farthest-point sampling in shape, where a distance counts more by a power of
/// the mean square of the fields over the patch.
/// fields   C x n
/// shape    coordinates x n
inline std::vector<Index> centres_for(const Eigen::MatrixXf& fields, const Eigen::MatrixXf& shape, Index count,
                                      double power) {
  const ShapePatches patches(shape, 300);
  const double mean = double(fields.squaredNorm()) / double(fields.cols());
  struct Front {
    float weight, farthest;
    Index point;  // the farthest one
  };
  std::vector<Front> fronts;
  Eigen::ArrayXf square = Eigen::ArrayXf::Constant(shape.cols(), std::numeric_limits<float>::max());
  for (const ShapePatches::Patch& patch : patches.patches()) {
    double sum = 0;
    for (const Index i : patch.members) sum += double(fields.col(i).squaredNorm()) / double(patch.members.size());
    fronts.push_back({float(std::pow(sum / (mean + 1e-30) + 1e-3, 2 * power)), std::numeric_limits<float>::max(),
                      patch.members.front()});
  }
  std::vector<Index> out;
  while (Index(out.size()) < count) {
    const Front& first = *std::max_element(fronts.begin(), fronts.end(), [](const Front& a, const Front& b) {
      return double(a.weight) * double(a.farthest) < double(b.weight) * double(b.farthest);
    });
    out.push_back(first.point);
    const Eigen::VectorXf place = shape.col(first.point);
    for (std::size_t k = 0; k < fronts.size(); ++k) {
      const ShapePatches::Patch& patch = patches.patches()[k];
      const float gap = ShapePatches::gap(patch, place);
      if (gap * gap > fronts[k].farthest) continue;
      fronts[k].farthest = -1;
      for (const Index i : patch.members) {
        square[i] = std::min(square[i], (shape.col(i) - place).squaredNorm());
        if (square[i] > fronts[k].farthest) fronts[k].farthest = square[i], fronts[k].point = i;
      }
    }
  }
  return out;
}

}  // namespace dsns::detail
