#pragma once
/// What a body is, whatever it does: the spectrum of its Laplacian, which no bending changes and which needs no correspondence.
/// Needs Spectra (dsns::spectra).
///
///   const Eigen::VectorXd a = shape_dna(body, 60), b = shape_dna(other, 60);   // MatchingBodies
///   (a - b).norm();                           // root mean square relative difference of their eigenvalues
#include <dsns/matching/intrinsic_spectrum.hpp>

namespace dsns {

/// log(lambda_k) / sqrt(count) of the lowest `count` eigenvalues but 0. Weyl's law, that eigenvalues grow like their number,
/// gives each the same weight.
/// source   Reuter, Wolter, Peinecke 2006
inline Eigen::VectorXd shape_dna(const IntrinsicSpectrum& spectrum, Index count) {
  require(count >= 1 && count <= spectrum.size(), "shape_dna: ", count, " eigenvalues of ", spectrum.size());
  require(spectrum.eigenvalues[0] > 0, "shape_dna: an eigenvalue is ", spectrum.eigenvalues[0],
          ", it must be positive: is the mesh in pieces?");
  return spectrum.eigenvalues.head(count).array().log() / std::sqrt(double(count));
}

/// Of the body's lengths averaged over its frames, in units in which its mean area is 1: its size has no effect.
/// accuracy no change where a mesh is turned, grows or is dented without stretching, 1e-9; two bodies that bend two ways are told
///          apart [matching/shape_dna_test]
inline Eigen::VectorXd shape_dna(const MatchingBody& body, Index count = 60) {
  return shape_dna(intrinsic_spectrum(body, count), count);
}

}  // namespace dsns
