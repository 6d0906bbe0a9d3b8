#pragma once
/// Smooth diffeomorphisms of the sphere that bring scalar functions of one body onto those of another: Gauss-Newton on
/// vector harmonics for the sum over channels of the integral of (u1(s) - u2(gamma(s)))^2. Values are carried along, areas
/// do not count, as descriptors of corresponding points are equal.
#include <dsns/sphere/diffeomorphism.hpp>

#include <Eigen/Cholesky>
#include <optional>

namespace dsns {

struct ScalarRegistrationOptions {
  std::vector<int> field_degrees = {1, 2, 3, 4};
  int steps_per_degree = 6;
  int latitudes = 12;              ///< quadrature of latitudes x 2 latitudes nodes
  double damping = 1e-3;           ///< times (l(l + 1))^2: what a field of degree l must gain to be used
  double tolerance = 1e-3;         ///< a degree ends when a step lowers the energy by less than this share of it
  double min_step_jacobian = 0.3;  ///< of a single increment
  double min_jacobian = 0.1;       ///< of the composition, at the quadrature nodes
  double longest_step = 0.8;       ///< radians
};

struct ScalarRegistration {
  SphereDiffeomorphism gamma;
  double energy = 0;  ///< mean over channels and over the sphere of the squared difference
  int steps = 0;
};

namespace detail {

class ScalarProblem {
 public:
  using Channels = Eigen::MatrixXd;  ///< harmonic coefficients, a column for each channel

  ScalarProblem(const Channels& first, const Channels& second, const ScalarRegistrationOptions& options)
      : options_(&options),
        nodes_(sphere_quadrature(options.latitudes)),
        degree_(harmonic_degree(second.rows())),
        weights_(nodes_.weights / (4 * pi * double(second.cols()))),
        target_(harmonics(nodes_.points, harmonic_degree(first.rows())) * first),
        second_(second) {
    require(first.cols() == second.cols(), "register_scalars: ", first.cols(), " and ", second.cols(), " channels");
  }

  ScalarRegistration minimise(const Mat3& start) const {
    ScalarRegistration out{SphereDiffeomorphism(start), 0, 0};
    Particles p = at((start * nodes_.points).colwise().normalized(), Eigen::VectorXd::Ones(nodes_.size()));
    for (const int degree : options_->field_degrees) p = minimise(std::move(p), degree, out);
    out.energy = p.energy;
    return out;
  }

 private:
  struct Particles {
    ChartBatch charts;  ///< at y = gamma(s)
    Eigen::VectorXd J;
    HarmonicTangents basis;
    Eigen::MatrixXd residual;  ///< u1(s) - u2(y), points x channels
    double energy = 0;
  };
  struct NormalEquations {
    Eigen::MatrixXd matrix;
    Eigen::VectorXd right;
  };

  Particles at(const Mat3X& y, Eigen::VectorXd J) const {
    Particles p{charts_at(y), std::move(J), {}, {}, 0};
    p.basis = harmonic_tangents(p.charts, degree_);
    p.residual = target_ - p.basis.y * second_;
    p.energy = weights_.dot(p.residual.rowwise().squaredNorm());
    return p;
  }

  Particles minimise(Particles p, int degree, ScalarRegistration& out) const {
    double damping = options_->damping;
    for (int step = 0; step < options_->steps_per_degree; ++step) {
      const NormalEquations system = linearise(p, degree);
      std::optional<Particles> next;
      SphereVectorField v;
      for (int attempt = 0; attempt < 8 && !next; ++attempt) {
        v = solve(system, degree, damping);
        const SphereDisplacement moved = displace(v, p.charts);
        const Eigen::VectorXd J = p.J.cwiseProduct(moved.J);
        if (moved.J.minCoeff() >= options_->min_step_jacobian && J.minCoeff() >= options_->min_jacobian &&
            moved.longest_step <= options_->longest_step) {
          Particles trial = at(moved.y, J);
          if (trial.energy < p.energy) next = std::move(trial);
        }
        if (!next) damping = std::max(4 * damping, 1e-8);
      }
      if (!next) break;
      const double gain = (p.energy - next->energy) / p.energy;
      p = std::move(*next);
      out.gamma.append(std::move(v));
      ++out.steps;
      damping = std::max(damping / 3, 1e-3 * options_->damping);
      if (gain < options_->tolerance) break;
    }
    return p;
  }

  /// A field moves u2 at a point by D u2 (v1, v2): rows of the linearised problem depend on the channels only through their
  /// 2 x 2 Gram matrix there.
  NormalEquations linearise(const Particles& p, int degree) const {
    const HarmonicTangents basis = degree <= degree_ ? HarmonicTangents{} : harmonic_tangents(p.charts, degree);
    const HarmonicTangents& b = degree <= degree_ ? p.basis : basis;
    const Index count = harmonic_count(degree) - 1, n = p.J.size();
    const Eigen::MatrixXd u1 = p.basis.yu * second_, u2 = p.basis.yv * second_;
    Eigen::MatrixXd along1(n, 2 * count), along2(n, 2 * count);  // components of all fields in the frames
    along1 << b.yu.middleCols(1, count), -b.yv.middleCols(1, count);
    along2 << b.yv.middleCols(1, count), b.yu.middleCols(1, count);
    const Eigen::VectorXd g11 = weights_.cwiseProduct(u1.rowwise().squaredNorm()),
                          g12 = weights_.cwiseProduct(u1.cwiseProduct(u2).rowwise().sum()),
                          g22 = weights_.cwiseProduct(u2.rowwise().squaredNorm()),
                          r1 = weights_.cwiseProduct(u1.cwiseProduct(p.residual).rowwise().sum()),
                          r2 = weights_.cwiseProduct(u2.cwiseProduct(p.residual).rowwise().sum());
    return {along1.transpose() * (g11.asDiagonal() * along1 + g12.asDiagonal() * along2) +
                along2.transpose() * (g12.asDiagonal() * along1 + g22.asDiagonal() * along2),
            along1.transpose() * r1 + along2.transpose() * r2};
  }

  static SphereVectorField solve(const NormalEquations& system, int degree, double damping) {
    const Index count = harmonic_count(degree) - 1;
    const Eigen::ArrayXd l = harmonic_degrees(degree).tail(count);
    const Eigen::VectorXd penalty = damping * (l * (l + 1)).square();
    Eigen::MatrixXd matrix = system.matrix;
    matrix.diagonal().head(count) += penalty;
    matrix.diagonal().tail(count) += penalty;
    matrix.diagonal().array() += 1e-9 * system.matrix.trace() / double(matrix.rows());
    const Eigen::VectorXd x = matrix.selfadjointView<Eigen::Lower>().ldlt().solve(system.right);
    SphereVectorField v = SphereVectorField::zero(degree);
    v.a.tail(count) = x.head(count);
    v.b.tail(count) = x.tail(count);
    return v;
  }

  const ScalarRegistrationOptions* options_;
  SphereQuadrature nodes_;
  int degree_;
  Eigen::VectorXd weights_;
  Eigen::MatrixXd target_, second_;
};

}  // namespace detail

/// gamma from the rotation `start` on, with u2(gamma(s)) near u1(s).
/// first, second  harmonic coefficients, a column for each channel; the degrees may differ
/// accuracy a known warp of 8 degrees is recovered to 0.1 degrees rms [matching/scalar_registration_test]
inline ScalarRegistration register_scalars(const Eigen::MatrixXd& first, const Eigen::MatrixXd& second,
                                           const Mat3& start, const ScalarRegistrationOptions& options = {}) {
  return detail::ScalarProblem(first, second, options).minimise(start);
}

}  // namespace dsns
