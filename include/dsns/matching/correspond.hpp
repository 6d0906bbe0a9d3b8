#pragma once
/// Which point of one body is which of another, of different shape and in a different pose, as a diffeomorphism of their
/// spheres. Nothing is needed but the surfaces: no landmarks, no common connectivity, no pose.
///
///   const Correspondence c = correspond(matching_body(first), matching_body(second));   // or MatchingBody(sequence, sphere)
///   second(c.gamma(s), t);                                         // the point that corresponds to first(s, t)
///
/// Intrinsic spectra and descriptors propose starts, functional maps refine and judge them, and the diffeomorphism is fitted to
/// the targets of the best. Needs Spectra (dsns::spectra).
#include <dsns/matching/spectral_matching.hpp>
#include <dsns/matching/target_fit.hpp>

namespace dsns {

struct CorrespondOptions {
  Index eigenpairs = 80;
  DescriptorOptions descriptors;
  SpectralMatchOptions match;
  TargetFitOptions fit;
  int fixed_stages = 8;  ///< of the fit, to the targets of the spectral match; later ones to those of the map as it is
};

struct CorrespondenceSummary {
  std::vector<SpectralCandidate> candidates;
  std::size_t chosen = 0;  ///< of them
  double residual = 0;     ///< of the functional map
  double orientation = 0;  ///< of its matches, 1: kept everywhere, -1: flipped
  TargetFitSummary fit;
};

struct Correspondence {
  PiecewiseLinearDiffeomorphism gamma;  ///< from the first sphere to the second
  CorrespondenceSummary summary;
};

/// extra_starts  maps of the spheres that are tried beside those from the descriptors
/// landmarks     points of the first sphere with their places on the second
/// returns       a certified map. About 10 s for bodies of 13 000 vertices on one core, most of it for the fit.
/// throws        Error where an eigenvalue iteration does not converge
inline Correspondence correspond(MatchingBody first, MatchingBody second, const CorrespondOptions& options = {},
                                 const std::vector<SphereDiffeomorphism>& extra_starts = {},
                                 const SphereLandmarks& landmarks = {}, const Progress& progress = {}) {
  report(progress, "spectra", 0);
  const SpectralPair pair = spectral_pair(std::move(first), std::move(second), options.eigenpairs, options.descriptors);
  SpectralMatch match = match_spectrally(pair.first, pair.second, options.match, extra_starts, progress);
  const SpectralTargets targets =
      targets_for(match, pair.first, pair.second, icosphere(options.fit.level), options.match.fine_features);
  int stage = 0;
  const Mat3X fixed = targets.of_map(match.map);
  const auto now = [&](const Mat3X& images) -> Mat3X {
    return stage++ < options.fixed_stages ? fixed : targets(images);
  };
  TargetFit fit = fit_to_targets(match.start, now, options.fit, landmarks, progress);
  return {std::move(fit.map),
          {std::move(match.candidates), match.chosen, match.residual, match.orientation, std::move(fit.summary)}};
}

}  // namespace dsns
