#pragma once
/// Functions of a point that do not change when a body bends: kernel signatures of its Laplacian, and from pairs of them
/// signatures that change their sign in a mirror, so that left and right differ.
#include <dsns/matching/intrinsic_laplacian.hpp>

namespace dsns {

struct DescriptorOptions {
  int waves = 16;  ///< channels of the wave kernel signature
  int heats = 8;   ///< channels of the heat kernel signature
  Index eigenpairs = 60;
  int wave_distance = 3;  ///< of channels paired for oriented signatures
  int heat_distance = 2;
};

namespace detail {

/// Weights of phi_k^2 in the wave kernel signature, a row for each energy: log-normal around energies equidistant in the
/// logarithm of lambda.
inline Eigen::MatrixXd wave_filters(const Eigen::VectorXd& eigenvalues, int energies) {
  const Eigen::ArrayXd log_lambda = eigenvalues.array().log();
  const double low = log_lambda[0],
               step = (0.98 * log_lambda[log_lambda.size() - 1] + 0.02 * low - low) / (energies - 1);
  Eigen::MatrixXd filters(energies, eigenvalues.size());
  for (int e = 0; e < energies; ++e) {
    filters.row(e) = (-0.5 * ((log_lambda - low - e * step) / (2.5 * step)).square()).exp();
    filters.row(e) /= filters.row(e).sum();
  }
  return filters;
}

}  // namespace detail

/// WKS_e(x) = sum_k w_e(lambda_k) phi_k(x)^2 and log HKS_t(x) = log sum_k exp(-lambda_k t) phi_k(x)^2, n x (waves + heats).
/// Energies and times span the spectrum used, so that the size of the body has no effect.
/// accuracy equal at corresponding points of isometric bodies to 1e-9 [matching/descriptors_test]
/// source   Aubry et al. 2011; Sun et al. 2009
inline Eigen::MatrixXd kernel_signatures(const IntrinsicSpectrum& spectrum, const DescriptorOptions& options = {}) {
  const Index k = std::min(options.eigenpairs, spectrum.size());
  require(options.waves >= 2 && options.heats >= 2 && k >= 2, "kernel_signatures: ", options.waves, " waves, ",
          options.heats, " heats of ", k, " eigenpairs, give at least 2 of each");
  const Eigen::VectorXd lambda = spectrum.eigenvalues.head(k);
  require(lambda.minCoeff() > 0, "kernel_signatures: an eigenvalue is ", lambda.minCoeff(), ", it must be positive");
  const Eigen::MatrixXd squares = spectrum.eigenfunctions.leftCols(k).array().square();

  Eigen::MatrixXd out(squares.rows(), options.waves + options.heats);
  out.leftCols(options.waves) = squares * detail::wave_filters(lambda, options.waves).transpose();
  const double first = 4 * std::log(10.0) / lambda[k - 1], last = 1.5 / lambda[0];
  for (int h = 0; h < options.heats; ++h) {
    const double t = first * std::pow(last / first, double(h) / (options.heats - 1));
    const Eigen::VectorXd decay = (-t * lambda.array()).exp();
    const double floor = 0.05 * decay.sum();  // nodes of the last eigenfunctions are no deep wells of the logarithm
    out.col(options.waves + h) = ((squares * decay).array() + floor).log();
  }
  return out;
}

/// The signed area that (f, g) covers by area of the surface around each vertex, <n, grad f x grad g>, n values. It needs
/// no lengths but for the area: df ^ dg is a 2-form.
/// accuracy of linear f and g on a mesh in space, n . (grad f x grad g) averaged over the faces, 1e-12
///          [matching/descriptors_test]
inline Eigen::VectorXd bracket(const Faces& faces, const Eigen::VectorXd& areas, const Eigen::VectorXd& f,
                               const Eigen::VectorXd& g) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(f.size());
  for (Index t = 0; t < faces.cols(); ++t) {
    const int a = faces(0, t), b = faces(1, t), c = faces(2, t);
    const double covered = 0.5 * ((f[b] - f[a]) * (g[c] - g[a]) - (f[c] - f[a]) * (g[b] - g[a]));
    for (const int v : {a, b, c}) sum[v] += covered / 3;
  }
  return sum.cwiseQuotient(areas);
}

/// Brackets of pairs of kernel signatures, compressed to [-1, 1] and smoothed by the eigenfunctions: equal where an
/// isometry keeps the orientation, opposite where it does not.
/// signatures  as kernel_signatures gave them for the same options
/// source      the operator is that of Ren et al. 2018
inline Eigen::MatrixXd oriented_signatures(const MatchingBody& body, const IntrinsicSpectrum& spectrum,
                                           const Eigen::MatrixXd& signatures, const DescriptorOptions& options = {}) {
  const Eigen::VectorXd areas = intrinsic_laplacian({body.faces(), body.edge_lengths()}, body.vertex_count()).masses;
  const Eigen::MatrixXd phi = spectrum.eigenfunctions.leftCols(std::min(options.eigenpairs, spectrum.size()));
  std::vector<Eigen::VectorXd> channels;
  const auto add = [&](int first, int second) {
    Eigen::VectorXd b = bracket(body.faces(), areas, signatures.col(first), signatures.col(second));
    const double square = b.cwiseAbs2().dot(areas) / areas.sum();
    b.array() /= (b.array().square() + square).sqrt();
    channels.push_back(phi * (phi.transpose() * areas.cwiseProduct(b)) / areas.sum());
  };
  for (int w = 0; w + options.wave_distance < options.waves; ++w) add(w, w + options.wave_distance);
  for (int h = 0; h + options.heat_distance < options.heats; ++h)
    add(options.waves + h, options.waves + h + options.heat_distance);
  Eigen::MatrixXd out(signatures.rows(), static_cast<Index>(channels.size()));
  for (Index c = 0; c < out.cols(); ++c) out.col(c) = channels[std::size_t(c)];
  return out;
}

/// Kernel signatures, then oriented ones, n x channels.
inline Eigen::MatrixXd descriptors(const MatchingBody& body, const IntrinsicSpectrum& spectrum,
                                   const DescriptorOptions& options = {}) {
  const Eigen::MatrixXd plain = kernel_signatures(spectrum, options),
                        oriented = oriented_signatures(body, spectrum, plain, options);
  Eigen::MatrixXd out(plain.rows(), plain.cols() + oriented.cols());
  out << plain, oriented;
  return out;
}

/// Both bodies' channels with common mean 0 and mean square 1 under their masses, in place of the given ones.
struct DescriptorPair {
  Eigen::MatrixXd first, second;
};

inline DescriptorPair normalized_together(const Eigen::MatrixXd& first, const Eigen::VectorXd& first_masses,
                                          const Eigen::MatrixXd& second, const Eigen::VectorXd& second_masses) {
  require(first.cols() == second.cols() && first.rows() == first_masses.size() && second.rows() == second_masses.size(),
          "normalized_together: ", first.cols(), " and ", second.cols(), " channels at ", first.rows(), " and ",
          second.rows(), " vertices");
  const Eigen::VectorXd w1 = 0.5 * first_masses / first_masses.sum(), w2 = 0.5 * second_masses / second_masses.sum();
  const Eigen::RowVectorXd mean = w1.transpose() * first + w2.transpose() * second;
  DescriptorPair out{first.rowwise() - mean, second.rowwise() - mean};
  const Eigen::RowVectorXd square = w1.transpose() * out.first.cwiseAbs2() + w2.transpose() * out.second.cwiseAbs2();
  require(square.minCoeff() > 0, "normalized_together: a channel is constant on both bodies, leave it out");
  const Eigen::RowVectorXd scale = square.cwiseSqrt().cwiseInverse();
  out.first *= scale.asDiagonal();
  out.second *= scale.asDiagonal();
  return out;
}

}  // namespace dsns
