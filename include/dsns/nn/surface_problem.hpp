#pragma once
/// What a network learns a moving surface from: points of the sphere and times with the surface's position there, and where
/// the loss asks for them its tangents and normals.
#include <dsns/core/parallel.hpp>
#include <dsns/nn/encodings.hpp>
#include <dsns/nn/losses.hpp>
#include <dsns/nn/trainer.hpp>
#include <dsns/nn/training_archive.hpp>
#include <dsns/surface/jets.hpp>

#include <array>
#include <functional>
#include <random>
#include <span>
#include <utility>
#include <vector>

namespace dsns {

/// The loss of a sample in units of the surface's scale, with n the surface's unit normal:
///   |F - f|^2 + tangents (|F_u - f_u|^2 + |F_v - f_v|^2) + normals ((n . F_u)^2 + (n . F_v)^2)
struct LossWeights {
  double tangents = 0;
  double normals = 0;
};

namespace detail {

inline Mat3X uniform_sphere_points(int n, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  Mat3X s(3, n);
  for (double& x : s.reshaped()) x = normal(random);
  return s.colwise().normalized();
}

/// Moving surfaces that find the places of points once for all times, and those that do not.
template <class F>
concept LocatesPoints = requires(const F& f, const Mat3X& s, const ChartBatch& c) {
  { f.positions(f.locate(s), 0.0) } -> std::same_as<Mat3X>;
  { f.jets(f.locate(s), c, 0.0) } -> std::same_as<SurfaceJets>;
};

/// The target's positions at all points, or its tangents at all charts, for each time.
/// With several threads the first time comes first and the others in any order, from any of them.
template <class F, class Visit>
void visit_positions(const F& target, const Mat3X& s, const std::vector<double>& times, const Visit& visit,
                     int threads = 1) {
  const auto all = [&](const auto& positions_at) {
    if (times.empty()) return;
    visit(Index(0), positions_at(times[0]));
    parallel_for(int(times.size()) - 1, threads,
                 [&](int k) { visit(Index(k) + 1, positions_at(times[std::size_t(k) + 1])); });
  };
  if constexpr (LocatesPoints<F>) {
    const auto places = target.locate(s);
    all([&](double t) -> Mat3X { return target.positions(places, t); });
  } else {
    all([&](double t) -> Mat3X { return positions(target, s, t); });
  }
}
template <class F, class Visit>
void visit_tangents(const F& target, const ChartBatch& charts, const std::vector<double>& times, const Visit& visit) {
  if constexpr (LocatesPoints<F>) {
    const auto places = target.locate(charts.s);
    for (std::size_t k = 0; k < times.size(); ++k)
      visit(Index(k), SurfaceTangents(target.jets(places, charts, times[k])));
  } else {
    for (std::size_t k = 0; k < times.size(); ++k) visit(Index(k), tangents(target, charts, times[k]));
  }
}

/// The smallest ball around the mean position that holds all samples: networks learn (F - translation) / scale.
struct SampleBall {
  Vec3d translation = Vec3d::Zero();
  double scale = 1;
};

/// Samples are pairs of a point and a time, numbered time * points + point. The layout says whether tangents are learnt.
template <class T, JetLayout Layout>
class SurfaceProblem {
 public:
  static constexpr JetLayout layout = Layout;
  static_assert(layout.blocks() == 1 || layout.blocks() == 3, "values, or values and tangents");

  /// throws   InvalidArgument where the target is not finite everywhere or one point
  template <AnimatedSurface F>
  SurfaceProblem(const F& target, const SurfaceEncoding& encoding, const Mat3X& points, std::vector<double> times,
                 const LossWeights& weights)
      : points_(points.cols()),
        time_(encoding.time_features(), Index(times.size())),
        with_normals_(weights.normals > 0) {
    weights_.fill(0);
    weights_[0] = 1;
    if constexpr (layout.blocks() == 3) weights_[1] = weights_[2] = weights.tangents;
    normal_weight_ = weights.normals;
    const ChartBatch charts = charts_at(points);
    space_.resize(encoding.space_features(), points_ * layout.blocks());
    encode_space(encoding, charts);
    for (Index k = 0; k < time_.cols(); ++k) time_.col(k) = encoding.time(times[std::size_t(k)]).template cast<T>();
    sample(target, charts, times);
  }

  Index samples() const { return points_ * time_.cols(); }
  const SampleBall& ball() const { return ball_; }
  /// Of all that the training reads.
  std::uint64_t checksum() const {
    std::uint64_t sum = 0;
    for (const auto* m : {&space_, &time_, &targets_, &normals_}) sum = checksum_of(*m, sum);
    return sum;
  }

  void fill(std::span<const Index> samples, Eigen::MatrixX<T>& inputs) const {
    const Index n = Index(samples.size()), rows = space_.rows();
    for (Index j = 0; j < n; ++j) {
      const Index point = samples[std::size_t(j)] % points_, time = samples[std::size_t(j)] / points_;
      for (Index b = 0; b < layout.blocks(); ++b) {
        inputs.col(b * n + j).head(rows) = space_.col(point * layout.blocks() + b);
        if (b == 0)
          inputs.col(j).tail(time_.rows()) = time_.col(time);
        else
          inputs.col(b * n + j).tail(time_.rows()).setZero();
      }
    }
  }

  /// The reported error is the squared distance of the positions divided by three: its mean is the MSD in units of scale^2.
  TileLoss<T> loss(MatrixTape<T>& tape, typename MatrixTape<T>::Node outputs, std::span<const Index> samples) const {
    const Index n = Index(samples.size());
    Eigen::MatrixX<T> target(3, n * layout.blocks());
    for (Index j = 0; j < n; ++j)
      for (Index b = 0; b < layout.blocks(); ++b)
        target.col(b * n + j) = targets_.col(samples[std::size_t(j)] * layout.blocks() + b);
    const double error = double((tape.value(outputs).leftCols(n) - target.leftCols(n)).squaredNorm()) / 3;
    auto node = jet_error<layout>(tape, outputs, target, weights_);
    if constexpr (layout.blocks() == 3) {
      if (with_normals_) {
        Eigen::MatrixX<T> normals(3, n);
        for (Index j = 0; j < n; ++j) normals.col(j) = normals_.col(samples[std::size_t(j)]);
        const auto miss = normal_error<layout>(tape, outputs, normals);
        node = tape.add(node, tape.scale(miss, T(normal_weight_)));
      }
    }
    return {node, error};
  }

 private:
  void encode_space(const SurfaceEncoding& encoding, const ChartBatch& charts) {
    constexpr Index tile = 64;
    Eigen::MatrixX<T> x;
    for (Index first = 0; first < points_; first += tile) {
      const Index n = std::min(tile, points_ - first);
      x.resize(encoding.features(), n * layout.blocks());
      encoding.fill(charts, first, n, 0, layout, x);
      for (Index j = 0; j < n; ++j)
        for (Index b = 0; b < layout.blocks(); ++b)
          space_.col((first + j) * layout.blocks() + b) = x.col(b * n + j).head(space_.rows());
    }
  }

  template <class F>
  void sample(const F& target, const ChartBatch& charts, const std::vector<double>& times) {
    Mat3X all(3, samples() * layout.blocks());
    if (with_normals_) normals_.resize(3, samples());
    const auto column = [&](Index sample, Index block) { return all.col(sample * layout.blocks() + block); };
    if constexpr (layout.blocks() == 1) {
      visit_positions(target, charts.s, times,
                      [&](Index k, const Mat3X& p) { all.middleCols(k * points_, points_) = p; });
    } else {
      visit_tangents(target, charts, times, [&](Index k, const SurfaceTangents& j) {
        const Mat3X* const fields[] = {&j.f, &j.fu, &j.fv};
        for (Index i = 0; i < points_; ++i) {
          for (Index b = 0; b < layout.blocks(); ++b) column(k * points_ + i, b) = fields[b]->col(i);
          if (with_normals_) {
            const Vec3d u = j.fu.col(i), v = j.fv.col(i);
            normals_.col(k * points_ + i) = u.cross(v).normalized().template cast<T>();
          }
        }
      });
    }
    require(all.allFinite(), "fit: the target is not finite everywhere");
    for (Index k = 0; k < samples(); ++k) ball_.translation += column(k, 0) / double(samples());
    ball_.scale = 0;
    for (Index k = 0; k < samples(); ++k) {
      column(k, 0) -= ball_.translation;
      ball_.scale = std::max(ball_.scale, column(k, 0).norm());
    }
    require(ball_.scale > 0, "fit: the target is one point");
    targets_ = (all / ball_.scale).template cast<T>();
  }

  Index points_;
  Eigen::MatrixX<T> space_, time_;  // features x (points blocks), the blocks of a point side by side; features x times
  Eigen::MatrixX<T> targets_;       // 3 x (samples blocks)
  Eigen::MatrixX<T> normals_;       // 3 x samples
  SampleBall ball_;
  BlockWeights<Layout> weights_;
  double normal_weight_ = 0;
  bool with_normals_;
};

}  // namespace detail

}  // namespace dsns
