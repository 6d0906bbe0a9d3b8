#pragma once
/// A moving surface F(s, t) that is a network: encoding, perceptron, then the units of the data. Exact derivatives in s
/// and t. A point at a time goes through any scalar (the oracle); many points go in tiles through matrix products.
#include <dsns/nn/encodings.hpp>
#include <dsns/nn/mlp.hpp>
#include <dsns/surface/jets.hpp>

#include <algorithm>
#include <initializer_list>
#include <utility>

namespace dsns {

/// F(s, t) = translation + scale * network(encoding(s, t)), the network and its encoding in the precision T.
/// accuracy batches equal the scalar path to 1e-12 of the scale in double precision; in single precision derivatives of each
///          order to 2e-5 of the largest of that order [nn/neural_surface_test]
template <class T>
class BasicNeuralSurface {
 public:
  using Matrix = Eigen::MatrixX<T>;

  /// throws   InvalidArgument where the network does not take the encoding's features to three coordinates
  BasicNeuralSurface(const SurfaceEncoding& encoding, Mlp<T> network, const Vec3d& translation = Vec3d::Zero(),
                     double scale = 1)
      : encoding_(encoding), network_(std::move(network)), translation_(translation), scale_(scale) {
    require(network_.shape().inputs == encoding.features() && network_.shape().outputs == 3,
            "NeuralSurface: the encoding has ", encoding.features(), " features, the network ", network_.shape().inputs,
            " inputs and ", network_.shape().outputs, " outputs; give it 3 outputs");
  }

  const SurfaceEncoding& encoding() const { return encoding_; }
  const Mlp<T>& network() const { return network_; }
  const Vec3d& translation() const { return translation_; }
  double scale() const { return scale_; }

  /// One point, any scalar: the oracle of the batches.
  template <class X>
  Vec3<X> operator()(const Vec3<X>& s, const X& t) const {
    Eigen::VectorX<X> x(encoding_.features());
    x << encoding_.space(s), encoding_.time(t);
    const Eigen::VectorX<X> y = network_(x);
    Vec3<X> p;
    for (Index k = 0; k < 3; ++k) p[k] = translation_[k] + scale_ * y[k];
    return p;
  }

  /// F at the columns of s and one time, 3 x n.
  Mat3X positions(const Mat3X& s, double t) const {
    Mat3X f(3, s.cols());
    evaluate(charts_without_frames(s), t, jet_layouts::value, {&f});
    return f;
  }
  /// dF/dt, length unit per clip, 3 x n.
  Mat3X velocities(const Mat3X& s, double t) const {
    Mat3X f(3, s.cols()), ft(3, s.cols());
    evaluate(charts_without_frames(s), t, jet_layouts::rate, {&f, &ft});
    return ft;
  }
  /// Values and first derivatives in space at n charts and one time.
  SurfaceTangents tangents(const ChartBatch& charts, double t) const {
    SurfaceTangents out(charts.size());
    evaluate(charts, t, jet_layouts::tangents, {&out.f, &out.fu, &out.fv});
    return out;
  }
  /// 2-jets in space at n charts and one time.
  SurfaceJets jets(const ChartBatch& charts, double t) const {
    SurfaceJets out(charts.size());
    evaluate(charts, t, jet_layouts::second, {&out.f, &out.fu, &out.fv, &out.fuu, &out.fuv, &out.fvv});
    return out;
  }
  /// Values and velocities with their derivatives in space.
  MotionJets motion_jets(const ChartBatch& charts, double t) const {
    MotionJets out(charts.size());
    evaluate(charts, t, jet_layouts::motion, {&out.f, &out.fu, &out.fv, &out.ft, &out.ftu, &out.ftv});
    return out;
  }

 private:
  static ChartBatch charts_without_frames(const Mat3X& s) { return {s, {}, {}}; }

  /// Fields of the layout's blocks, tile by tile: small enough that the activations of a layer stay in cache.
  void evaluate(const ChartBatch& charts, double t, const JetLayout& layout,
                std::initializer_list<Mat3X*> fields) const {
    const Index tile = 192 / layout.blocks();
    Matrix x;
    for (Index first = 0; first < charts.size(); first += tile) {
      const Index n = std::min(tile, charts.size() - first);
      x.resize(encoding_.features(), n * layout.blocks());
      encoding_.fill(charts, first, n, t, layout, x);
      const Matrix y = network_.columns(x, layout);
      Index block = 0;
      for (Mat3X* field : fields)
        field->middleCols(first, n) = scale_ * y.middleCols(block++ * n, n).template cast<double>();
      (*fields.begin())->middleCols(first, n).colwise() += translation_;
    }
  }

  SurfaceEncoding encoding_;
  Mlp<T> network_;
  Vec3d translation_;
  double scale_;
};

using NeuralSurface = BasicNeuralSurface<double>;

static_assert(AnimatedSurface<NeuralSurface> && AnimatedSurface<BasicNeuralSurface<float>>);

}  // namespace dsns
