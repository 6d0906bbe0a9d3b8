#pragma once
/// One stage of spatial registration: Gauss-Newton on vector spherical harmonics. Particles y_i = gamma(s_i) start on the
/// quadrature's nodes; each step composes exp(v) on the left, so a step costs the same however many came before.
#include <dsns/elastic/half_density.hpp>
#include <dsns/elastic/landmark_term.hpp>

namespace dsns {

namespace detail {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// The upper triangular R with R^T R = A, A symmetric and positive.
inline Matrix6 upper_root(const Matrix6& A) {
  Matrix6 R = Matrix6::Zero();
  for (int i = 0; i < 6; ++i)
    for (int j = i; j < 6; ++j) {
      double sum = A(i, j);
      for (int k = 0; k < i; ++k) sum -= R(k, i) * R(k, j);
      R(i, j) = j == i ? std::sqrt(std::max(sum, 0.0)) : R(i, i) > 0 ? sum / R(i, i) : 0;
    }
  return R;
}

/// The particles' state: y = gamma(s), J and O with everything that is evaluated there. Landmarks stand behind the nodes, or are left
/// out.
struct Particles {
  Mat3X y;
  Eigen::VectorXd J;
  Mat3 O;
  HalfDensityJets field;  ///< of the second body at y
  double energy = 0;
};

/// Rows of the linearised problem depend on the field only through a 6 x 6 Gram matrix a point (field, two derivatives, three
/// infinitesimal rotations), so the number of components and times is free.
class SpatialProblem {
 public:
  SpatialProblem(const HalfDensityField& first, HalfDensityField second, const SphereQuadrature& q,
                 const SpatialOptions& options)
      : target_(first(charts_at(q.points)).g),
        second_(std::move(second)),
        weights_(q.weights),
        options_(&options),
        landmarks_(options.landmarks, norm()),
        points_(landmarks_.behind(q.points)) {}

  /// The nodes, and behind them the landmarks.
  const Mat3X& points() const { return points_; }

  Particles at(Mat3X y, Eigen::VectorXd J, const Mat3& O) const {
    Particles p{std::move(y), std::move(J), O, {}, 0};
    p.field = evaluate(p.y.leftCols(weights_.size()));
    p.energy = energy(p);
    return p;
  }
  double norm() const { return target_.colwise().squaredNorm() * weights_; }

  Particles minimise(Particles p, int degree, int steps, std::vector<SphereVectorField>& fields,
                     std::vector<double>& energies) const {
    return descend(*this, std::move(p), degree, steps, *options_, fields, energies);
  }

  NormalEquations linearise(const Particles& p, const ChartBatch& charts, int degree) const;

 private:
  static constexpr Index chunk_size = 128;  // points; a fixed number, so that sums do not depend on the thread count

  template <class Body>
  void for_chunks(Index n, const Body& body) const {
    const int chunks = static_cast<int>((n + chunk_size - 1) / chunk_size);
    parallel_for(chunks, options_->threads, [&](int c) {
      const Index first = c * chunk_size;
      body(c, first, std::min(chunk_size, n - first));
    });
  }

  HalfDensityJets evaluate(const Mat3X& y) const {
    const Index rows = second_.components(), n = y.cols();
    HalfDensityJets all{Eigen::MatrixXd(rows, n), Eigen::MatrixXd(rows, n), Eigen::MatrixXd(rows, n)};
    for_chunks(n, [&](int, Index first, Index count) {
      const HalfDensityJets part = second_(charts_at(y.middleCols(first, count)));
      all.g.middleCols(first, count) = part.g;
      all.g1.middleCols(first, count) = part.g1;
      all.g2.middleCols(first, count) = part.g2;
    });
    return all;
  }

  double energy(const Particles& p) const {
    const Eigen::MatrixXd moved = options_->action == FieldAction::half_density
                                      ? Eigen::MatrixXd(p.field.g * p.J.head(weights_.size()).cwiseSqrt().asDiagonal())
                                      : p.field.g;
    return (target_ - rotate_blocks(p.O, moved)).colwise().squaredNorm() * weights_ +
           landmarks_.energy(p.y, weights_.size());
  }

  /// [g, g1, g2, e_x x g, e_y x g, e_z x g] of point i, components x 6.
  static Eigen::MatrixXd columns(const HalfDensityJets& field, Index i) {
    Eigen::MatrixXd U(field.g.rows(), 6);
    U.col(0) = field.g.col(i);
    U.col(1) = field.g1.col(i);
    U.col(2) = field.g2.col(i);
    for (Index r = 0; r < U.rows(); r += 3) {
      const Vec3d g = field.g.col(i).segment<3>(r);
      for (int k = 0; k < 3; ++k) U.block<3, 1>(r, 3 + k) = Vec3d::Unit(k).cross(g);
    }
    return U;
  }

  Eigen::MatrixXd target_;
  HalfDensityField second_;
  Eigen::VectorXd weights_;
  const SpatialOptions* options_;
  LandmarkTerm landmarks_;
  Mat3X points_;
};

inline NormalEquations SpatialProblem::linearise(const Particles& p, const ChartBatch& charts, int degree) const {
  const Index count = harmonic_count(degree) - 1, unknowns = 2 * count + 3, n = weights_.size();
  const Eigen::MatrixXd target = rotate_blocks(p.O.transpose(), target_);
  std::vector<Eigen::MatrixXd> matrices(std::size_t((n + chunk_size - 1) / chunk_size));
  std::vector<Eigen::VectorXd> rights(matrices.size());
  NormalEquations system{{}, {}, degree};
  const Eigen::ArrayXd l = harmonic_degrees(degree).tail(count);
  const bool half_density = options_->action == FieldAction::half_density;
  const Eigen::RowVectorXd half_divergence = (half_density ? -0.5 : 0.0) * (l * (l + 1)).matrix().transpose();
  for_chunks(n, [&](int chunk, Index first, Index points) {
    using PointByPoint = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const auto basis = harmonic_tangents<PointByPoint>(
        {charts.s.middleCols(first, points), charts.e1.middleCols(first, points), charts.e2.middleCols(first, points)},
        degree);
    Eigen::MatrixXd rows(6 * points, unknowns);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns);
    Eigen::Matrix<double, 6, Eigen::Dynamic> B = Eigen::MatrixXd::Zero(6, unknowns);
    B.rightCols<3>().bottomRows<3>().setIdentity();
    for (Index i = first; i < first + points; ++i) {
      const Index at = i - first;
      B.row(0).head(count) = half_divergence.cwiseProduct(basis.y.row(at).tail(count));
      B.row(1).head(count) = basis.yu.row(at).tail(count);
      B.row(1).segment(count, count) = -basis.yv.row(at).tail(count);
      B.row(2).head(count) = basis.yv.row(at).tail(count);
      B.row(2).segment(count, count) = basis.yu.row(at).tail(count);
      const Eigen::MatrixXd U = columns(p.field, i);
      const double root = half_density ? std::sqrt(p.J[i]) : 1.0;
      const Eigen::VectorXd residual = target.col(i) - root * p.field.g.col(i);
      right += weights_[i] * root * (B.transpose() * (U.transpose() * residual));
      Matrix6 gram = weights_[i] * root * root * (U.transpose() * U);
      gram.diagonal().array() += 1e-14 * gram.trace();
      rows.middleRows(6 * (i - first), 6).noalias() = upper_root(gram) * B;
    }
    auto& matrix = matrices[std::size_t(chunk)] = Eigen::MatrixXd::Zero(unknowns, unknowns);
    matrix.selfadjointView<Eigen::Lower>().rankUpdate(rows.transpose());
    rights[std::size_t(chunk)] = std::move(right);
  });
  system.matrix = Eigen::MatrixXd::Zero(unknowns, unknowns);
  system.right = Eigen::VectorXd::Zero(unknowns);
  for (std::size_t chunk = 0; chunk < matrices.size(); ++chunk) {
    system.matrix += matrices[chunk];
    system.right += rights[chunk];
  }
  landmarks_.add_to(system, charts, n);
  return system;
}

}  // namespace detail
}  // namespace dsns
