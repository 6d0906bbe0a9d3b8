#pragma once
/// Operations of a MatrixTape for losses that contain derivatives of a network in its input: surfaces whose tangents,
/// normals or curvature enter the loss. A matrix of jets at m points has 6 m columns: values, then derivatives in u, v, uu,
/// uv, vv, m columns each. Linear maps act on all columns alike.
///
///   auto y = jet_layer(tape, w1, b1, tape.constant(jets_of_points), softplus_jets);
///   y = tape.product(w2, y);                                       // biases are for values alone: jet_bias
///   const auto errors = pointwise<3, 6>(tape, y, [](const auto& jet) { return curvature_error(jet); });
///   tape.backward(tape.sum(errors));
#include <dsns/autodiff/dual.hpp>
#include <dsns/autodiff/matrix.hpp>

#include <array>
#include <cstddef>

namespace dsns {

namespace detail {

/// Block k of the columns of jets.
template <class M>
auto jet_block(M& x, int k) {
  const Eigen::Index m = x.cols() / 6;
  return x.middleCols(k * m, m).array();
}

template <class T>
void check_jets(const char* function, const Eigen::Map<const Eigen::MatrixX<T>>& x) {
  require(x.cols() % 6 == 0, function, ": ", x.cols(),
          " columns are not values and five derivatives of a number of points");
}

}  // namespace detail

/// w(z), z = W x + b, with its derivatives in u and v. `function(z, slope, second, third)` works on arrays of values: it
/// replaces z by w(z) and writes the derivatives of w.
template <class T, class Function>
typename MatrixTape<T>::Node jet_layer(MatrixTape<T>& tape, typename MatrixTape<T>::Node w,
                                       typename MatrixTape<T>::Node b, typename MatrixTape<T>::Node x,
                                       const Function& function) {
  using Tape = MatrixTape<T>;
  const auto vw = tape.value(w), vb = tape.value(b), vx = tape.value(x);
  detail::check_jets<T>("jet_layer", vx);
  require(vw.cols() == vx.rows() && vb.rows() == vw.rows() && vb.cols() == 1, "jet_layer: weights ", vw.rows(), " x ",
          vw.cols(), ", bias ", vb.rows(), " and input ", vx.rows(), " x ", vx.cols(), " do not fit");
  const Eigen::Index m = vx.cols() / 6, n = vw.rows();
  auto& o = tape.operation(n, vx.cols(), {w, b, x}, [](Tape& t, const typename Tape::Operation& layer) {
    const auto& z = layer.kept[0];
    const auto slope = layer.kept[1].array(), second = layer.kept[2].array(), third = layer.kept[3].array();
    const auto part = [](auto& matrix, int k) { return detail::jet_block(matrix, k); };
    const auto a = [&](int k) { return part(layer.adjoint, k); };
    const auto u = part(z, 1), v = part(z, 2);
    auto& back = t.scratch();
    back.resize(z.rows(), z.cols());
    part(back, 0) = slope * a(0) +
                    second * (u * a(1) + v * a(2) + part(z, 3) * a(3) + part(z, 4) * a(4) + part(z, 5) * a(5)) +
                    third * (u.square() * a(3) + u * v * a(4) + v.square() * a(5));
    part(back, 1) = slope * a(1) + second * (T(2) * u * a(3) + v * a(4));
    part(back, 2) = slope * a(2) + second * (T(2) * v * a(5) + u * a(4));
    for (int k = 3; k < 6; ++k) part(back, k) = slope * a(k);
    t.accumulate(layer.operands[0], back * t.value(layer.operands[2]).transpose());
    t.accumulate(layer.operands[1], back.leftCols(back.cols() / 6).rowwise().sum());
    if (t.is_active(layer.operands[2])) t.accumulate(layer.operands[2], t.value(layer.operands[0]).transpose() * back);
  });
  auto& z = o.kept[0];
  z.noalias() = vw * vx;
  z.leftCols(m).colwise() += vb.col(0);
  for (std::size_t k = 1; k < 4; ++k) o.kept[k].resize(n, m);
  o.value.leftCols(m) = z.leftCols(m);
  function(o.value.leftCols(m).array(), o.kept[1].array(), o.kept[2].array(), o.kept[3].array());
  const auto slope = o.kept[1].array(), second = o.kept[2].array();
  const auto part = [](auto& matrix, int k) { return detail::jet_block(matrix, k); };
  const auto u = part(z, 1), v = part(z, 2);
  for (int k = 1; k < 3; ++k) part(o.value, k) = slope * part(z, k);
  part(o.value, 3) = slope * part(z, 3) + second * u.square();
  part(o.value, 4) = slope * part(z, 4) + second * u * v;
  part(o.value, 5) = slope * part(z, 5) + second * v.square();
  return tape.last();
}

/// The bias b, added to the values of jets.
template <class T>
typename MatrixTape<T>::Node jet_bias(MatrixTape<T>& tape, typename MatrixTape<T>::Node x,
                                      typename MatrixTape<T>::Node b) {
  using Tape = MatrixTape<T>;
  const auto vx = tape.value(x), vb = tape.value(b);
  detail::check_jets<T>("jet_bias", vx);
  require(vb.rows() == vx.rows() && vb.cols() == 1, "jet_bias: bias ", vb.rows(), " x ", vb.cols(), " for ", vx.rows(),
          " rows");
  auto& o = tape.operation(vx.rows(), vx.cols(), {x, b}, [](Tape& t, const typename Tape::Operation& sum) {
    t.accumulate(sum.operands[0], sum.adjoint);
    t.accumulate(sum.operands[1], sum.adjoint.leftCols(sum.adjoint.cols() / 6).rowwise().sum());
  });
  o.value = vx;
  o.value.leftCols(vx.cols() / 6).colwise() += vb.col(0);
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
