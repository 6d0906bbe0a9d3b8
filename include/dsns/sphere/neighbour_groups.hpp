#pragma once
/// Points of the sphere in groups of neighbours, each of which can be treated as one.
#include <dsns/core/types.hpp>

#include <algorithm>
#include <numeric>
#include <span>
#include <vector>

namespace dsns::detail {

/// The indices of the columns of s in groups of neighbours, each at most `most`: halves of halves along the longest axis.
class NeighbourGroups {
 public:
  NeighbourGroups(const Mat3X& s, Index most) : order_(std::size_t(s.cols())) {
    std::iota(order_.begin(), order_.end(), Index(0));
    if (!order_.empty()) split(s, 0, order_.size(), std::size_t(most));
  }

  Index size() const { return Index(starts_.size()); }
  std::span<const Index> operator[](Index g) const {
    const std::size_t k = std::size_t(g), end = k + 1 < starts_.size() ? starts_[k + 1] : order_.size();
    return std::span(order_).subspan(starts_[k], end - starts_[k]);
  }

 private:
  void split(const Mat3X& s, std::size_t first, std::size_t last, std::size_t most) {
    if (last - first <= most) {
      starts_.push_back(first);
      return;
    }
    Vec3d low = s.col(order_[first]), high = low;
    for (std::size_t k = first; k < last; ++k) {
      low = low.cwiseMin(s.col(order_[k]));
      high = high.cwiseMax(s.col(order_[k]));
    }
    Index axis = 0;
    (high - low).maxCoeff(&axis);
    const auto at = [&](std::size_t k) { return order_.begin() + std::ptrdiff_t(k); };
    const std::size_t middle = first + (last - first) / 2;
    std::nth_element(at(first), at(middle), at(last),
                     [&](Index a, Index b) { return s(axis, a) != s(axis, b) ? s(axis, a) < s(axis, b) : a < b; });
    split(s, first, middle, most);
    split(s, middle, last, most);
  }

  std::vector<Index> order_;
  std::vector<std::size_t> starts_;
};

}  // namespace dsns::detail
