#pragma once
/// From a square-root normal field back to a surface: Levenberg-Marquardt on harmonic coefficients. A field need not be that
/// of a surface, nor of only one up to translation (different closed surfaces share one: Klassen, Michor 2019), so the result is
/// the least-squares surface near a start, and its residual says how far its field is from the one asked for.
/// source   Laga, Xie, Jermyn, Srivastava 2017 (inversion as optimisation over a basis)
#include <dsns/elastic/srnf.hpp>
#include <dsns/surface/harmonic.hpp>

namespace dsns {

struct InversionOptions {
  int max_steps = 40;
  double tolerance = 1e-6;  ///< done when a step lowers the residual by less than this share
};

struct InversionResult {
  HarmonicSurface surface;  ///< centred as the start: a field does not know where its surface lies
  double residual;          ///< |h(f) - field| / |field| in L2
  double start_residual;    ///< that of the start
  int steps;
  bool converged;  ///< by the tolerance, not by running out of steps
};

/// Fields at the nodes of one quadrature are inverted to surfaces of one degree; the basis is evaluated once.
class SrnfInversion {
 public:
  /// throws   InvalidArgument unless 1 <= degree and the quadrature resolves the products of two harmonics
  SrnfInversion(const SphereQuadrature& q, int degree)
      : charts_(charts_at(q.points)), weights_(q.weights), basis_(harmonic_tangents(charts_, std::max(degree, 0))) {
    require(degree >= 1, "SrnfInversion: degree ", degree, ", give at least 1");
    require(q.size() >= 2 * harmonic_count(degree), "SrnfInversion: ", q.size(), " nodes are too few for degree ",
            degree, ", give ", 2 * harmonic_count(degree), " or more");
    const Eigen::ArrayXd l = harmonic_degrees(degree);
    scale_ = (l * (l + 1)).max(1.0).rsqrt();  // unit changes of f_u, f_v
  }

  int degree() const { return harmonic_degree(basis_.y.cols()); }

  /// field    at the nodes of the quadrature, 3 x n
  /// start    any degree; cut or filled up with zeros to this one's
  /// accuracy of fields of surfaces of the degree, from 20 % beside: residual 1e-10 [elastic/srnf_inversion_test]
  InversionResult operator()(const Mat3X& field, const HarmonicSurface& start,
                             const InversionOptions& options = {}) const {
    require(field.cols() == weights_.size(), "SrnfInversion: a field at ", field.cols(), " points, the quadrature has ",
            weights_.size());
    const double norm = field.colwise().squaredNorm() * weights_;
    require(norm > 0, "SrnfInversion: the field is zero everywhere, there is no such surface");
    const Index K = basis_.y.cols();
    Eigen::MatrixX3d c = Eigen::MatrixX3d::Zero(K, 3);
    const Index shared = std::min(K, start.coefficients().rows());
    c.topRows(shared) = start.coefficients().topRows(shared);

    State state = at(c, field);
    InversionResult result{HarmonicSurface(c), 0, std::sqrt(state.energy / norm), 0, false};
    double damping = 1e-3;
    for (; result.steps < options.max_steps && !result.converged; ++result.steps) {
      const auto [normal, gradient] = linearise(state, field);
      const double diagonal = normal.diagonal().mean();
      bool better = false;
      for (int attempt = 0; attempt < 12 && !better; ++attempt) {
        Eigen::MatrixXd damped = normal.selfadjointView<Eigen::Upper>();
        damped.diagonal().array() += damping * diagonal;
        const Eigen::VectorXd x = damped.llt().solve(gradient);
        Eigen::MatrixX3d trial = c;
        for (int k = 0; k < 3; ++k)
          trial.col(k).bottomRows(K - 1).array() -= scale_.tail(K - 1) * x.segment(k * (K - 1), K - 1).array();
        State next = at(trial, field);
        better = next.energy < state.energy;
        if (better) {
          result.converged =
              std::sqrt(next.energy) > (1 - options.tolerance) * std::sqrt(state.energy) || next.energy < 1e-22 * norm;
          c = std::move(trial);
          state = std::move(next);
          damping = std::max(damping / 10, 1e-14);
        } else {
          damping *= 10;
        }
      }
      if (!better) result.converged = true;  // no descent at any length: a minimum to rounding
    }
    result.surface = HarmonicSurface(std::move(c));
    result.residual = std::sqrt(state.energy / norm);
    return result;
  }

 private:
  struct State {
    Mat3X fu, fv, normal, difference;  // normal: not of unit length; difference: h(f) - field
    double energy;
  };
  struct NormalMatrix {
    Eigen::MatrixXd normal;  // its upper triangle
    Eigen::VectorXd gradient;
  };

  State at(const Eigen::MatrixX3d& c, const Mat3X& field) const {
    State s{(basis_.yu * c).transpose(), (basis_.yv * c).transpose(), Mat3X(3, field.cols()), -field, 0};
    for (Index i = 0; i < field.cols(); ++i) {
      const Vec3d n = Vec3d(s.fu.col(i)).cross(Vec3d(s.fv.col(i)));
      s.normal.col(i) = n;
      const double density = n.norm();
      if (density > 0) s.difference.col(i) += n / std::sqrt(density);
    }
    s.energy = s.difference.colwise().squaredNorm() * weights_;
    return s;
  }

  /// Of h with n = f_u x f_v: dh = (1 - n n^T / (2 |n|^2)) (f_u x df_v - f_v x df_u) / sqrt|n|.
  NormalMatrix linearise(const State& s, const Mat3X& field) const {
    const Index K = basis_.y.cols() - 1, n = field.cols();  // without the constant, which is a translation
    NormalMatrix out{Eigen::MatrixXd::Zero(3 * K, 3 * K), Eigen::VectorXd::Zero(3 * K)};
    constexpr Index tile = 128;
    Eigen::MatrixXd rows;
    Eigen::VectorXd values;
    for (Index first = 0; first < n; first += tile) {
      const Index count = std::min(tile, n - first);
      rows.resize(3 * count, 3 * K);
      values.resize(3 * count);
      const Eigen::MatrixXd yu = basis_.yu.block(first, 1, count, K) * scale_.tail(K).matrix().asDiagonal(),
                            yv = basis_.yv.block(first, 1, count, K) * scale_.tail(K).matrix().asDiagonal();
      for (Index j = 0; j < count; ++j) {
        const Index i = first + j;
        const Vec3d normal = s.normal.col(i);
        const double density = std::max(normal.norm(), 1e-300), root = std::sqrt(weights_[i]);
        const Mat3 A =
            (Mat3::Identity() - normal * normal.transpose() / (2 * density * density)) * (root / std::sqrt(density));
        const Mat3 by_u = -A * cross_matrix(s.fv.col(i)), by_v = A * cross_matrix(s.fu.col(i));
        for (int a = 0; a < 3; ++a) {
          values[a * count + j] = root * s.difference(a, i);
          for (int k = 0; k < 3; ++k)
            rows.row(a * count + j).segment(k * K, K) = by_u(a, k) * yu.row(j) + by_v(a, k) * yv.row(j);
        }
      }
      out.normal.selfadjointView<Eigen::Upper>().rankUpdate(rows.transpose());
      out.gradient.noalias() += rows.transpose() * values;
    }
    return out;
  }

  static Mat3 cross_matrix(const Vec3d& a) {
    Mat3 m;
    m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
    return m;
  }

  ChartBatch charts_;
  Eigen::VectorXd weights_;
  HarmonicTangents basis_;
  Eigen::ArrayXd scale_;
};

/// The straight line between the square-root normal fields of two surfaces that are in correspondence, sent back to surfaces:
/// a geodesic of the elastic metric as far as fields between can be inverted, which the residuals tell.
class SrnfPath {
 public:
  /// first, second   projections of the surfaces, of one degree: what a higher degree holds is not the path's
  SrnfPath(HarmonicSurface first, HarmonicSurface second, const SrnfInversion& inversion, const SphereQuadrature& q)
      : first_(std::move(first)),
        second_(std::move(second)),
        inversion_(&inversion),
        h1_(srnf(first_, q.points)),
        h2_(srnf(second_, q.points)),
        distance_(std::sqrt(double((h1_ - h2_).colwise().squaredNorm() * q.weights))) {
    require(first_.degree() == inversion.degree() && second_.degree() == inversion.degree(),
            "SrnfPath: surfaces of degrees ", first_.degree(), " and ", second_.degree(), ", the inversion's is ",
            inversion.degree());
  }

  /// |h1 - h2| in L2: length of the path.
  double distance() const { return distance_; }

  /// The surface at fraction tau of the way, by the inversion from the mixture of both, and centred as that is.
  InversionResult at(double tau, const InversionOptions& options = {}) const {
    const HarmonicSurface start((1 - tau) * first_.coefficients() + tau * second_.coefficients());
    return (*inversion_)((1 - tau) * h1_ + tau * h2_, start, options);
  }

 private:
  HarmonicSurface first_, second_;
  const SrnfInversion* inversion_;
  Mat3X h1_, h2_;
  double distance_;
};

}  // namespace dsns
