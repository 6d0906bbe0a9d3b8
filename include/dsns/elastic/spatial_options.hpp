#pragma once
/// Options and results of spatial registration.
#include <dsns/core/errors.hpp>
#include <dsns/sphere/landmarks.hpp>

#include <functional>
#include <string>
#include <vector>

namespace dsns {

/// Where to look for the rotation to start from.
enum class RotationSearch {
  full,     ///< any turn of the body and any turn of its sphere: for one body, or bodies placed at will
  upright,  ///< bodies stand alike (same up, same heading): turns of the sphere only, scored on positions
  none,     ///< the surfaces correspond roughly already: begin at SpatialOptions::start
};

/// How gamma acts on fields in the first levels. The refinement warps the surfaces themselves.
enum class FieldAction {
  half_density,  ///< sqrt(J) h(gamma), which keeps the norm and is the field of the warped surface
  as_published,  ///< h(gamma), without the factor: for comparison
};

/// A registration to start from: O and gamma as in SpatialResult.
struct SpatialStart {
  Mat3 rotation = Mat3::Identity();
  SphereDiffeomorphism gamma;
};

/// One stage, coarse to fine: fields of `field_degree` move surfaces cut at `surface_degree` and smoothed by the heat kernel.
struct SpatialLevel {
  int field_degree;
  int surface_degree;
  double smoothing;        ///< heat time on the unit sphere
  double position_weight;  ///< 1: positions alone, 0: the SRNF alone
};

struct SpatialOptions {
  RotationSearch search = RotationSearch::full;
  std::vector<SpatialLevel> levels = {
      {1, 6, 0.05, 0.5}, {2, 6, 0.05, 0.5}, {4, 8, 0.02, 0.5}, {6, 12, 0.004, 0.5}, {8, 16, 0.0, 0.5}};
  /// Afterwards, on surfaces that are warped before they are projected; empty: no refinement.
  std::vector<SpatialLevel> refinement = {{10, 12, 0.0, 0.5}, {14, 16, 0.0, 0.5}};
  /// In place of the last of these, for one step, where the ones before leave at most `one_body` of the squared norm: a body seen
  /// twice is found to the last detail, two bodies have details of their own.
  SpatialLevel finest = {20, 17, 0.0, 0.5};
  double one_body = 1e-3;
  SpatialStart start;  ///< with RotationSearch::none; what can be no better than it is given back
  FieldAction action = FieldAction::half_density;
  int steps_per_level = 8;
  int refinement_steps = 2;        ///< per level of the refinement; more while each leaves less than 0.3
  int latitudes = 24;              ///< quadrature of latitudes x 2 latitudes nodes
  int rotations = 600;             ///< candidates of the search
  int refined = 48;                ///< best candidates, 30 degrees apart, to which fields of degree 1 are fitted
  int bent = 8;                    ///< best of these, to which fields of degree 2 and 3 are fitted before one is chosen
  double damping = 1e-3;           ///< times (l(l + 1))^2: what a field of degree l must gain to be used
  double tolerance = 1e-3;         ///< a level ends when a step lowers the energy by less than this share of it
  double min_step_jacobian = 0.3;  ///< of a single increment
  double min_jacobian = 0.02;      ///< of the composition, at the quadrature nodes
  double longest_step = 0.8;       ///< radians
  int threads = 1;
  /// The part of the sphere on which the surfaces are compared, as weights from 0 to 1 at unit vectors of the first one's
  /// sphere, such as a SphereMask; empty: all of it.
  std::function<Eigen::VectorXd(const Mat3X&)> mask{};
  SphereLandmarks landmarks{};  ///< points of the first one's sphere and where they lie on the second's
};

/// The nodes with their weights times the mask.
inline SphereQuadrature masked(SphereQuadrature q, const SpatialOptions& options) {
  if (!options.mask) return q;
  const Eigen::VectorXd mask = options.mask(q.points);
  require(mask.size() == q.size() && mask.minCoeff() >= 0 && mask.maxCoeff() > 0,
          "SpatialOptions: the mask must give a weight for each point, none negative and not all 0");
  q.weights.array() *= mask.array();
  return q;
}

/// Energies are |h1 - O (h2 * gamma)|^2 of the SRNFs h at the last level's degree, squared length unit, whatever weight the
/// levels give to positions.
struct SpatialSummary {
  double energy_before = 0;  ///< at the identity, or at the start if one was given
  double energy_after = 0;
  double norm = 0;          ///< |h1|^2, to compare the energies with
  double min_jacobian = 1;  ///< over a grid four times finer than the fields' bandwidth
  int steps = 0;
  std::vector<double> energies;  ///< after every accepted step, of the level it belongs to, landmarks with it
  std::string stop;              ///< why it ended
  double landmarks_missed = 0;   ///< by their images, root mean square with their weights, radians
};

/// F2 is brought to F1 by O F2(gamma(s)).
struct SpatialResult {
  Mat3 rotation = Mat3::Identity();
  SphereDiffeomorphism gamma;
  SpatialSummary summary;
};

}  // namespace dsns
