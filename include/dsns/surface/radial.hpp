#pragma once
/// Sums of local functions on the sphere, each round in a metric of its own: f(s) = sum_j c_j phi(|W_j (s - p_j)|), with
///   phi(r) = (1 - r)^6 (35 r^2 + 18 r + 3) / 3,   0 from r = 1 on,
/// Wendland's function of three variables with four continuous derivatives, at the centres and at the supports' edges too.
/// Where harmonics are equally fine everywhere, these are as fine as their centres are dense and as long as W_j lets
/// them be: fingers, which a sphere map squeezes to slivers.
/// source   H. Wendland, Piecewise polynomial, positive definite and compactly supported radial functions of minimal
///          degree, Adv. Comput. Math. 4, 1995
#include <dsns/sphere/harmonics.hpp>
#include <dsns/sphere/neighbour_groups.hpp>
#include <dsns/surface/jets.hpp>

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <numeric>
#include <span>
#include <vector>

namespace dsns {

/// The functions of a basis that do not vanish at all of some points, and their values there, points x functions: the
/// value, with order 1 also the derivatives in the charts along u and v, with order 2 also along uu, uv and vv.
template <int order>
struct RadialValues {
  std::vector<Index> functions;
  std::array<Eigen::MatrixXd, order == 0 ? 1 : (order == 1 ? 3 : 6)> parts;  // with room for more columns

  auto part(std::size_t k) const { return parts[k].leftCols(Index(functions.size())); }
};

/// n local functions on the sphere.
class RadialBasis {
 public:
  using Metrics = Eigen::Matrix<double, 9, Eigen::Dynamic>;

  RadialBasis() = default;
  /// centres  3 x n unit vectors
  /// metrics  W_j as columns, 9 x n; a function's support is |W_j (s - p_j)| < 1
  /// throws   InvalidArgument where numbers differ, a metric is singular or a centre not a unit vector
  RadialBasis(Mat3X centres, Metrics metrics) : centres_(std::move(centres)), metrics_(std::move(metrics)) {
    require(centres_.cols() == metrics_.cols(), "RadialBasis: ", centres_.cols(), " centres, ", metrics_.cols(),
            " metrics");
    const Index n = size();
    low_.resize(3, n), high_.resize(3, n);
    for (Index j = 0; j < n; ++j) {
      require(std::abs(centres_.col(j).norm() - 1) < 1e-9, "RadialBasis: centre ", j, " has length ",
              centres_.col(j).norm(), ", normalise the centres first");
      const Mat3 inverse = metric(j).inverse();
      require(inverse.allFinite(), "RadialBasis: metric ", j, " is singular, give every direction a length");
      const Vec3d half = inverse.rowwise().norm();  // the support is an ellipsoid, the image of the unit ball
      low_.col(j) = centres_.col(j) - half;
      high_.col(j) = centres_.col(j) + half;
    }
    order_.resize(std::size_t(n));
    std::iota(order_.begin(), order_.end(), Index(0));
    if (n > 0) build(0, order_.size());
  }

  Index size() const { return centres_.cols(); }
  const Mat3X& centres() const { return centres_; }
  const Metrics& metrics() const { return metrics_; }
  Eigen::Map<const Mat3> metric(Index j) const { return Eigen::Map<const Mat3>(metrics_.col(j).data()); }

  /// At some columns of c, which had better be neighbours: all functions near one of them are evaluated at all.
  /// storage  an earlier result, whose memory is used again
  /// accuracy 1e-12 of the largest entry, at centres, edges and poles too, against 2-jets [surface/radial_test]
  template <int order>
  RadialValues<order> at(const detail::ChartColumns& c, std::span<const Index> points,
                         RadialValues<order> storage = {}) const {
    const Index n = Index(points.size());
    std::array<Eigen::ArrayX3d, order == 0 ? 1 : 3> frame;
    const std::array<const Mat3X*, 3> sources{&c.s, &c.e1, &c.e2};
    for (std::size_t k = 0; k < frame.size(); ++k) {
      frame[k].resize(n, 3);
      for (Index i = 0; i < n; ++i) frame[k].row(i) = sources[k]->col(points[std::size_t(i)]).transpose().array();
    }
    RadialValues<order> out = std::move(storage);
    find_near(frame[0].colwise().minCoeff(), frame[0].colwise().maxCoeff(), out.functions);
    for (Eigen::MatrixXd& part : out.parts)
      if (part.rows() != n || part.cols() < Index(out.functions.size())) part.resize(n, Index(out.functions.size()));
    std::size_t kept = 0;
    for (const Index j : out.functions)
      if (fill<order>(j, frame, out.parts, Index(kept))) out.functions[kept++] = j;
    out.functions.resize(kept);
    return out;
  }

 private:
  /// A box around supports. Leaves have no right child; the left child is the next node.
  struct Node {
    Vec3d low, high;
    std::size_t first, last, right;
  };

  void build(std::size_t first, std::size_t last) {
    const std::size_t index = nodes_.size();
    nodes_.push_back({low_.col(order_[first]), high_.col(order_[first]), first, last, 0});
    for (std::size_t k = first; k < last; ++k) {
      nodes_[index].low = nodes_[index].low.cwiseMin(low_.col(order_[k]));
      nodes_[index].high = nodes_[index].high.cwiseMax(high_.col(order_[k]));
    }
    if (last - first <= 4) return;
    Index axis = 0;
    (nodes_[index].high - nodes_[index].low).maxCoeff(&axis);
    const auto at = [&](std::size_t k) { return order_.begin() + std::ptrdiff_t(k); };
    const std::size_t middle = first + (last - first) / 2;
    std::nth_element(at(first), at(middle), at(last), [&](Index a, Index b) {
      return centres_(axis, a) != centres_(axis, b) ? centres_(axis, a) < centres_(axis, b) : a < b;
    });
    build(first, middle);
    nodes_[index].right = nodes_.size();
    build(middle, last);
  }

  /// Functions whose supports' boxes meet a box, in increasing order.
  void find_near(const Vec3d& low, const Vec3d& high, std::vector<Index>& near) const {
    near.clear();
    const auto apart = [&](const auto& a, const auto& b) {
      return (a.array() > high.array()).any() || (b.array() < low.array()).any();
    };
    for (std::size_t k = 0; k < nodes_.size();) {
      const Node& node = nodes_[k];
      const bool skip = apart(node.low, node.high);
      if (node.right == 0 && !skip)
        for (std::size_t l = node.first; l < node.last; ++l)
          if (!apart(low_.col(order_[l]), high_.col(order_[l]))) near.push_back(order_[l]);
      k = skip ? node_after(k) : k + 1;
    }
    std::sort(near.begin(), near.end());
  }
  /// The next node in preorder that is not below node k: a tree over m functions has a number of nodes that m determines.
  std::size_t node_after(std::size_t k) const { return k + node_count(nodes_[k].last - nodes_[k].first); }
  static std::size_t node_count(std::size_t functions) {
    return functions <= 4 ? 1 : 1 + node_count(functions / 2) + node_count(functions - functions / 2);
  }

  /// Column k of every part: function j. With q = r^2 and x = W (s - p),
  ///   phi_q = -28/3 (1 - r)^5 (5 r + 1),  phi_qq = 140 (1 - r)^4,  q_u = 2 x . W e1,  q_uv = 2 W e1 . W e2,
  ///   q_uu = 2 W e1 . W e1 - 2 x . W s.
  /// returns  whether some point is in the support
  template <int order, class Frame, class Parts>
  bool fill(Index j, const Frame& frame, Parts& parts, Index k) const {
    const Mat3 w = metric(j).transpose();
    const auto mapped = [&](const auto& rows) { return (rows.matrix() * w).eval(); };
    const auto dot = [](const auto& a, const auto& b) {
      return (a.col(0).array() * b.col(0).array() + a.col(1).array() * b.col(1).array() +
              a.col(2).array() * b.col(2).array())
          .eval();
    };
    const Eigen::MatrixX3d x = mapped(frame[0].rowwise() - centres_.col(j).transpose().array());
    const Eigen::ArrayXd q = dot(x, x);
    if (!(q.minCoeff() < 1)) return false;
    const Eigen::ArrayXd r = q.sqrt(), d = (1 - r).max(0), d2 = d.square(), d4 = d2.square();
    parts[0].col(k) = d4 * d2 * (35 * q + 18 * r + 3) / 3;
    if constexpr (order > 0) {
      const Eigen::MatrixX3d a = mapped(frame[1]), b = mapped(frame[2]);
      const Eigen::ArrayXd slope = (-28.0 / 3) * d4 * d * (5 * r + 1), qu = 2 * dot(x, a), qv = 2 * dot(x, b);
      parts[1].col(k) = slope * qu;
      parts[2].col(k) = slope * qv;
      if constexpr (order > 1) {
        const Eigen::MatrixX3d s = mapped(frame[0]);
        const Eigen::ArrayXd bend = 140 * d4, down = dot(x, s);
        parts[3].col(k) = bend * qu * qu + 2 * slope * (dot(a, a) - down);
        parts[4].col(k) = bend * qu * qv + 2 * slope * dot(a, b);
        parts[5].col(k) = bend * qv * qv + 2 * slope * (dot(b, b) - down);
      }
    }
    return true;
  }

  Mat3X centres_;
  Metrics metrics_;
  Mat3X low_, high_;          // boxes around the supports
  std::vector<Index> order_;  // functions, those of a node contiguous
  std::vector<Node> nodes_;
};

namespace detail {

template <int order, int C>
auto radial_sums(const RadialBasis& basis, const HarmonicCoefficients<C>& coefficients, const ChartColumns& c) {
  require(coefficients.rows() == basis.size(), "radial_sum: ", coefficients.rows(), " coefficients for ", basis.size(),
          " functions");
  constexpr std::size_t count = std::tuple_size_v<decltype(RadialValues<order>::parts)>;
  std::array<FunctionValues<C>, count> out;
  out.fill(FunctionValues<C>::Zero(coefficients.cols(), c.s.cols()));
  const NeighbourGroups groups(c.s, 32);
  RadialValues<order> values;
  HarmonicCoefficients<C> near;
  for (Index g = 0; g < groups.size(); ++g) {
    values = basis.at<order>(c, groups[g], std::move(values));
    near.resize(Index(values.functions.size()), coefficients.cols());
    for (Index k = 0; k < near.rows(); ++k) near.row(k) = coefficients.row(values.functions[std::size_t(k)]);
    for (std::size_t p = 0; p < count; ++p) {
      const FunctionValues<C> sums = near.transpose() * values.part(p).transpose();
      for (Index i = 0; i < sums.cols(); ++i) out[p].col(groups[g][std::size_t(i)]) = sums.col(i);
    }
  }
  return out;
}

}  // namespace detail

/// sum over j of c_j times function j at the n unit columns of s, for C functions at once: C x n. Costs the overlaps of the
/// supports with the points, not the size of the basis.
/// throws   InvalidArgument unless there is a row of coefficients for every function; so do the next two
template <int C>
FunctionValues<C> radial_sum(const RadialBasis& basis, const HarmonicCoefficients<C>& coefficients, const Mat3X& s) {
  return std::move(detail::radial_sums<0, C>(basis, coefficients, {s, s, s})[0]);
}

/// The same with first derivatives in n charts.
template <int C>
FunctionTangents<C> radial_sum_tangents(const RadialBasis& basis, const HarmonicCoefficients<C>& coefficients,
                                        const ChartBatch& c) {
  auto [f, fu, fv] = detail::radial_sums<1, C>(basis, coefficients, {c.s, c.e1, c.e2});
  return {std::move(f), std::move(fu), std::move(fv)};
}

/// The same with first and second derivatives in n charts.
template <int C>
FunctionJets<C> radial_sum_jets(const RadialBasis& basis, const HarmonicCoefficients<C>& coefficients,
                                const ChartBatch& c) {
  auto [f, fu, fv, fuu, fuv, fvv] = detail::radial_sums<2, C>(basis, coefficients, {c.s, c.e1, c.e2});
  return {std::move(f), std::move(fu), std::move(fv), std::move(fuu), std::move(fuv), std::move(fvv)};
}

/// C functions as sums of those of a basis; coefficients n x C.
struct RadialSum {
  RadialBasis basis;
  Eigen::MatrixXd coefficients;
};

/// A resting surface whose coordinates are sums of local functions, n x 3 coefficients.
class RadialSurface {
 public:
  RadialSurface(RadialBasis basis, Eigen::MatrixX3d coefficients)
      : basis_(std::move(basis)), coefficients_(std::move(coefficients)) {
    require(coefficients_.rows() == basis_.size(), "RadialSurface: ", coefficients_.rows(), " coefficients for ",
            basis_.size(), " functions");
  }

  const RadialBasis& basis() const { return basis_; }
  const Eigen::MatrixX3d& coefficients() const { return coefficients_; }

  Vec3d operator()(const Vec3d& s) const { return positions(Mat3X(s)); }
  Mat3X positions(const Mat3X& s) const { return radial_sum<3>(basis_, coefficients_, s); }
  SurfaceTangents tangents(const ChartBatch& c) const {
    auto [f, fu, fv] = radial_sum_tangents<3>(basis_, coefficients_, c);
    SurfaceTangents out(0);
    out.f = std::move(f), out.fu = std::move(fu), out.fv = std::move(fv);
    return out;
  }
  SurfaceJets jets(const ChartBatch& c) const {
    auto [f, fu, fv, fuu, fuv, fvv] = radial_sum_jets<3>(basis_, coefficients_, c);
    SurfaceJets out(0);
    out.f = std::move(f), out.fu = std::move(fu), out.fv = std::move(fv);
    out.fuu = std::move(fuu), out.fuv = std::move(fuv), out.fvv = std::move(fvv);
    return out;
  }

 private:
  RadialBasis basis_;
  Eigen::MatrixX3d coefficients_;
};

static_assert(Surface<RadialSurface>);

}  // namespace dsns
