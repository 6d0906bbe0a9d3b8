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
/// Operations of one's own: MatrixTape::operation, as used in autodiff/matrix_jets.hpp.
///
/// Beside scalars, on one tape with them:
///
///   Tape<double> tape;
///   const auto recording = tape.record();
///   MatrixTape<double> matrices(tape);
///   const auto y = matrices.product(matrices.parameter(W, dW), matrices.matrix(3, 1, variables));
///   tape.backward(log(matrices.entries(y)[0]));      // one sweep through both
#include <dsns/autodiff/eigen.hpp>
#include <dsns/autodiff/products.hpp>
#include <dsns/autodiff/tape.hpp>
#include <dsns/core/errors.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <span>
#include <vector>

namespace dsns {

template <class T>
class MatrixTape {
 public:
  using Matrix = Eigen::MatrixX<T>;
  using Value = Eigen::Map<const Matrix>;
  using Gradient = Eigen::Map<Matrix>;

  MatrixTape() = default;
  /// Nodes on a tape of scalars, recorded and swept with its variables. They are forgotten when it records anew. Must live
  /// as long as the scalar tape is swept.
  explicit MatrixTape(Tape<T>& scalars) : scalars_(&scalars) {}
  MatrixTape(const MatrixTape&) = delete;
  MatrixTape& operator=(const MatrixTape&) = delete;

  /// A place on the tape, valid until clear().
  struct Node {
    std::size_t place;
  };

  struct Operation;
  /// Adds to the operands' adjoints what the operation's own means for them.
  using Pullback = void (*)(MatrixTape&, const Operation&);

  /// One operation: its result, and what its pullback needs.
  struct Operation {
    std::array<Node, 4> operands{};
    Matrix value, adjoint;
    std::array<Matrix, 4> kept;  ///< for the pullback; memory stays from recording to recording
    Eigen::Index number = 0;     ///< likewise

   private:
    friend class MatrixTape;
    Pullback pullback = nullptr;
    bool active = false;          // depends on a parameter
    std::size_t reached = never;  // the sweep in which adjoint got what it holds
    const T* parameter = nullptr;
    T* gradient = nullptr;
    Eigen::Index rows = 0, cols = 0;  // of a parameter
  };

  /// Forgets all nodes, keeps their memory.
  void clear() { used_ = 0; }

  /// Records an operation with a result of the given shape, which the caller writes to `value`; `last()` is its node.
  /// The reference stays valid until clear().
  Operation& operation(Eigen::Index rows, Eigen::Index cols, std::initializer_list<Node> operands, Pullback pullback) {
    if (scalars_ != nullptr) {
      scalars_->check_active();
      if (recording_ != scalars_->recording()) clear();
      recording_ = scalars_->recording();
    }
    bool active = false;
    if (used_ == operations_.size()) operations_.push_back(std::make_unique<Operation>());
    Operation& o = *operations_[used_];
    std::size_t k = 0;
    for (const Node& n : operands) {
      active = active || operations_[n.place]->active;
      o.operands[k++] = n;
    }
    ++used_;
    o.pullback = pullback;
    o.active = active;
    o.reached = never;
    o.parameter = nullptr;
    o.value.resize(rows, cols);
    if (scalars_ != nullptr && active && pullback != nullptr)
      scalars_->external({}, [this, k = used_ - 1, owner = std::weak_ptr<void>(life_)](std::span<const T>) {
        check_alive(owner);
        pull(k);
      });
    return o;
  }
  Node last() const { return {used_ - 1}; }

  /// A matrix nobody differentiates in; `fill` writes its entries in place.
  template <class Fill>
  Node constant(Eigen::Index rows, Eigen::Index cols, const Fill& fill) {
    fill(operation(rows, cols, {}, nullptr).value);
    return last();
  }
  Node constant(const Matrix& value) {
    return constant(value.rows(), value.cols(), [&](Matrix& m) { m = value; });
  }
  /// A matrix to differentiate in: backward adds to `gradient`. Both must outlive the recording.
  Node parameter(const Value& value, Gradient gradient) {
    require(value.rows() == gradient.rows() && value.cols() == gradient.cols(), "MatrixTape::parameter: value is ",
            value.rows(), " x ", value.cols(), ", gradient ", gradient.rows(), " x ", gradient.cols());
    Operation& o = operation(0, 0, {}, nullptr);
    o.parameter = value.data();
    o.gradient = gradient.data();
    o.rows = value.rows();
    o.cols = value.cols();
    o.active = true;
    return last();
  }

  /// A matrix of scalars, column by column.
  /// throws   InvalidArgument unless this tape was made on the scalars', or for another number of them
  Node matrix(Eigen::Index rows, Eigen::Index cols, std::span<const Var<T>> scalars) {
    check_on_scalars("matrix");
    require(rows * cols == Eigen::Index(scalars.size()), "MatrixTape::matrix: ", scalars.size(), " scalars for ", rows,
            " x ", cols, " entries");
    Operation& o = operation(rows, cols, {}, nullptr);
    for (std::size_t k = 0; k < scalars.size(); ++k) {
      o.value.data()[k] = scalars[k].f;
      o.active = o.active || !derivatives_vanish(scalars[k]);
    }
    const T none(0);
    Tape<T>::function(scalars, std::span<const T>(&none, 1),
                      [this, node = last(), owner = std::weak_ptr<void>(life_)](auto, std::span<T> derivatives) {
                        check_alive(owner);
                        const Operation& m = *operations_[node.place];
                        if (m.reached != sweep()) return;
                        for (std::size_t k = 0; k < derivatives.size(); ++k) derivatives[k] += m.adjoint.data()[k];
                      });
    return last();
  }
  /// The entries of a matrix as scalars, column by column; constants if it depends on none and on no parameter.
  /// throws   InvalidArgument unless this tape was made on a tape of scalars
  std::vector<Var<T>> entries(Node node) {
    check_on_scalars("entries");
    const Value v = value(node);
    const std::span<const T> values(v.data(), std::size_t(v.size()));
    if (!is_active(node)) return {values.begin(), values.end()};
    return scalars_->external(values, [this, node, owner = std::weak_ptr<void>(life_)](std::span<const T> derivatives) {
      check_alive(owner);
      const Value x = value(node);
      accumulate(node, Value(derivatives.data(), x.rows(), x.cols()));
    });
  }

  /// a b
  Node product(Node a, Node b) {
    const Value va = value(a), vb = value(b);
    require(va.cols() == vb.rows(), "MatrixTape::product: ", va.rows(), " x ", va.cols(), " times ", vb.rows(), " x ",
            vb.cols());
    Operation& o = operation(va.rows(), vb.cols(), {a, b}, [](MatrixTape& tape, const Operation& ab) {
      tape.accumulate_product(ab.operands[0], ab.adjoint, tape.value(ab.operands[1]).transpose());
      tape.accumulate_product(ab.operands[1], tape.value(ab.operands[0]).transpose(), ab.adjoint);
    });
    set_product(o.value, va, vb);
    return last();
  }
  /// a + b; a single column b is added to every column of a.
  Node add(Node a, Node b) {
    const Value va = value(a), vb = value(b);
    require(va.rows() == vb.rows() && (va.cols() == vb.cols() || vb.cols() == 1), "MatrixTape::add: ", va.rows(), " x ",
            va.cols(), " and ", vb.rows(), " x ", vb.cols());
    Operation& o = operation(va.rows(), va.cols(), {a, b}, [](MatrixTape& tape, const Operation& sum) {
      tape.accumulate(sum.operands[0], sum.adjoint);
      if (tape.value(sum.operands[1]).cols() == sum.adjoint.cols())
        tape.accumulate(sum.operands[1], sum.adjoint);
      else
        tape.accumulate(sum.operands[1], sum.adjoint.rowwise().sum());
    });
    if (vb.cols() == va.cols())
      o.value = va + vb;
    else
      o.value = va.colwise() + vb.col(0);
    return last();
  }
  /// The constant factor times a.
  Node scale(Node a, const T& factor) {
    const Value va = value(a);
    Operation& o = operation(va.rows(), va.cols(), {a}, [](MatrixTape& tape, const Operation& scaled) {
      tape.accumulate(scaled.operands[0], scaled.kept[0](0, 0) * scaled.adjoint);
    });
    o.kept[0].setConstant(1, 1, factor);
    o.value = factor * va;
    return last();
  }
  /// w(a) entry by entry; `function(n, y, slope)` replaces the n entries of y by w(y) and writes w'(y).
  template <class Function>
  Node apply(Node a, const Function& function) {
    const Value va = value(a);
    Operation& o = operation(va.rows(), va.cols(), {a}, [](MatrixTape& tape, const Operation& applied) {
      tape.accumulate(applied.operands[0], applied.adjoint.cwiseProduct(applied.kept[0]));
    });
    o.value = va;
    o.kept[0].resize(va.rows(), va.cols());
    for (Eigen::Index j = 0; j < va.cols(); ++j) function(va.rows(), o.value.col(j).data(), o.kept[0].col(j).data());
    return last();
  }
  /// function(w x + b), one pass over memory after the product.
  template <class Function>
  Node layer(Node w, Node b, Node x, const Function& function) {
    return fused_layer({w, b, x}, function);
  }
  /// function(w x + b + r)
  template <class Function>
  Node layer(Node w, Node b, Node x, Node r, const Function& function) {
    return fused_layer({w, b, x, r}, function);
  }
  /// The sum of all entries, a 1 x 1 node.
  Node sum(Node a) {
    const Value va = value(a);
    operation(1, 1, {a}, [](MatrixTape& tape, const Operation& o) {
      const Value x = tape.value(o.operands[0]);
      tape.accumulate(o.operands[0], Matrix::Constant(x.rows(), x.cols(), o.adjoint(0, 0)));
    }).value(0, 0) = va.sum();
    return last();
  }
  /// The sum of the squared entries of a - target, a 1 x 1 node.
  Node squared_error(Node a, const Matrix& target) {
    const Value va = value(a);
    require(va.rows() == target.rows() && va.cols() == target.cols(), "MatrixTape::squared_error: ", va.rows(), " x ",
            va.cols(), " against a target of ", target.rows(), " x ", target.cols());
    Operation& o = operation(1, 1, {a}, [](MatrixTape& tape, const Operation& error) {
      tape.accumulate(error.operands[0], (T(2) * error.adjoint(0, 0)) * error.kept[0]);
    });
    o.kept[0] = va - target;
    o.value(0, 0) = o.kept[0].squaredNorm();
    return last();
  }

  Value value(Node node) const {
    const Operation& o = *operations_[node.place];
    return o.parameter != nullptr ? Value(o.parameter, o.rows, o.cols)
                                  : Value(o.value.data(), o.value.rows(), o.value.cols());
  }
  /// The derivative of the last sweep's result in this node, zero where it does not depend on it; of a parameter, what its
  /// gradient holds.
  Matrix adjoint(Node node) const {
    const Operation& o = *operations_[node.place];
    if (o.parameter != nullptr) return Gradient(o.gradient, o.rows, o.cols);
    return o.reached == sweep() ? o.adjoint : Matrix::Zero(value(node).rows(), value(node).cols());
  }

  /// Whether a pullback need care for this operand.
  bool is_active(Node node) const { return operations_[node.place]->active; }

  /// For pullbacks: adds an expression to a node's adjoint. The first contribution is assigned, so nothing is cleared
  /// beforehand.
  template <class Expression>
  void accumulate(Node node, const Expression& contribution) {
    Operation& o = *operations_[node.place];
    if (!o.active) return;
    if (o.parameter != nullptr)
      Gradient(o.gradient, o.rows, o.cols).noalias() += contribution;
    else if (o.reached == sweep())
      o.adjoint.noalias() += contribution;
    else
      o.adjoint.noalias() = contribution;
    o.reached = sweep();
  }

  /// The same for the product of two matrices, or transposes of such.
  template <class A, class B>
  void accumulate_product(Node node, const A& a, const B& b) {
    Operation& o = *operations_[node.place];
    if (!o.active) return;
    if (o.parameter != nullptr) {
      add_product(Gradient(o.gradient, o.rows, o.cols), a, b);
    } else if (o.reached == sweep()) {
      add_product(o.adjoint, a, b);
    } else {
      o.adjoint.resize(a.rows(), b.cols());
      set_product(o.adjoint, a, b);
    }
    o.reached = sweep();
  }

  /// Adds `seed` times the derivatives of a 1 x 1 node to the gradients of all parameters.
  /// throws   InvalidArgument for a larger node
  void backward(Node result, const T& seed = T(1)) {
    require(value(result).size() == 1, "MatrixTape::backward: the result has ", value(result).size(),
            " entries; differentiate one number");
    if (!is_active(result)) return;
    if (scalars_ != nullptr) return scalars_->backward(entries(result)[0], seed);
    ++sweep_;
    accumulate(result, Matrix::Constant(1, 1, seed));
    for (std::size_t k = result.place + 1; k-- > 0;)
      if (operations_[k]->pullback != nullptr) pull(k);
  }

  /// For pullbacks: a matrix to work in, of no particular shape.
  Matrix& scratch() { return scratch_; }

  /// Memory held, in use or not.
  std::size_t bytes() const {
    Eigen::Index entries = 0;
    for (const auto& o : operations_) {
      entries += o->value.size() + o->adjoint.size();
      for (const Matrix& m : o->kept) entries += m.size();
    }
    return std::size_t(entries) * sizeof(T) + operations_.size() * sizeof(Operation);
  }

 private:
  /// Operands: weights, bias, input, and perhaps something to add.
  template <class Function>
  Node fused_layer(std::initializer_list<Node> operands, const Function& function) {
    const auto operand = [&](std::size_t k) { return value(operands.begin()[k]); };
    const bool residual = operands.size() == 4;
    const Value w = operand(0), b = operand(1), x = operand(2), r = operand(residual ? 3 : 1);
    require(w.cols() == x.rows() && b.rows() == w.rows() && b.cols() == 1 && r.rows() == w.rows() &&
                (!residual || r.cols() == x.cols()),
            "MatrixTape::layer: weights ", w.rows(), " x ", w.cols(), ", bias ", b.rows(), ", input ", x.rows(), " x ",
            x.cols(), " and residual do not fit");
    Operation& o = operation(w.rows(), x.cols(), operands, [](MatrixTape& tape, const Operation& layer) {
      tape.scratch_ = layer.kept[0].cwiseProduct(layer.adjoint);  // the adjoint before the activation
      tape.accumulate_product(layer.operands[0], tape.scratch_, tape.value(layer.operands[2]).transpose());
      tape.accumulate(layer.operands[1], tape.scratch_.rowwise().sum());
      tape.accumulate_product(layer.operands[2], tape.value(layer.operands[0]).transpose(), tape.scratch_);
      if (layer.number == 4) tape.accumulate(layer.operands[3], tape.scratch_);
    });
    o.number = Eigen::Index(operands.size());
    o.kept[0].resize(w.rows(), x.cols());
    set_product(o.value, w, x);
    for (Eigen::Index j = 0; j < x.cols(); ++j) {
      if (residual)
        o.value.col(j) += b.col(0) + r.col(j);
      else
        o.value.col(j) += b.col(0);
      function(w.rows(), o.value.col(j).data(), o.kept[0].col(j).data());
    }
    return last();
  }

  static constexpr std::size_t never = ~std::size_t(0);

  void pull(std::size_t k) {
    const Operation& o = *operations_[k];
    if (o.reached == sweep()) o.pullback(*this, o);
  }
  /// The number of the last sweep.
  std::size_t sweep() const { return scalars_ != nullptr ? scalars_->sweeps() : sweep_; }
  void check_on_scalars(const char* function) const {
    require(scalars_ != nullptr, "MatrixTape::", function, ": make the tape on that of the scalars, MatrixTape(tape)");
  }
  static void check_alive(const std::weak_ptr<void>& owner) {
    require(!owner.expired(),
            "Tape::backward: a MatrixTape on it has ended; it must live as long as the tape is swept");
  }

  Matrix scratch_;
  std::vector<std::unique_ptr<Operation>> operations_;
  std::size_t used_ = 0;
  std::size_t sweep_ = 0;
  Tape<T>* scalars_ = nullptr;
  std::uint64_t recording_ = 0;
  std::shared_ptr<void> life_ = std::make_shared<char>();
};

}  // namespace dsns
