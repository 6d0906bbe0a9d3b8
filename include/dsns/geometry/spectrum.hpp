#pragma once
/// Eigenvalues and eigenfunctions of the Laplace-Beltrami operator of any surface over the sphere, and what they solve.
///
///   const auto spectrum = laplace_beltrami_spectrum(dsns::Ellipsoid{1, 2, 5}, {.degree = 30, .count = 100});
///   spectrum.eigenvalues;                                     // 0 first, ascending
///   const auto u = dsns::heat_flow(spectrum, initial, 0.1);   // a function of s, as `initial` is
///
/// Rayleigh-Ritz in the harmonics: for analytic surfaces the errors fall exponentially with the degree, first of the
/// low eigenvalues; of (degree + 1)^2 values the upper half means little, and `trusted_count` says how far to go.
#include <dsns/geometry/galerkin.hpp>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <limits>

namespace dsns {

struct SpectrumOptions {
  int degree = 20;  ///< of the harmonics
  int nodes = 0;    ///< as in GalerkinOptions
  Index count = 0;  ///< eigenpairs kept, from the lowest on; 0: all (degree + 1)^2
  int threads = 1;  ///< for the assembly
};

struct SpectrumSummary {
  double area = 0;
  double mass_condition = 0;  ///< of M in the 1-norm, estimated: some times the ratio of extreme area densities
  double residual = 0;        ///< largest entry of S c - lambda M c, divided by that of S c
  /// By eigenvalue, how far the same computation with three quarters of degree and nodes is off this one. It errs on
  /// the safe side where the errors fall with the degree; infinite where the smaller space has no such eigenvalue.
  Eigen::VectorXd estimated_errors;
};

/// -Laplacian(phi_k) = lambda_k phi_k, integral of phi_j phi_k dA = delta_jk; the largest coefficient of each is
/// positive.
struct LaplaceBeltramiSpectrum {
  int degree = 0;
  Eigen::VectorXd eigenvalues;   ///< ascending, length^-2; the first is 0
  Eigen::MatrixXd coefficients;  ///< a column for each eigenfunction, over the harmonics
  SphereQuadrature nodes;        ///< weights are areas on the surface: they integrate over it
  SpectrumSummary summary;

  Index size() const { return eigenvalues.size(); }
  HarmonicFunction eigenfunction(Index k) const {
    require(k >= 0 && k < size(), "eigenfunction: number ", k, " of ", size(), ", which are counted from 0");
    return {degree, coefficients.col(k)};
  }
  /// Values of all eigenfunctions at the n unit columns of s: n x size().
  Eigen::MatrixXd values(const Mat3X& s) const { return harmonics(s, degree) * coefficients; }
};

/// How many eigenvalues, from the lowest on, have an estimated error of at most `tolerance` times their size.
inline Index trusted_count(const LaplaceBeltramiSpectrum& spectrum, double tolerance) {
  Index k = 1;  // lambda_0 = 0 is exact
  while (k < spectrum.size() && spectrum.summary.estimated_errors[k] <= tolerance * spectrum.eigenvalues[k]) ++k;
  return k;
}

namespace detail {

/// M = L L^T and L^-1 S L^-T, whose eigenvalues are those of S c = lambda M c.
struct ReducedSystem {
  Eigen::LLT<Eigen::MatrixXd> factor;
  Eigen::MatrixXd matrix;
};

inline ReducedSystem reduce(const GalerkinSystem& system) {
  ReducedSystem reduced{Eigen::LLT<Eigen::MatrixXd>(system.mass), system.stiffness};
  require<DegenerateSurface>(reduced.factor.info() == Eigen::Success,
                             "laplace_beltrami_spectrum: the mass matrix is not positive: the surface's area density "
                             "varies too much for this degree, lower it or take more nodes");
  reduced.factor.matrixL().solveInPlace(reduced.matrix);
  reduced.matrix.transposeInPlace();
  reduced.factor.matrixL().solveInPlace(reduced.matrix);
  return reduced;
}

template <Surface S>
Eigen::VectorXd estimated_errors(const S& surface, const SphereQuadrature& q, const SpectrumOptions& options,
                                 const Eigen::VectorXd& eigenvalues) {
  const int latitudes = static_cast<int>(std::lround(std::sqrt(double(q.size()) / 2)));
  const int degree = 3 * options.degree / 4, nodes = std::max(degree + 1, 3 * latitudes / 4);
  const GalerkinSystem system = galerkin_system(surface, {degree, nodes, options.threads});
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(reduce(system).matrix, Eigen::EigenvaluesOnly);
  const Index common = std::min(eigenvalues.size(), eigen.eigenvalues().size());
  Eigen::VectorXd errors = Eigen::VectorXd::Constant(eigenvalues.size(), std::numeric_limits<double>::infinity());
  errors.head(common) = (eigen.eigenvalues().head(common) - eigenvalues.head(common)).cwiseAbs();
  errors[0] = 0;
  return errors;
}

}  // namespace detail

/// Eigenvalues and eigenfunctions of a surface; a dense problem in (degree + 1)^2 unknowns, of cubic cost.
/// accuracy 1e-12 of lambda_k on a sphere; 1e-9 of the 25 lowest of a spheroid 1:1:1.7 at degree 18
///          [geometry/spectrum_test: sphere, Sturm-Liouville]; of other surfaces as summary.estimated_errors says
/// throws   InvalidArgument as galerkin_nodes and for a negative count, DegenerateSurface where the surface is not
///          immersed at a node or its area density varies beyond the digits of the mass matrix
template <Surface S>
LaplaceBeltramiSpectrum laplace_beltrami_spectrum(const S& surface, const SpectrumOptions& options = {}) {
  require(options.count >= 0, "laplace_beltrami_spectrum: count is ", options.count, ", give 0 for all");
  const GalerkinOptions galerkin{options.degree, options.nodes, options.threads};
  LaplaceBeltramiSpectrum out;
  out.degree = options.degree;
  out.nodes = galerkin_nodes(galerkin);
  out.nodes.weights.array() *= detail::area_densities(tangents(surface, charts_at(out.nodes.points))).array();
  out.summary.area = out.nodes.weights.sum();

  const GalerkinSystem system = galerkin_system(surface, galerkin);
  const detail::ReducedSystem reduced = detail::reduce(system);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(reduced.matrix);
  require<Error>(eigen.info() == Eigen::Success,
                 "laplace_beltrami_spectrum: the eigenvalue iteration did not converge");
  const Index all = system.mass.cols(), count = options.count > 0 ? std::min(options.count, all) : all;
  out.eigenvalues = eigen.eigenvalues().head(count);
  out.eigenvalues[0] = 0;  // constants are in the space, and their gradient vanishes
  out.coefficients = reduced.factor.matrixU().solve(eigen.eigenvectors().leftCols(count));
  for (Index k = 0; k < count; ++k) {
    Index largest = 0;
    out.coefficients.col(k).cwiseAbs().maxCoeff(&largest);
    if (out.coefficients(largest, k) < 0) out.coefficients.col(k) *= -1;
  }

  const Eigen::MatrixXd image = system.stiffness * out.coefficients;
  const Eigen::MatrixXd miss = image - system.mass * out.coefficients * out.eigenvalues.asDiagonal();
  out.summary.residual = count > 1 ? miss.cwiseAbs().maxCoeff() / image.cwiseAbs().maxCoeff() : 0;
  out.summary.mass_condition = 1 / reduced.factor.rcond();
  out.summary.estimated_errors = detail::estimated_errors(surface, out.nodes, options, out.eigenvalues);
  return out;
}

/// Coefficients over the eigenfunctions of a function with given values at spectrum.nodes.points: its projection.
inline Eigen::VectorXd expand(const LaplaceBeltramiSpectrum& spectrum, const Eigen::VectorXd& values) {
  require(values.size() == spectrum.nodes.size(), "expand: ", values.size(), " values for the ", spectrum.nodes.size(),
          " nodes of the spectrum, give one for each of spectrum.nodes.points");
  const Eigen::MatrixXd y = harmonics(spectrum.nodes.points, spectrum.degree);
  return spectrum.coefficients.transpose() * (y.transpose() * spectrum.nodes.weights.cwiseProduct(values));
}

/// exp(-lambda t) for each eigenvalue.
/// throws   InvalidArgument for a negative time: heat does not flow back
inline Eigen::VectorXd heat_decay(const LaplaceBeltramiSpectrum& spectrum, double time) {
  require(time >= 0, "heat_decay: time is ", time, ", give one from 0 on");
  return (-time * spectrum.eigenvalues.array()).exp();
}

/// The solution at a time of u_t = Laplacian(u) on the surface with u(s, 0) = initial(s), a function of unit vectors.
/// time     length^2
/// accuracy the integral of u does not change, 1e-12; on the sphere harmonics decay as exp(-l (l + 1) t), 1e-12
///          [geometry/spectrum_test]
template <class F>
HarmonicFunction heat_flow(const LaplaceBeltramiSpectrum& spectrum, const F& initial, double time) {
  Eigen::VectorXd values(spectrum.nodes.size());
  for (Index i = 0; i < values.size(); ++i) values[i] = initial(Vec3d(spectrum.nodes.points.col(i)));
  const Eigen::VectorXd now = heat_decay(spectrum, time).cwiseProduct(expand(spectrum, values));
  return {spectrum.degree, spectrum.coefficients * now};
}

/// k_t(x, y) = sum_k exp(-lambda_k t) phi_k(x) phi_k(y): heat at x a time t after a unit of it was put at y, by area.
/// x, y     3 x n and 3 x m, unit; returns n x m
/// accuracy what is left out is of the order exp(-lambda t) / (4 pi t) with lambda the last eigenvalue: short times
///          need a high degree, and too short a time shows waves below zero
inline Eigen::MatrixXd heat_kernel(const LaplaceBeltramiSpectrum& spectrum, const Mat3X& x, const Mat3X& y,
                                   double time) {
  return spectrum.values(x) * heat_decay(spectrum, time).asDiagonal() * spectrum.values(y).transpose();
}

/// The sum of exp(-lambda t), which is the integral of k_t(x, x): area / (4 pi t) + 1/3 + O(t) on a sphere's topology.
/// source   McKean and Singer 1967
inline double heat_trace(const LaplaceBeltramiSpectrum& spectrum, double time) {
  return heat_decay(spectrum, time).sum();
}

/// |k_t(x, .) - k_t(y, .)| in L2 of the surface: n x m. It is small where many short paths lead from x to y.
/// source   Coifman and Lafon 2006
inline Eigen::MatrixXd diffusion_distances(const LaplaceBeltramiSpectrum& spectrum, const Mat3X& x, const Mat3X& y,
                                           double time) {
  const Eigen::VectorXd decay = heat_decay(spectrum, time);
  const Eigen::MatrixXd a = spectrum.values(x) * decay.asDiagonal(), b = spectrum.values(y) * decay.asDiagonal();
  Eigen::MatrixXd distances(a.rows(), b.rows());
  for (Index j = 0; j < b.rows(); ++j) distances.col(j) = (a.rowwise() - b.row(j)).rowwise().norm();
  return distances;
}

}  // namespace dsns
