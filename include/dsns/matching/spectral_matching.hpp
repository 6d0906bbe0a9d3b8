#pragma once
/// The intrinsic part of finding a correspondence of two bodies of different shape in different poses: a start, and the
/// functional map that refines it, chosen among candidates by how well it fits and by its orientation.
///
///   const auto [a, b] = spectral_pair(first, second);
///   const SpectralMatch match = match_spectrally(a, b);
///   const SpectralTargets targets = targets_for(match, a, b, sphere);      // sphere: e.g. icosphere(5)
///   Mat3X images = match.start(sphere.vertices), wanted = targets.of_map(match.map);
///
/// A diffeomorphism fitted to the targets, and to targets(images) again, is the correspondence.
#include <dsns/core/progress.hpp>
#include <dsns/matching/descriptor_starts.hpp>
#include <dsns/matching/descriptors.hpp>
#include <dsns/matching/intrinsic_spectrum.hpp>
#include <dsns/matching/map_orientation.hpp>
#include <dsns/matching/spectral_targets.hpp>

namespace dsns {

struct SpectralMatchOptions {
  DescriptorStartOptions starts;
  std::vector<int> coarse_sizes = {16, 20, 25, 30};  ///< functions, from every start; fewer lose what it knows
  /// From the chosen one.
  std::vector<int> fine_sizes = {30, 35, 40, 45, 50, 55, 60, 65, 70, 75, 80};
  FeatureWeights coarse_features = {.descriptors = 0.05};
  FeatureWeights fine_features = {.descriptors = 0.02};
  double orientation_weight = 0.05;  ///< a candidate's score is residual + this (1 - orientation)
  int samples = 4000;                ///< points of each body
  std::uint64_t seed = 0;            ///< of the samples
};

struct SpectralCandidate {
  double energy = 0;       ///< of the descriptors under the smooth start
  double residual = 0;     ///< of the coarse functional map
  double orientation = 0;  ///< of its matches, 1: kept, -1: flipped
  double score = 0;
};

struct SpectralMatch {
  SphereDiffeomorphism start;
  Eigen::MatrixXd map;  ///< orthogonal, of the last fine size
  std::vector<SpectralCandidate> candidates;
  std::size_t chosen = 0;  ///< of them
  double residual = 0;     ///< of the fine functional map
  double orientation = 0;  ///< of its matches
};

struct SpectralPair {
  SpectralBody first, second;
};

/// Spectra and descriptors of both bodies.
/// eigenpairs  kept of each
inline SpectralPair spectral_pair(MatchingBody first, MatchingBody second, Index eigenpairs = 80,
                                  const DescriptorOptions& options = {}) {
  IntrinsicSpectrum s1 = intrinsic_spectrum(first, eigenpairs), s2 = intrinsic_spectrum(second, eigenpairs);
  DescriptorPair d = normalized_together(descriptors(first, s1, options), first.masses(),
                                         descriptors(second, s2, options), second.masses());
  return {{std::move(first), std::move(s1), std::move(d.first)},
          {std::move(second), std::move(s2), std::move(d.second)}};
}

/// extra_starts  maps from the first sphere to the second that are tried beside those the descriptors propose, such as the
///               outcome of a spatial registration
inline SpectralMatch match_spectrally(const SpectralBody& first, const SpectralBody& second,
                                      const SpectralMatchOptions& options = {},
                                      const std::vector<SphereDiffeomorphism>& extra_starts = {},
                                      const Progress& progress = {}) {
  require(!options.coarse_sizes.empty() && !options.fine_sizes.empty(), "match_spectrally: give at least one size");
  report(progress, "descriptors", 0);
  std::vector<ScalarRegistration> starts =
      descriptor_starts(first.body, first.descriptors, second.body, second.descriptors, options.starts);
  for (const auto& gamma : extra_starts) starts.push_back({gamma, 0, 0});

  const SpectralPoints from = first.at(first.body.sample(options.samples, options.seed)),
                       to = second.at(second.body.sample(options.samples, options.seed + 1));
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(from.size());
  const MapOrientation orientation(from.sphere);
  SpectralMatch out;
  std::vector<Index> best;
  for (std::size_t k = 0; k < starts.size(); ++k) {
    report(progress, "functional maps", double(k) / double(starts.size()));
    const Mat3X images = starts[k].gamma(from.sphere);
    FunctionalMap coarse = zoom_out(from, ones, to, nearest_columns(images.cast<float>(), to.sphere.cast<float>()),
                                    options.coarse_sizes, options.coarse_features);
    SpectralCandidate c{starts[k].energy, coarse.residual, orientation(to.sphere(Eigen::all, coarse.matches)), 0};
    c.score = c.residual + options.orientation_weight * (1 - c.orientation);
    out.candidates.push_back(c);
    if (k == 0 || c.score < out.candidates[out.chosen].score) {
      out.chosen = k;
      best = std::move(coarse.matches);
    }
  }
  out.start = starts[out.chosen].gamma;
  report(progress, "functional map", 0);
  FunctionalMap fine = zoom_out(from, ones, to, best, options.fine_sizes, options.fine_features);
  out.map = std::move(fine.map);
  out.residual = fine.residual;
  out.orientation = orientation(to.sphere(Eigen::all, fine.matches));
  report(progress, "functional map", 1);
  return out;
}

/// Targets for the vertices of a triangulated sphere over the first body.
inline SpectralTargets targets_for(const SpectralMatch& match, const SpectralBody& first, const SpectralBody& second,
                                   const TriangleMesh& sphere, const FeatureWeights& features = {.descriptors = 0.02}) {
  return {first.at(sphere.vertices), first.body.area_weights(sphere), second, static_cast<int>(match.map.rows()),
          features};
}

}  // namespace dsns
