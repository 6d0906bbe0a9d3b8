#pragma once
/// Reverse automatic differentiation over Eigen matrices: each node of the tape is a whole matrix, and going backward
/// through a product is a product. This is how networks are trained.
///
///   MatrixTape<float> tape;
///   const auto x = tape.constant(points);
///   const auto y = tape.add(tape.product(tape.parameter(W, dW), x), tape.parameter(b, db));
///   tape.backward(tape.squared_error(y, targets));   // adds the derivatives to dW and db
///
/// Parameters are views of the caller's memory. A tape keeps its memory from one recording to the next: a step of the
/// same shapes as the last allocates nothing. T may be float, double, or a forward scalar. One tape serves one thread.
#include <dsns/autodiff/eigen.hpp>
#include <dsns/core/errors.hpp>

#include <array>
#include <cstddef>
#include <vector>

namespace dsns {

template <class T>
class MatrixTape {
 public:
  using Matrix = Eigen::MatrixX<T>;
  using Value = Eigen::Map<const Matrix>;
  using Gradient = Eigen::Map<Matrix>;

  /// A place on the tape, valid until clear().
  struct Node {
    std::size_t place;
  };

  /// Forgets all nodes, keeps their memory.
  void clear() { used_ = 0; }

  /// A matrix nobody differentiates in; `fill` writes its entries in place.
  template <class Fill>
  Node constant(Eigen::Index rows, Eigen::Index cols, const Fill& fill) {
    Entry& e = next(Operation::constant, rows, cols);
    fill(e.value);
    return last();
  }
  Node constant(const Matrix& value) {
    return constant(value.rows(), value.cols(), [&](Matrix& m) { m = value; });
  }
  /// A matrix to differentiate in: backward adds to `gradient`. Both must outlive the recording.
  Node parameter(const Value& value, Gradient gradient) {
    require(value.rows() == gradient.rows() && value.cols() == gradient.cols(), "MatrixTape::parameter: value is ",
            value.rows(), " x ", value.cols(), ", gradient ", gradient.rows(), " x ", gradient.cols());
    Entry& e = next(Operation::parameter, 0, 0);
    e.parameter = value.data();
    e.gradient = gradient.data();
    e.rows = value.rows();
    e.cols = value.cols();
    e.active = true;
    return last();
  }

  /// a b
  Node product(Node a, Node b) {
    const Value va = value(a), vb = value(b);
    require(va.cols() == vb.rows(), "MatrixTape::product: ", va.rows(), " x ", va.cols(), " times ", vb.rows(), " x ",
            vb.cols());
    Entry& e = next(Operation::product, va.rows(), vb.cols(), a, b);
    e.value.noalias() = view(a) * view(b);
    return last();
  }
  /// a + b; a single column b is added to every column of a.
  Node add(Node a, Node b) {
    const Value va = value(a), vb = value(b);
    require(va.rows() == vb.rows() && (va.cols() == vb.cols() || vb.cols() == 1), "MatrixTape::add: ", va.rows(), " x ",
            va.cols(), " and ", vb.rows(), " x ", vb.cols());
    Entry& e = next(Operation::add, va.rows(), va.cols(), a, b);
    if (view(b).cols() == view(a).cols())
      e.value = view(a) + view(b);
    else
      e.value = view(a).colwise() + view(b).col(0);
    return last();
  }
  /// w(a) entry by entry; `function(n, y, slope)` replaces the n entries of y by w(y) and writes w'(y).
  template <class Function>
  Node apply(Node a, const Function& function) {
    Entry& e = next(Operation::apply, value(a).rows(), value(a).cols(), a);
    e.value = view(a);
    e.slope.resize(e.value.rows(), e.value.cols());
    for (Eigen::Index j = 0; j < e.value.cols(); ++j)
      function(e.value.rows(), e.value.col(j).data(), e.slope.col(j).data());
    return last();
  }
  /// function(w x + b), one pass over memory after the product.
  template <class Function>
  Node layer(Node w, Node b, Node x, const Function& function) {
    return fused_layer(w, b, x, nullptr, function);
  }
  /// function(w x + b + r)
  template <class Function>
  Node layer(Node w, Node b, Node x, Node r, const Function& function) {
    return fused_layer(w, b, x, &r, function);
  }
  /// The sum of the squared entries of a - target, a 1 x 1 node.
  Node squared_error(Node a, const Matrix& target) {
    const Value va = value(a);
    require(va.rows() == target.rows() && va.cols() == target.cols(), "MatrixTape::squared_error: ", va.rows(), " x ",
            va.cols(), " against a target of ", target.rows(), " x ", target.cols());
    Entry& e = next(Operation::squared_error, 1, 1, a);
    e.slope = view(a) - target;
    e.value(0, 0) = e.slope.squaredNorm();
    return last();
  }

  Value value(Node node) const { return view(entries_[node.place]); }
  /// The derivative of the last sweep's result in this node, zero where it does not depend on it.
  Matrix adjoint(Node node) const {
    const Entry& e = entries_[node.place];
    return e.reached ? e.adjoint : Matrix::Zero(value(node).rows(), value(node).cols());
  }

  /// Adds `seed` times the derivatives of a 1 x 1 node to the gradients of all parameters.
  /// throws   InvalidArgument for a larger node
  void backward(Node result, const T& seed = T(1)) {
    require(value(result).size() == 1, "MatrixTape::backward: the result has ", value(result).size(),
            " entries; differentiate one number");
    for (std::size_t k = 0; k < used_; ++k) entries_[k].reached = false;
    if (!entries_[result.place].active) return;
    accumulate(result.place, Matrix::Constant(1, 1, seed));
    for (std::size_t k = result.place + 1; k-- > 0;)
      if (entries_[k].reached) propagate(entries_[k]);
  }

 private:
  enum class Operation { constant, parameter, product, add, apply, layer, squared_error };
  static constexpr std::size_t nowhere = static_cast<std::size_t>(-1);

  struct Entry {
    Operation operation = Operation::constant;
    std::size_t a = 0, b = 0, x = 0, r = nowhere;  // operands; a layer takes weights a, bias b, input x, residual r
    bool active = false;                           // depends on a parameter
    bool reached = false;                          // adjoint holds something
    Matrix value, adjoint, slope;
    const T* parameter = nullptr;
    T* gradient = nullptr;
    Eigen::Index rows = 0, cols = 0;  // of a parameter
  };

  static Value view(const Entry& e) {
    return e.operation == Operation::parameter ? Value(e.parameter, e.rows, e.cols)
                                               : Value(e.value.data(), e.value.rows(), e.value.cols());
  }
  Value view(Node node) const { return view(entries_[node.place]); }
  Node last() const { return {used_ - 1}; }

  template <class... Operands>
  Entry& next(Operation operation, Eigen::Index rows, Eigen::Index cols, Operands... operands) {
    const bool active = (entries_[operands.place].active || ... || false);
    if (used_ == entries_.size()) entries_.emplace_back();
    Entry& e = entries_[used_++];
    e.operation = operation;
    const std::array<std::size_t, 4> places{operands.place...};
    e.a = places[0];
    e.b = places[1];
    e.x = places[2];
    e.r = sizeof...(operands) > 3 ? places[3] : nowhere;
    e.active = active;
    e.reached = false;
    if (operation != Operation::parameter) e.value.resize(rows, cols);
    return e;
  }

  template <class Function>
  Node fused_layer(Node w, Node b, Node x, const Node* r, const Function& function) {
    const Eigen::Index rows = value(w).rows(), cols = value(x).cols();
    require(value(w).cols() == value(x).rows() && value(b).rows() == rows && value(b).cols() == 1 &&
                (r == nullptr || (value(*r).rows() == rows && value(*r).cols() == cols)),
            "MatrixTape::layer: weights ", rows, " x ", value(w).cols(), ", bias ", value(b).rows(), ", input ",
            value(x).rows(), " x ", cols, " and residual do not fit");
    Entry& e = r ? next(Operation::layer, rows, cols, w, b, x, *r) : next(Operation::layer, rows, cols, w, b, x);
    e.slope.resize(rows, cols);
    e.value.noalias() = view(w) * view(x);
    for (Eigen::Index j = 0; j < cols; ++j) {
      if (r)
        e.value.col(j) += view(b).col(0) + view(*r).col(j);
      else
        e.value.col(j) += view(b).col(0);
      function(rows, e.value.col(j).data(), e.slope.col(j).data());
    }
    return last();
  }

  /// Adds an expression to a node's adjoint; the first contribution is assigned, so nothing is cleared beforehand.
  template <class Expression>
  void accumulate(std::size_t place, const Expression& contribution) {
    Entry& e = entries_[place];
    if (!e.active) return;
    if (e.operation == Operation::parameter)
      Gradient(e.gradient, e.rows, e.cols).noalias() += contribution;
    else if (e.reached)
      e.adjoint.noalias() += contribution;
    else
      e.adjoint.noalias() = contribution;
    e.reached = true;
  }

  void propagate(Entry& e) {
    switch (e.operation) {
      case Operation::constant:
      case Operation::parameter:
        break;
      case Operation::product:
        accumulate(e.a, e.adjoint * view(entries_[e.b]).transpose());
        accumulate(e.b, view(entries_[e.a]).transpose() * e.adjoint);
        break;
      case Operation::add:
        accumulate(e.a, e.adjoint);
        if (view(entries_[e.b]).cols() == e.adjoint.cols())
          accumulate(e.b, e.adjoint);
        else
          accumulate(e.b, e.adjoint.rowwise().sum());
        break;
      case Operation::apply:
        accumulate(e.a, e.adjoint.cwiseProduct(e.slope));
        break;
      case Operation::layer:
        before_activation_ = e.slope.cwiseProduct(e.adjoint);
        accumulate(e.a, before_activation_ * view(entries_[e.x]).transpose());
        accumulate(e.b, before_activation_.rowwise().sum());
        accumulate(e.x, view(entries_[e.a]).transpose() * before_activation_);
        if (e.r != nowhere) accumulate(e.r, before_activation_);
        break;
      case Operation::squared_error:
        accumulate(e.a, (T(2) * e.adjoint(0, 0)) * e.slope);
        break;
    }
  }

  Matrix before_activation_;
  std::vector<Entry> entries_;
  std::size_t used_ = 0;
};

}  // namespace dsns
