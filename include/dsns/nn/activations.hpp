#pragma once
/// Smooth activation functions: at one scalar of any differentiable type, and over columns of numbers with their first
/// and second derivatives in a fused pass.
#include <dsns/autodiff/functions.hpp>
#include <dsns/nn/fused_activations.hpp>

#include <Eigen/Core>

#include <type_traits>

namespace dsns {

enum class Activation { softplus, silu, tanh, sine };

/// The activation at x; the scalar path, which is the oracle of the others.
template <class X>
X activate(Activation activation, const X& x) {
  using std::sin, std::tanh;
  switch (activation) {
    case Activation::softplus:
      return softplus(x);
    case Activation::silu:
      return silu(x);
    case Activation::tanh:
      return tanh(x);
    case Activation::sine:
      break;
  }
  return sin(x);
}

/// Replaces y by w(y) and writes w'(y).
/// accuracy a few ulp of the larger of 1 and |y| [nn/activations_test]
template <class T>
void activate(Activation activation, Eigen::Ref<Eigen::ArrayX<T>> y, Eigen::Ref<Eigen::ArrayX<T>> slope) {
  if constexpr (std::is_same_v<T, float>) {
    if (activation == Activation::softplus)
      return detail::for_lanes(y.size(), y.data(), slope.data(), detail::SoftplusLanes{});
    if (activation == Activation::silu) return detail::for_lanes(y.size(), y.data(), slope.data(), detail::SiluLanes{});
  }
  switch (activation) {
    case Activation::softplus:
      slope = (1 + (-y).exp()).inverse();
      y = y.cwiseMax(T(0)) + (-y.abs()).exp().log1p();
      break;
    case Activation::silu:
      slope = (1 + (-y).exp()).inverse();
      y *= slope;
      slope += y * (1 - slope);
      break;
    case Activation::tanh:
      y = y.tanh();
      slope = 1 - y.square();
      break;
    case Activation::sine:
      slope = y.cos();
      y = y.sin();
      break;
  }
}

/// Replaces y by w(y) and writes w'(y) and w''(y).
template <class T>
void activate(Activation activation, Eigen::Ref<Eigen::ArrayX<T>> y, Eigen::Ref<Eigen::ArrayX<T>> slope,
              Eigen::Ref<Eigen::ArrayX<T>> bend) {
  switch (activation) {
    case Activation::softplus:
      activate<T>(activation, y, slope);
      bend = slope * (1 - slope);
      break;
    case Activation::silu:
      slope = (1 + (-y).exp()).inverse();
      bend = slope * (1 - slope) * (2 + y * (1 - 2 * slope));
      y *= slope;
      slope += y * (1 - slope);
      break;
    case Activation::tanh:
      activate<T>(activation, y, slope);
      bend = -2 * y * slope;
      break;
    case Activation::sine:
      activate<T>(activation, y, slope);
      bend = -y;
      break;
  }
}

/// Replaces y by w(y) and writes w'(y), w''(y) and w'''(y).
template <class T>
void activate(Activation activation, Eigen::Ref<Eigen::ArrayX<T>> y, Eigen::Ref<Eigen::ArrayX<T>> slope,
              Eigen::Ref<Eigen::ArrayX<T>> bend, Eigen::Ref<Eigen::ArrayX<T>> third) {
  switch (activation) {
    case Activation::softplus:
      activate<T>(activation, y, slope, bend);
      third = bend * (1 - 2 * slope);
      break;
    case Activation::silu:
      slope = (1 + (-y).exp()).inverse();
      bend = slope * (1 - slope);
      third = bend * (3 * (1 - 2 * slope) + y * (1 - 6 * bend));
      bend *= 2 + y * (1 - 2 * slope);
      y *= slope;
      slope += y * (1 - slope);
      break;
    case Activation::tanh:
      activate<T>(activation, y, slope, bend);
      third = slope * (6 * y.square() - 2);
      break;
    case Activation::sine:
      activate<T>(activation, y, slope, bend);
      third = -slope;
      break;
  }
}

}  // namespace dsns
