#pragma once
/// A moving surface F(s, t) that is a network: encoding, perceptron, then the units of the data. Exact derivatives in s
/// and t. A point at a time goes through any scalar (the oracle); many points go in tiles through matrix products.
#include <dsns/nn/encodings.hpp>
#include <dsns/nn/mlp.hpp>
#include <dsns/surface/jets.hpp>

#include <algorithm>
#include <utility>

namespace dsns {

/// F(s, t) = translation + scale * network(encoding(s, t)).
/// accuracy batches equal the scalar path to 1e-12 of the scale [nn/neural_surface_test]
class NeuralSurface {
 public:
  /// throws   InvalidArgument where the network does not take the encoding's features to three coordinates
  NeuralSurface(const SurfaceEncoding& encoding, Mlp<double> network, const Vec3d& translation = Vec3d::Zero(),
                double scale = 1)
      : encoding_(encoding), network_(std::move(network)), translation_(translation), scale_(scale) {
    require(network_.shape().inputs == encoding.features() && network_.shape().outputs == 3,
            "NeuralSurface: the encoding has ", encoding.features(), " features, the network ", network_.shape().inputs,
            " inputs and ", network_.shape().outputs, " outputs; give it 3 outputs");
  }

  const SurfaceEncoding& encoding() const { return encoding_; }
  const Mlp<double>& network() const { return network_; }
  const Vec3d& translation() const { return translation_; }
  double scale() const { return scale_; }

  template <class T>
  Vec3<T> operator()(const Vec3<T>& s, const T& t) const {
    Eigen::VectorX<T> x(encoding_.features());
    x << encoding_.space(s), encoding_.time(t);
    const Eigen::VectorX<T> y = network_(x);
    Vec3<T> p;
    for (Index k = 0; k < 3; ++k) p[k] = translation_[k] + scale_ * y[k];
    return p;
  }

  /// F at the columns of s and one time, 3 x n.
  Mat3X positions(const Mat3X& s, double t) const {
    Mat3X out(3, s.cols());
    const Eigen::VectorXd time = encoding_.time(t);
    for_tiles(
        s.cols(), JetOrder::value,
        [&](Index first, Index n, Eigen::MatrixXd& x) {
          for (Index i = 0; i < n; ++i) x.col(i) << encoding_.space(Vec3d(s.col(first + i))), time;
        },
        [&](Index first, Index n, const Eigen::MatrixXd& y) {
          out.middleCols(first, n) = (scale_ * y).colwise() + translation_;
        });
    return out;
  }

  /// dF/dt, length unit per clip, 3 x n.
  Mat3X velocities(const Mat3X& s, double t) const {
    using D = Dual<double, 1>;
    Mat3X out(3, s.cols());
    const Eigen::VectorX<D> time = encoding_.time(D::variable(t, 0));
    const Index space = encoding_.space_features();
    for_tiles(
        s.cols(), JetOrder::tangent,
        [&](Index first, Index n, Eigen::MatrixXd& x) {
          for (Index i = 0; i < n; ++i) x.col(i).head(space) = encoding_.space(Vec3d(s.col(first + i)));
          x.topRightCorner(space, n).setZero();
          for (Index k = 0; k < time.size(); ++k) {
            x.row(space + k).head(n).setConstant(time[k].f);
            x.row(space + k).tail(n).setConstant(time[k].g[0]);
          }
        },
        [&](Index first, Index n, const Eigen::MatrixXd& y) { out.middleCols(first, n) = scale_ * y.rightCols(n); });
    return out;
  }

  /// 2-jets in space at n charts and one time.
  SurfaceJets jets(const ChartBatch& charts, double t) const {
    SurfaceJets out(charts.size());
    const Eigen::VectorXd time = encoding_.time(t);
    const Index space = encoding_.space_features();
    for_tiles(
        charts.size(), JetOrder::second,
        [&](Index first, Index n, Eigen::MatrixXd& x) {
          x.bottomRows(time.size()).setZero();
          x.bottomLeftCorner(time.size(), n).colwise() = time;
          for (Index i = 0; i < n; ++i) {
            const auto jet = encoding_.space(detail::chart_jet(charts, first + i));
            for (Index k = 0; k < space; ++k) {
              const auto& [f, g, h] = jet[k];
              const double blocks[] = {f, g[0], g[1], h[0], h[1], h[2]};
              for (Index b = 0; b < 6; ++b) x(k, b * n + i) = blocks[b];
            }
          }
        },
        [&](Index first, Index n, const Eigen::MatrixXd& y) {
          Mat3X* fields[] = {&out.f, &out.fu, &out.fv, &out.fuu, &out.fuv, &out.fvv};
          for (Index b = 0; b < 6; ++b) fields[b]->middleCols(first, n) = scale_ * y.middleCols(b * n, n);
          out.f.middleCols(first, n).colwise() += translation_;
        });
    return out;
  }

 private:
  /// Tiles small enough that the activations of a layer stay in cache.
  template <class Fill, class Store>
  void for_tiles(Index points, JetOrder order, const Fill& fill, const Store& store) const {
    const Index tile = 192 / Index(order);
    Eigen::MatrixXd x;
    for (Index first = 0; first < points; first += tile) {
      const Index n = std::min(tile, points - first);
      x.resize(encoding_.features(), n * Index(order));
      fill(first, n, x);
      store(first, n, network_.columns(x, order));
    }
  }

  SurfaceEncoding encoding_;
  Mlp<double> network_;
  Vec3d translation_;
  double scale_;
};

static_assert(AnimatedSurface<NeuralSurface>);

}  // namespace dsns
