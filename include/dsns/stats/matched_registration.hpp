#pragma once
/// Registration in space of bodies of different shape or pose: correspond() finds which point is which, the elastic metric
/// sharpens it where it can. Needs Spectra (dsns::spectra).
#include <dsns/matching/correspond.hpp>
#include <dsns/sphere/fit_diffeomorphism.hpp>
#include <dsns/stats/co_registration.hpp>

namespace dsns {

struct MatchedRegistrationOptions {
  RegistrationOptions registration;  ///< spatial.levels, spatial.refinement and spatial.start are not used
  CorrespondOptions correspond;
  SphereLandmarks landmarks;  ///< of the correspondence, and of the refinement
  DiffeomorphismFitOptions smoothing{{1, 2, 4, 8, 12, 16, 20, 20, 24, 24}};  ///< of the correspondence, for derivatives
  std::vector<SpatialLevel> levels{{8, 16, 0.0, 0.5}};                       ///< from there on
  std::vector<SpatialLevel> refinement{{10, 12, 0.0, 0.5}, {14, 16, 0.0, 0.5}, {18, 20, 0.0, 0.5}};  ///< and then
  /// Elastic energy, as a share of the first body's, up to which the refinement is believed: of bodies in one pose 0.02 to 0.05
  /// is left and correspondences get better, of different poses 0.3 and they get worse.
  double believed = 0.1;
};

struct MatchedRegistration {
  SpatialResult spatial;
  CorrespondenceSummary correspondence;
  bool refined = false;  ///< else `spatial` is the smoothed correspondence
};

/// Brings the second moving surface to the first; both as in register_in_space, and as bodies of the same sphere maps.
template <AnimatedSurface F1, AnimatedSurface F2>
MatchedRegistration register_matched(const F1& first, MatchingBody first_body, const F2& second,
                                     MatchingBody second_body, const MatchedRegistrationOptions& options = {},
                                     const Progress& progress = {}) {
  const SphereQuadrature q = fibonacci_sphere(4000);
  const Eigen::VectorXd density = area_densities(tangents(first, charts_at(q.points), 0.0));
  Correspondence c =
      correspond(std::move(first_body), std::move(second_body), options.correspond, {}, options.landmarks, progress);
  MatchedRegistration out{{}, std::move(c.summary), false};
  RegistrationOptions from = options.registration;
  from.spatial.search = RotationSearch::none;
  from.spatial.levels = options.levels;
  from.spatial.refinement = options.refinement;
  from.spatial.landmarks = options.landmarks;
  from.spatial.start.gamma = smoothed(c.gamma, options.smoothing).gamma;
  if (options.registration.spatial.search == RotationSearch::full)
    from.spatial.start.rotation =
        nearest_rotation(positions(first, q.points, 0.0) * density.asDiagonal() *
                         positions(second, from.spatial.start.gamma(q.points), 0.0).transpose());
  out.spatial = register_in_space(first, second, from, progress);
  out.refined = out.spatial.summary.energy_after <= options.believed * out.spatial.summary.norm;
  if (out.refined) return out;
  SpatialResult& s = out.spatial;
  s.rotation = from.spatial.start.rotation;
  s.gamma = from.spatial.start.gamma;
  s.summary.energy_after = s.summary.energy_before;
  s.summary.min_jacobian = certify(s.gamma).min_jacobian;
  s.summary.steps = 0;
  s.summary.stop = "the correspondence is kept: the elastic energy stays too high to improve on it";
  return out;
}

}  // namespace dsns
