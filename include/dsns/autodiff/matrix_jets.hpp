#pragma once
/// Operations of a MatrixTape for losses that contain derivatives of a network in its input: surfaces whose tangents,
/// normals or curvature enter the loss. A matrix of jets at m points has a block of m columns for the values and one for
/// each derivative of its JetLayout: with `second`, values, then derivatives in u, v, uu, uv, vv. Linear maps act on all
/// columns alike.
///
///   auto y = jet_layer(tape, w1, b1, tape.constant(jets_of_points), softplus_jets);
///   y = tape.product(w2, y);                                       // biases are for values alone: jet_bias
///   const auto errors = pointwise<3, 6>(tape, y, [](const auto& jet) { return curvature_error(jet); });
///   tape.backward(tape.sum(errors));
#include <dsns/autodiff/dual.hpp>
#include <dsns/autodiff/jet_layout.hpp>
#include <dsns/autodiff/matrix.hpp>

#include <array>
#include <cstddef>
#include <initializer_list>

namespace dsns {

namespace detail {

/// Block k of the columns of jets.
template <JetLayout layout, class M>
auto jet_block(M& x, int k) {
  const Eigen::Index m = x.cols() / layout.blocks();
  return x.middleCols(k * m, m).array();
}

template <JetLayout layout, class T>
void check_jets(const char* function, const Eigen::Map<const Eigen::MatrixX<T>>& x) {
  require(x.cols() % layout.blocks() == 0, function, ": ", x.cols(), " columns are not values and ",
          layout.blocks() - 1, " derivatives of a number of points");
}

/// The adjoint of z = W x + b from that of w(z). With a bar for adjoints, sums over all derivatives of the layout:
///   bar z    = w' bar y + w'' (z_i bar y_i + z_ij bar y_ij) + w''' z_i z_j bar y_ij
///   bar z_i  = w' bar y_i + w'' z_j bar y_ij (twice for i = j),   bar z_ij = w' bar y_ij
template <JetLayout layout, class T>
void pull_jet_layer(MatrixTape<T>& tape, const typename MatrixTape<T>::Operation& layer) {
  const auto& z = layer.kept[0];
  const auto slope = layer.kept[1].array(), second = layer.kept[2].array(), third = layer.kept[3].array();
  const auto part = [](auto& matrix, int k) { return jet_block<layout>(matrix, k); };
  auto& back = tape.scratch();
  back.resize(z.rows(), z.cols());
  for (int k = 0; k < layout.blocks(); ++k) part(back, k) = slope * part(layer.adjoint, k);
  for (int k = 1; k <= layout.firsts; ++k) part(back, 0) += second * part(z, k) * part(layer.adjoint, k);
  for (int k = 0; k < layout.seconds; ++k) {
    const int i = 1 + layout.pairs[std::size_t(k)][0], j = 1 + layout.pairs[std::size_t(k)][1];
    const int ij = 1 + layout.firsts + k;
    part(back, 0) += (second * part(z, ij) + third * part(z, i) * part(z, j)) * part(layer.adjoint, ij);
    part(back, i) += second * part(z, j) * part(layer.adjoint, ij);
    part(back, j) += second * part(z, i) * part(layer.adjoint, ij);
  }
  tape.accumulate_product(layer.operands[0], back, tape.value(layer.operands[2]).transpose());
  tape.accumulate(layer.operands[1], back.leftCols(back.cols() / layout.blocks()).rowwise().sum());
  tape.accumulate_product(layer.operands[2], tape.value(layer.operands[0]).transpose(), back);
  if (layer.number == 4) tape.accumulate(layer.operands[3], back);
}

/// Operands: weights, bias, input, and perhaps jets to add.
template <JetLayout layout, class T, class Function>
typename MatrixTape<T>::Node record_jet_layer(MatrixTape<T>& tape,
                                              std::initializer_list<typename MatrixTape<T>::Node> operands,
                                              const Function& function) {
  const auto operand = [&](std::size_t k) { return tape.value(operands.begin()[k]); };
  const bool residual = operands.size() == 4;
  const auto w = operand(0), b = operand(1), x = operand(2), r = operand(residual ? 3 : 1);
  check_jets<layout, T>("jet_layer", x);
  require(w.cols() == x.rows() && b.rows() == w.rows() && b.cols() == 1 && r.rows() == w.rows() &&
              (!residual || r.cols() == x.cols()),
          "jet_layer: weights ", w.rows(), " x ", w.cols(), ", bias ", b.rows(), ", input ", x.rows(), " x ", x.cols(),
          " and residual do not fit");
  const Eigen::Index m = x.cols() / layout.blocks(), n = w.rows();
  auto& o = tape.operation(n, x.cols(), operands, pull_jet_layer<layout, T>);
  o.number = Eigen::Index(operands.size());
  auto& z = o.kept[0];
  z.resize(n, x.cols());
  set_product(z, w, x);
  if (residual) z += r;
  z.leftCols(m).colwise() += b.col(0);
  for (std::size_t k = 1; k < (layout.seconds > 0 ? 4 : 3); ++k) o.kept[k].resize(n, m);
  o.value.leftCols(m) = z.leftCols(m);
  if constexpr (layout.seconds > 0)
    function(o.value.leftCols(m).array(), o.kept[1].array(), o.kept[2].array(), o.kept[3].array());
  else
    function(o.value.leftCols(m).array(), o.kept[1].array(), o.kept[2].array());
  const auto slope = o.kept[1].array(), second = o.kept[2].array();
  const auto part = [](auto& matrix, int k) { return jet_block<layout>(matrix, k); };
  for (int k = 1; k <= layout.firsts; ++k) part(o.value, k) = slope * part(z, k);
  for (int k = 0; k < layout.seconds; ++k) {
    const auto [i, j] = layout.pairs[std::size_t(k)];
    const int ij = 1 + layout.firsts + k;
    part(o.value, ij) = slope * part(z, ij) + second * part(z, 1 + i) * part(z, 1 + j);
  }
  return tape.last();
}

}  // namespace detail

/// w(z), z = W x + b, with its derivatives. `function(z, slope, second, third)` works on arrays of values: it replaces z by
/// w(z) and writes the derivatives of w; where the layout has no second derivatives, `function(z, slope, second)`.
template <JetLayout layout = jet_layouts::second, class T, class Function>
typename MatrixTape<T>::Node jet_layer(MatrixTape<T>& tape, typename MatrixTape<T>::Node w,
                                       typename MatrixTape<T>::Node b, typename MatrixTape<T>::Node x,
                                       const Function& function) {
  return detail::record_jet_layer<layout>(tape, {w, b, x}, function);
}
/// w(W x + b + r) for jets r.
template <JetLayout layout = jet_layouts::second, class T, class Function>
typename MatrixTape<T>::Node jet_layer(MatrixTape<T>& tape, typename MatrixTape<T>::Node w,
                                       typename MatrixTape<T>::Node b, typename MatrixTape<T>::Node x,
                                       typename MatrixTape<T>::Node r, const Function& function) {
  return detail::record_jet_layer<layout>(tape, {w, b, x, r}, function);
}

/// The bias b, added to the values of jets.
template <JetLayout layout = jet_layouts::second, class T>
typename MatrixTape<T>::Node jet_bias(MatrixTape<T>& tape, typename MatrixTape<T>::Node x,
                                      typename MatrixTape<T>::Node b) {
  using Tape = MatrixTape<T>;
  const auto vx = tape.value(x), vb = tape.value(b);
  detail::check_jets<layout, T>("jet_bias", vx);
  require(vb.rows() == vx.rows() && vb.cols() == 1, "jet_bias: bias ", vb.rows(), " x ", vb.cols(), " for ", vx.rows(),
          " rows");
  auto& o = tape.operation(vx.rows(), vx.cols(), {x, b}, [](Tape& t, const typename Tape::Operation& sum) {
    t.accumulate(sum.operands[0], sum.adjoint);
    t.accumulate(sum.operands[1], sum.adjoint.leftCols(sum.adjoint.cols() / layout.blocks()).rowwise().sum());
  });
  o.value = vx;
  o.value.leftCols(vx.cols() / layout.blocks()).colwise() += vb.col(0);
  return tape.last();
}

/// One number for each of m points from what Blocks blocks of m columns say about it: f takes an array of Blocks arrays of
/// Rows numbers and returns a number, for any differentiable scalar. Differentiated on the spot, by forward mode.
/// returns  1 x m
template <int Rows, int Blocks, class T, class F>
typename MatrixTape<T>::Node pointwise(MatrixTape<T>& tape, typename MatrixTape<T>::Node x, const F& f) {
  using Tape = MatrixTape<T>;
  constexpr int arguments = Rows * Blocks;
  using D = Dual<T, arguments>;
  const auto vx = tape.value(x);
  require(vx.rows() == Rows && vx.cols() % Blocks == 0, "pointwise: ", vx.rows(), " x ", vx.cols(), " is not ", Blocks,
          " blocks of ", Rows, " rows");
  const Eigen::Index m = vx.cols() / Blocks;
  auto& o = tape.operation(1, m, {x}, [](Tape& t, const typename Tape::Operation& each) {
    auto& back = t.scratch();
    const Eigen::Index points = each.adjoint.cols();
    back.resize(Rows, Blocks * points);
    for (Eigen::Index i = 0; i < points; ++i)
      for (int k = 0; k < Blocks; ++k)
        back.col(k * points + i) = each.adjoint(0, i) * each.kept[0].col(i).template segment<Rows>(k * Rows);
    t.accumulate(each.operands[0], back);
  });
  o.kept[0].resize(arguments, m);
  for (Eigen::Index i = 0; i < m; ++i) {
    std::array<std::array<D, std::size_t(Rows)>, std::size_t(Blocks)> point;
    for (int k = 0; k < Blocks; ++k)
      for (int r = 0; r < Rows; ++r)
        point[std::size_t(k)][std::size_t(r)] = D::variable(vx(r, k * m + i), k * Rows + r);
    const D y = f(point);
    o.value(0, i) = y.f;
    for (int k = 0; k < arguments; ++k) o.kept[0](k, i) = y.g[std::size_t(k)];
  }
  return tape.last();
}

}  // namespace dsns
