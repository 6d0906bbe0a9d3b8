#pragma once
/// Losses of networks whose outputs are points of surfaces, as operations of the matrix tape.
#include <dsns/autodiff/jet_layout.hpp>
#include <dsns/autodiff/matrix.hpp>

#include <array>
#include <cstddef>

namespace dsns {

/// The weight of each block of a layout.
template <JetLayout layout>
using BlockWeights = std::array<double, std::size_t(layout.blocks())>;

/// sum over blocks b of weights[b] |y_b - target_b|^2, a 1 x 1 node. Both m columns a block.
template <JetLayout layout, class T>
typename MatrixTape<T>::Node jet_error(MatrixTape<T>& tape, typename MatrixTape<T>::Node y,
                                       const Eigen::MatrixX<T>& target, const BlockWeights<layout>& weights) {
  using Tape = MatrixTape<T>;
  const auto v = tape.value(y);
  require(v.rows() == target.rows() && v.cols() == target.cols() && v.cols() % layout.blocks() == 0,
          "jet_error: ", v.rows(), " x ", v.cols(), " against a target of ", target.rows(), " x ", target.cols(),
          " in ", layout.blocks(), " blocks");
  auto& o = tape.operation(1, 1, {y}, [](Tape& t, const typename Tape::Operation& error) {
    t.accumulate(error.operands[0], (T(2) * error.adjoint(0, 0)) * error.kept[0]);
  });
  auto& weighted = o.kept[0];
  weighted = v - target;
  const Eigen::Index m = v.cols() / layout.blocks();
  T sum(0);
  for (int b = 0; b < layout.blocks(); ++b) {
    auto block = weighted.middleCols(b * m, m);
    const T weight = T(weights[std::size_t(b)]);
    sum += weight * block.squaredNorm();
    block *= weight;
  }
  o.value(0, 0) = sum;
  return tape.last();
}

/// sum over points of (n . y_u)^2 + (n . y_v)^2, a 1 x 1 node: how far the tangents of y are out of the planes with unit
/// normals n, 3 x m. To first order |y_u|^2 times the squared angle between the normals, in radians.
/// y   3 x (blocks m) of a layout whose first two derivatives are in space
template <JetLayout layout, class T>
typename MatrixTape<T>::Node normal_error(MatrixTape<T>& tape, typename MatrixTape<T>::Node y,
                                          const Eigen::MatrixX<T>& normals) {
  static_assert(layout.space_directions() == 2, "normal_error: the layout has no derivatives in u and v");
  using Tape = MatrixTape<T>;
  const auto v = tape.value(y);
  require(v.rows() == 3 && normals.rows() == 3 && v.cols() == layout.blocks() * normals.cols(),
          "normal_error: ", v.rows(), " x ", v.cols(), " jets for normals of ", normals.rows(), " x ", normals.cols());
  auto& o = tape.operation(1, 1, {y}, [](Tape& t, const typename Tape::Operation& error) {
    auto& back = t.scratch();
    const Eigen::Index m = error.kept[0].cols();
    back.setZero(3, layout.blocks() * m);
    for (int k = 0; k < 2; ++k)
      back.middleCols((1 + k) * m, m) =
          error.kept[0] * (T(2) * error.adjoint(0, 0) * error.kept[1].row(k)).asDiagonal();
    t.accumulate(error.operands[0], back);
  });
  const Eigen::Index m = normals.cols();
  o.kept[0] = normals;
  o.kept[1].resize(2, m);
  for (int k = 0; k < 2; ++k) o.kept[1].row(k) = normals.cwiseProduct(v.middleCols((1 + k) * m, m)).colwise().sum();
  o.value(0, 0) = o.kept[1].squaredNorm();
  return tape.last();
}

}  // namespace dsns
