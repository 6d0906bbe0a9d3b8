#pragma once
/// SOAP: Adam in the eigenbasis of Shampoo's Kronecker factors. A matrix of weights with gradient G keeps the averages
///   L <- factor_decay L + (1 - factor_decay) G G^T,   R <- factor_decay R + (1 - factor_decay) G^T G,
/// and Adam runs on Q_L^T G Q_R, where Q_L and Q_R follow the eigenvectors of L and R: there the curvature of a layer is
/// nearly diagonal. Vectors (biases) take plain Adam.
///
/// The bases start as the eigenvectors for the first gradient, which moves no matrix (its own basis would make noise of
/// every entry it does not touch). From then on each is refreshed every `refresh` steps by one orthogonal iteration; the
/// factors take turns, so that no step is much longer than others. Where a basis turns by P = Q_old^T Q_new the first
/// moment turns with it, and the second by the squares of P's entries: exact where the entries of the turned gradient
/// are uncorrelated, as the basis is made to have them.
/// Laws are tested in optim/soap_test.
///
/// source   Vyas et al. 2024, "SOAP: Improving and Stabilizing Shampoo using Adam"
#include <dsns/autodiff/products.hpp>
#include <dsns/core/parallel.hpp>
#include <dsns/core/types.hpp>
#include <dsns/optim/adam.hpp>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include <algorithm>
#include <numeric>

namespace dsns {

/// Rates about 1e-2 along half a cosine and batches of 512 to 1024 fit networks of width 64 best.
struct SoapOptions {
  double beta1 = 0.95;
  double beta2 = 0.95;
  double factor_decay = 0.95;
  double epsilon = 1e-12;
  double weight_decay = 0;    ///< decoupled, as Adam's
  int refresh = 20;           ///< steps from one refresh of a basis to its next
  Index max_dimension = 512;  ///< sides of a matrix that are longer keep the identity as basis
  int threads = 1;            ///< blocks are moved side by side; the result does not depend on it
};

/// The state of one optimisation: Adam's moments in the bases ("moment", "square"), the lower triangles of L and R
/// ("factors") and Q_L and Q_R ("bases") of the matrices in turn.
template <class T>
class Soap {
 public:
  using Scalar = T;

  /// blocks   in the order of the parameters, without gaps
  /// throws   InvalidArgument for blocks that overlap, leave a gap or are empty, and for unusable options
  explicit Soap(const std::vector<ParameterBlock>& blocks, const SoapOptions& options = {}) : options_(options) {
    require(options.refresh > 0 && options.max_dimension >= 0 && options.threads > 0, "Soap: a refresh every ",
            options.refresh, " steps up to dimension ", options.max_dimension, " on ", options.threads, " threads");
    Index parameters = 0, entries = 0;
    const auto factor = [&](Index dimension) {
      if (dimension > options.max_dimension) return Factor{};
      return Factor{dimension, std::exchange(entries, entries + dimension * dimension), factor_count_++};
    };
    for (const ParameterBlock& b : blocks) {
      require(b.offset == parameters && b.rows > 0 && b.cols > 0, "Soap: a block of ", b.rows, " x ", b.cols, " at ",
              b.offset, " where the parameters so far end at ", parameters);
      parameters += b.rows * b.cols;
      Block block{b, {}, {}, Matrix(b.rows, b.cols), Matrix(b.rows, b.cols)};
      if (b.cols > 1) block.left = factor(b.rows), block.right = factor(b.cols);
      blocks_.push_back(std::move(block));
    }
    state_ = detail::zero_state<T>(
        {{"moment", parameters}, {"square", parameters}, {"factors", entries}, {"bases", entries}});
  }

  /// Moves theta one step against the gradient.
  /// throws   InvalidArgument unless both have the entries of the blocks
  void step(Eigen::Ref<Eigen::VectorX<T>> theta, const Eigen::Ref<const Eigen::VectorX<T>>& gradient, double rate) {
    detail::require_matching_size("Soap", theta.size(), gradient.size(), state_.arrays[0].values.size());
    ++state_.steps;
    parallel_for(int(blocks_.size()), options_.threads, [&](int k) {
      Block& block = blocks_[std::size_t(k)];
      const Index begin = block.place.offset;
      const Eigen::Map<const Matrix> g(gradient.data() + begin, block.place.rows, block.place.cols);
      MatrixMap parameters(theta.data() + begin, block.place.rows, block.place.cols);
      const bool turned = block.left.exists() || block.right.exists();
      if (!turned || state_.steps > 1) {
        block.direction = g;
        into_bases(block);
        adam(block, turned ? state_.steps - 1 : state_.steps);
        out_of_bases(block);
        parameters -= T(rate) * (T(options_.weight_decay) * parameters + block.direction);
      }
      if (block.left.exists()) {
        follow(block.left, g);
        turn(block, block.left);
      }
      if (block.right.exists()) {
        follow(block.right, g.transpose());
        turn(block, block.right);
      }
    });
  }

  const OptimizerState<T>& state() const { return state_; }
  /// Continues from the state of an optimiser of the same blocks and max_dimension.
  void restore(OptimizerState<T> state) { state_ = detail::matching_state(state_, std::move(state)); }

 private:
  using Matrix = Eigen::MatrixX<T>;
  using MatrixMap = Eigen::Map<Matrix>;

  /// L or R of a block: where its entries begin, and its number among all factors. Dimension 0 stands for the identity.
  struct Factor {
    Index dimension = 0;
    Index offset = 0;
    int number = 0;

    bool exists() const { return dimension > 0; }
  };
  struct Block {
    ParameterBlock place;
    Factor left, right;
    Matrix direction, product;
  };

  MatrixMap factor(const Factor& f) { return {state_.arrays[2].values.data() + f.offset, f.dimension, f.dimension}; }
  MatrixMap basis(const Factor& f) { return {state_.arrays[3].values.data() + f.offset, f.dimension, f.dimension}; }
  MatrixMap moment(const Block& b) {
    return {state_.arrays[0].values.data() + b.place.offset, b.place.rows, b.place.cols};
  }
  MatrixMap square(const Block& b) {
    return {state_.arrays[1].values.data() + b.place.offset, b.place.rows, b.place.cols};
  }

  void into_bases(Block& b) {
    if (b.left.exists()) {
      set_product(b.product, basis(b.left).transpose(), b.direction);
      b.direction.swap(b.product);
    }
    if (b.right.exists()) {
      set_product(b.product, b.direction, basis(b.right));
      b.direction.swap(b.product);
    }
  }
  void out_of_bases(Block& b) {
    if (b.left.exists()) {
      set_product(b.product, basis(b.left), b.direction);
      b.direction.swap(b.product);
    }
    if (b.right.exists()) {
      set_product(b.product, b.direction, basis(b.right).transpose());
      b.direction.swap(b.product);
    }
  }

  void adam(Block& b, std::int64_t step) {
    const detail::AdamLaw<T> law(options_.beta1, options_.beta2, options_.epsilon, step);
    const auto flat = [](auto&& m) { return Eigen::Map<Eigen::ArrayX<T>>(m.data(), m.size()); };
    law(flat(moment(b)), flat(square(b)), flat(b.direction));
  }

  /// Takes a gradient, the factor's side first, into the factor.
  template <class G>
  void follow(const Factor& f, const G& g) {
    auto average = factor(f);
    average *= T(options_.factor_decay);
    average.template selfadjointView<Eigen::Lower>().rankUpdate(g, T(1 - options_.factor_decay));
  }

  /// Turns the block's moments where the basis is due.
  void turn(Block& block, const Factor& f) {
    const auto due = std::int64_t(f.number) * options_.refresh / factor_count_;
    if (state_.steps == 1) {
      basis(f) = Eigen::SelfAdjointEigenSolver<Matrix>(factor(f)).eigenvectors().rowwise().reverse();
    } else if ((state_.steps - due) % options_.refresh == 0) {
      const Matrix rotation = refresh_basis(f);
      auto m = moment(block), v = square(block);
      if (&f == &block.left) {
        m = rotation.transpose() * m;
        v = rotation.cwiseAbs2().transpose() * v;
      } else {
        m *= rotation;
        v *= rotation.cwiseAbs2();
      }
    }
  }

  /// One orthogonal iteration towards the eigenvectors of a factor, the largest eigenvalue first.
  /// returns  Q_old^T Q_new
  Matrix refresh_basis(const Factor& f) {
    auto q = basis(f);
    Matrix image = factor(f).template selfadjointView<Eigen::Lower>() * q;
    const Eigen::VectorX<T> values = q.cwiseProduct(image).colwise().sum();
    std::vector<Index> order(static_cast<std::size_t>(f.dimension));
    std::iota(order.begin(), order.end(), Index(0));
    std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return values[a] > values[b]; });
    // Scaling changes no direction, but without it the squares of small eigenvalues vanish in single precision.
    const T largest = image.cwiseAbs().maxCoeff();
    image = Matrix(image(Eigen::all, order)) / (largest > 0 ? largest : T(1));
    const Eigen::HouseholderQR<Eigen::Ref<Matrix>> qr(image);
    const Matrix next = qr.householderQ();
    Matrix rotation;
    rotation.noalias() = q.transpose() * next;
    q = next;
    return rotation;
  }

  SoapOptions options_;
  std::vector<Block> blocks_;
  int factor_count_ = 0;
  OptimizerState<T> state_;
};

static_assert(Optimizer<Soap<float>> && Optimizer<Soap<double>>);

}  // namespace dsns
