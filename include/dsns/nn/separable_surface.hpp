#pragma once
/// Moving surfaces as a sum of products: F(s, t) = translation + scale sum_k a_k(t) g_k(s). The few functions of time come
/// from the data, as its principal components over the frames; the fields g_k are sums of spherical harmonics, of local
/// functions, and of one network that has all of them as outputs. Space is evaluated once for all times, and at one time
/// the sum over k is taken in the coefficients before space is evaluated: a SeparableSurface costs what a resting one does.
#include <dsns/core/spline.hpp>
#include <dsns/nn/neural_surface.hpp>
#include <dsns/surface/harmonic.hpp>
#include <dsns/surface/radial.hpp>

#include <optional>
#include <utility>

namespace dsns {

/// M functions of time on [0, 1], each a spline through its values at knots.
class TemporalModes {
 public:
  /// values   knots x M, the knots equidistant
  explicit TemporalModes(Eigen::MatrixXd values) : values_(std::move(values)), spline_(values_.rows()) {}
  /// times    of the knots, increasing
  TemporalModes(Eigen::MatrixXd values, std::vector<double> times)
      : values_(std::move(values)), spline_(std::move(times)) {
    require(spline_.knots() == values_.rows(), "TemporalModes: ", values_.rows(), " values at ", spline_.knots(),
            " times");
  }

  Index modes() const { return values_.cols(); }
  const std::vector<double>& times() const { return spline_.times(); }
  const Eigen::MatrixXd& values() const { return values_; }
  /// a(t), M values.
  Eigen::VectorXd operator()(double t) const { return values_.transpose() * spline_.weights(t); }
  /// a'(t), per clip.
  Eigen::VectorXd derivative(double t) const { return values_.transpose() * spline_.derivative_weights(t); }

 private:
  Eigen::MatrixXd values_;
  CubicSpline spline_;
};

/// The parts of a separable surface, each of 3 M functions on the sphere: x, y and z of the first mode, of the second, ...
/// T is the precision of the network.
template <class T = double>
class BasicSeparableSurface {
 public:
  /// harmonics  coefficients (degree + 1)^2 x 3 M, or without rows
  /// network    of the encoding's features, which has none of time, with 3 M outputs; or none
  /// radial     local functions with coefficients for 3 M functions, or an empty basis
  /// throws     InvalidArgument where they do not fit
  BasicSeparableSurface(TemporalModes time, Eigen::MatrixXd harmonics, const SurfaceEncoding& encoding,
                        std::optional<Mlp<T>> network, const Vec3d& translation = Vec3d::Zero(), double scale = 1,
                        RadialSum radial = {})
      : time_(std::move(time)),
        harmonics_(std::move(harmonics)),
        encoding_(encoding),
        network_(std::move(network)),
        translation_(translation),
        scale_(scale),
        radial_(std::move(radial)) {
    const Index outputs = 3 * time_.modes();
    require(harmonics_.rows() == 0 || harmonics_.cols() == outputs, "SeparableSurface: harmonics of ",
            harmonics_.cols(), " functions for ", time_.modes(), " modes, give three a mode");
    require(radial_.basis.size() == radial_.coefficients.rows() &&
                (radial_.basis.size() == 0 || radial_.coefficients.cols() == outputs),
            "SeparableSurface: ", radial_.basis.size(), " local functions with ", radial_.coefficients.rows(), " x ",
            radial_.coefficients.cols(), " coefficients for ", time_.modes(), " modes, give three a mode");
    require(!network_ || (network_->shape().outputs == outputs && network_->shape().inputs == encoding.features() &&
                          encoding.time_features() == 0),
            "SeparableSurface: a network of ", network_ ? network_->shape().outputs : 0, " outputs for ", time_.modes(),
            " modes; give it three a mode and an encoding of space alone");
  }

  const TemporalModes& time() const { return time_; }
  const Eigen::MatrixXd& harmonics() const { return harmonics_; }
  const SurfaceEncoding& encoding() const { return encoding_; }
  const std::optional<Mlp<T>>& network() const { return network_; }
  const RadialSum& radial() const { return radial_; }
  const Vec3d& translation() const { return translation_; }
  double scale() const { return scale_; }

  Vec3d operator()(const Vec3d& s, double t) const { return positions(Mat3X(s), t); }
  Mat3X positions(const Mat3X& s, double t) const { return combined(time_(t)).positions(s).colwise() + translation_; }
  Mat3X velocities(const Mat3X& s, double t) const { return combined(time_.derivative(t)).positions(s); }
  SurfaceTangents tangents(const ChartBatch& c, double t) const {
    SurfaceTangents out = combined(time_(t)).tangents(c);
    out.f.colwise() += translation_;
    return out;
  }
  SurfaceJets jets(const ChartBatch& c, double t) const {
    SurfaceJets out = combined(time_(t)).jets(c);
    out.f.colwise() += translation_;
    return out;
  }
  MotionJets motion_jets(const ChartBatch& c, double t) const {
    const SurfaceTangents place = tangents(c, t), rate = combined(time_.derivative(t)).tangents(c);
    MotionJets out(c.size());
    out.f = place.f, out.fu = place.fu, out.fv = place.fv;
    out.ft = rate.f, out.ftu = rate.fu, out.ftv = rate.fv;
    return out;
  }

 private:
  /// sum_k a_k g_k for given a: a resting surface.
  struct Combined {
    std::optional<HarmonicSurface> harmonic;
    const RadialBasis* basis;
    Eigen::MatrixX3d radial;  // of the basis, or without rows
    std::optional<BasicNeuralSurface<T>> network;

    Mat3X positions(const Mat3X& s) const {
      Mat3X out = Mat3X::Zero(3, s.cols());
      if (harmonic) out += harmonic->positions(s);
      if (radial.rows() > 0) out += radial_sum<3>(*basis, radial, s);
      if (network) out += network->positions(s, 0);
      return out;
    }
    SurfaceTangents tangents(const ChartBatch& c) const {
      SurfaceTangents out(c.size());
      out.f.setZero(), out.fu.setZero(), out.fv.setZero();
      const auto add = [&](const auto& j) { out.f += j.f, out.fu += j.fu, out.fv += j.fv; };
      if (harmonic) add(dsns::tangents(*harmonic, c));
      if (radial.rows() > 0) add(radial_sum_tangents<3>(*basis, radial, c));
      if (network) add(network->tangents(c, 0));
      return out;
    }
    SurfaceJets jets(const ChartBatch& c) const {
      SurfaceJets out(c.size());
      for (Mat3X* field : {&out.f, &out.fu, &out.fv, &out.fuu, &out.fuv, &out.fvv}) field->setZero();
      const auto add = [&](const auto& j) {
        out.f += j.f, out.fu += j.fu, out.fv += j.fv;
        out.fuu += j.fuu, out.fuv += j.fuv, out.fvv += j.fvv;
      };
      if (harmonic) add(dsns::jets(*harmonic, c));
      if (radial.rows() > 0) add(radial_sum_jets<3>(*basis, radial, c));
      if (network) add(network->jets(c, 0));
      return out;
    }
  };

  Combined combined(const Eigen::VectorXd& a) const {
    const auto contracted = [&](const Eigen::MatrixXd& coefficients) {
      Eigen::MatrixX3d c = Eigen::MatrixX3d::Zero(coefficients.rows(), 3);
      if (c.rows() > 0)
        for (Index k = 0; k < a.size(); ++k) c += (scale_ * a[k]) * coefficients.middleCols(3 * k, 3);
      return c;
    };
    Combined out{{}, &radial_.basis, contracted(radial_.coefficients), {}};
    if (harmonics_.rows() > 0) out.harmonic.emplace(contracted(harmonics_));
    if (network_) {
      MlpShape shape = network_->shape();
      const int last = shape.layers() - 1, width = shape.cols(last);
      const Index body = shape.offset(last), rows = shape.outputs;
      shape.outputs = 3;
      Eigen::VectorX<T> parameters = Eigen::VectorX<T>::Zero(shape.parameter_count());
      parameters.head(body) = network_->parameters().head(body);
      const Eigen::Map<const Eigen::MatrixX<T>> head(network_->parameters().data() + body, rows, width + 1);
      Eigen::Map<Eigen::MatrixX<T>> three(parameters.data() + body, 3, width + 1);  // weights, then the bias
      for (Index k = 0; k < a.size(); ++k) three += T(a[k]) * head.middleRows(3 * k, 3);
      out.network.emplace(encoding_, Mlp<T>(shape, std::move(parameters)), Vec3d::Zero(), scale_);
    }
    return out;
  }

  TemporalModes time_;
  Eigen::MatrixXd harmonics_;
  SurfaceEncoding encoding_;
  std::optional<Mlp<T>> network_;
  Vec3d translation_;
  double scale_;
  RadialSum radial_;
};

using SeparableSurface = BasicSeparableSurface<double>;

static_assert(AnimatedSurface<SeparableSurface> && AnimatedSurface<BasicSeparableSurface<float>>);

}  // namespace dsns
