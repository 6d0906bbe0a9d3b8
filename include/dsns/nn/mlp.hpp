#pragma once
/// Multilayer perceptron with residual blocks: x -> a(W x + b), then blocks x -> a(W2 a(W1 x + b1) + b2 + x), then a
/// linear output. Two ways through it: one point with any scalar (the oracle, and the way of Dual, Jet2 and Var), and
/// columns of many points by matrix products, where first and second derivatives ride along as further columns.
#include <dsns/autodiff/jet_layout.hpp>
#include <dsns/autodiff/matrix_jets.hpp>
#include <dsns/core/types.hpp>
#include <dsns/nn/activations.hpp>
#include <dsns/optim/optimizer.hpp>

#include <cstdint>
#include <random>
#include <type_traits>
#include <vector>

namespace dsns {

struct MlpShape {
  int inputs = 4;
  int width = 64;
  int blocks = 2;
  int outputs = 3;
  Activation activation = Activation::silu;

  int layers() const { return 2 + 2 * blocks; }
  int rows(int layer) const { return layer + 1 == layers() ? outputs : width; }
  int cols(int layer) const { return layer == 0 ? inputs : width; }
  /// Where the weights of a layer begin; its bias follows them.
  Index offset(int layer) const {
    Index n = 0;
    for (int l = 0; l < layer; ++l) n += Index(rows(l)) * (cols(l) + 1);
    return n;
  }
  Index parameter_count() const { return offset(layers()); }
  /// The weights and biases in the order of the parameters.
  std::vector<ParameterBlock> blocks_of_parameters() const {
    std::vector<ParameterBlock> out;
    for (int l = 0; l < layers(); ++l) {
      const Index weights = Index(rows(l)) * cols(l);
      out.push_back({offset(l), rows(l), cols(l)});
      out.push_back({offset(l) + weights, rows(l), 1});
    }
    return out;
  }
};

/// T is the type of the parameters.
template <class T>
class Mlp {
 public:
  using Matrix = Eigen::MatrixX<T>;
  using Vector = Eigen::VectorX<T>;

  /// Weights and biases uniform in +-1 / sqrt(inputs of the layer); the same seed gives the same network.
  /// throws   InvalidArgument for a shape without inputs, width or outputs
  explicit Mlp(const MlpShape& shape, std::uint64_t seed = 0) : shape_(shape) {
    require(shape.inputs > 0 && shape.width > 0 && shape.blocks >= 0 && shape.outputs > 0, "Mlp: ", shape.inputs,
            " inputs, width ", shape.width, ", ", shape.blocks, " blocks, ", shape.outputs, " outputs");
    parameters_.resize(shape.parameter_count());
    std::mt19937_64 random(seed);
    for (int l = 0; l < shape.layers(); ++l) {
      const double bound = 1 / std::sqrt(double(shape.cols(l)));
      std::uniform_real_distribution<double> uniform(-bound, bound);
      for (Index k = shape.offset(l); k < shape.offset(l + 1); ++k) parameters_[k] = T(uniform(random));
    }
  }
  Mlp(const MlpShape& shape, Vector parameters) : shape_(shape), parameters_(std::move(parameters)) {
    require(parameters_.size() == shape.parameter_count(), "Mlp: ", parameters_.size(), " parameters for a shape of ",
            shape.parameter_count());
  }

  const MlpShape& shape() const { return shape_; }
  const Vector& parameters() const { return parameters_; }
  Vector& parameters() { return parameters_; }
  template <class U>
  Mlp<U> cast() const {
    return {shape_, Eigen::VectorX<U>(parameters_.template cast<U>())};
  }

  /// One point, any scalar that mixes with T.
  template <class X>
  Eigen::VectorX<X> operator()(const Eigen::VectorX<X>& x) const {
    const auto activated = [&](Eigen::VectorX<X> z) {
      for (X& entry : z) entry = activate(shape_.activation, entry);
      return z;
    };
    Eigen::VectorX<X> y = activated(affine(0, x));
    for (int l = 1; l + 1 < shape_.layers(); l += 2)
      y = activated(Eigen::VectorX<X>(affine(l + 1, activated(affine(l, y))) + y));
    return affine(shape_.layers() - 1, y);
  }

  /// A tile of n points carried through all layers: x and the result have n columns for each part of the jets.
  /// accuracy equal to the scalar path to 1e-12 [nn/mlp_test]
  Matrix columns(Matrix x, const JetLayout& layout) const {
    const Index blocks = layout.blocks();
    require(x.rows() == shape_.inputs && x.cols() % blocks == 0, "Mlp::columns: ", x.rows(), " x ", x.cols(), " for ",
            shape_.inputs, " inputs in ", blocks, " blocks");
    Matrix y, z;
    const auto layer = [&](int l, const Matrix& in, Matrix& out) {
      out.resize(shape_.rows(l), in.cols());
      set_product(out, weights(l), in);
      out.leftCols(in.cols() / blocks).colwise() += bias(l);
    };
    layer(0, x, y);
    activate_jets(y, layout);
    for (int l = 1; l + 1 < shape_.layers(); l += 2) {
      layer(l, y, z);
      activate_jets(z, layout);
      layer(l + 1, z, x);
      y += x;
      activate_jets(y, layout);
    }
    layer(shape_.layers() - 1, y, z);
    return z;
  }

  /// The same computation on a tape, for training: x holds jets as the layout says, and the derivatives of a result go to
  /// `gradient`, laid out as parameters() is.
  /// accuracy equal to reverse mode over scalars to 1e-12 [nn/mlp_test]
  template <JetLayout layout = jet_layouts::value>
  typename MatrixTape<T>::Node record(MatrixTape<T>& tape, typename MatrixTape<T>::Node x, Vector& gradient) const {
    using Node = typename MatrixTape<T>::Node;
    using Value = typename MatrixTape<T>::Value;
    using Gradient = typename MatrixTape<T>::Gradient;
    const auto parameter = [&](int l, Index from, Index cols) {
      const Index begin = shape_.offset(l) + from;
      return tape.parameter(Value(parameters_.data() + begin, shape_.rows(l), cols),
                            Gradient(gradient.data() + begin, shape_.rows(l), cols));
    };
    const auto weight = [&](int l) { return parameter(l, 0, shape_.cols(l)); };
    const auto offset = [&](int l) { return parameter(l, Index(shape_.rows(l)) * shape_.cols(l), 1); };
    const auto layer = [&](int l, Node input, auto... residual) {
      const Node w = weight(l), b = offset(l);
      const Activation a = shape_.activation;
      if constexpr (layout.blocks() == 1)
        return tape.layer(w, b, input, residual..., [a](Index n, T* y, T* slope) {
          activate<T>(a, Eigen::Map<Eigen::ArrayX<T>>(y, n), Eigen::Map<Eigen::ArrayX<T>>(slope, n));
        });
      else
        return jet_layer<layout>(tape, w, b, input, residual..., [a](auto z, auto... derivatives) {
          for (Index j = 0; j < z.cols(); ++j) activate<T>(a, z.col(j), derivatives.col(j)...);
        });
    };
    Node y = layer(0, x);
    for (int l = 1; l + 1 < shape_.layers(); l += 2) y = layer(l + 1, layer(l, y), y);
    const int out = shape_.layers() - 1;
    const Node product = tape.product(weight(out), y);
    return jet_bias<layout>(tape, product, offset(out));
  }

 private:
  Eigen::Map<const Matrix> weights(int l) const {
    return {parameters_.data() + shape_.offset(l), shape_.rows(l), shape_.cols(l)};
  }
  Eigen::Map<const Vector> bias(int l) const {
    return {parameters_.data() + shape_.offset(l) + Index(shape_.rows(l)) * shape_.cols(l), shape_.rows(l)};
  }

  template <class X>
  Eigen::VectorX<X> affine(int l, const Eigen::VectorX<X>& x) const {
    using Weight = std::conditional_t<std::is_floating_point_v<X>, X, T>;
    const auto w = weights(l);
    Eigen::VectorX<X> y(w.rows());
    for (Index i = 0; i < w.rows(); ++i) {
      X sum(Weight(bias(l)[i]));
      for (Index k = 0; k < w.cols(); ++k) sum += Weight(w(i, k)) * x[k];
      y[i] = sum;
    }
    return y;
  }

  /// The activation's chain rule over the blocks of y.
  void activate_jets(Matrix& y, const JetLayout& layout) const {
    using Array = Eigen::ArrayX<T>;
    const Index n = y.cols() / layout.blocks();
    Array slope(y.rows()), bend(y.rows());
    const auto block = [&](int k, Index j) { return y.col(k * n + j).array(); };
    for (Index j = 0; j < n; ++j) {
      if (layout.seconds > 0)
        activate<T>(shape_.activation, block(0, j), slope, bend);
      else
        activate<T>(shape_.activation, block(0, j), slope);
      for (int k = 0; k < layout.seconds; ++k) {
        const auto [a, b] = layout.pairs[std::size_t(k)];
        auto second = block(1 + layout.firsts + k, j);
        second = slope * second + bend * block(1 + a, j) * block(1 + b, j);
      }
      for (int k = 1; k <= layout.firsts; ++k) block(k, j) *= slope;
    }
  }

  MlpShape shape_;
  Vector parameters_;
};

}  // namespace dsns
