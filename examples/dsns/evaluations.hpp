#pragma once
/// evaluate spatial, correspondence, statistics: registration and means against truths that are known; and registration in space
/// alone.
#include "bodies.hpp"
#include "landmarks.hpp"

#include <dsns/stats/symmetric_registration.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace dsns::program {

enum class SecondMap {
  own,    ///< the warped sequence and the one it is registered to share their sphere map
  again,  ///< the latter is mapped anew, its vertices in another order
};

struct SpatialEvaluation {
  std::vector<double> degrees{4, 6, 8.5};  ///< sizes of the warps, degrees rms
  int warps = 1;                           ///< of each size
  int warp_degree = 3;                     ///< of the fields
  SecondMap map = SecondMap::own;
  std::vector<std::string> without;  ///< parts to leave out: jacobian, smoothing, positions, refinement
  std::filesystem::path csv, markdown, plot;
};
/// Warps and turns every sequence by maps that are known and registers it back. With fitted surfaces both sides are fitted with
/// seeds of their own.
/// returns  how many sources could not be used
int evaluate_spatial(const std::vector<std::string>& sources, const Settings& settings,
                     const SpatialEvaluation& evaluation, Report& report);

/// Laws that a registration of two bodies in space should obey, whatever is true: there and back is no way; a turn that both
/// bodies make, or a warp of both spheres by `degrees`, goes with the result.
void evaluate_consistency(const Body& first, const Body& second, double degrees, const Settings& settings,
                          Report& report);

struct CorrespondenceEvaluation {
  int seeds = 1;           ///< runs, each with its own remeshing, turn and warp
  double degrees = 5;      ///< size of the warp, rms
  bool baselines = false;  ///< also the schemes of the paper and of the released code
  bool refine = false;     ///< also the elastic refinement from the correspondence
  std::filesystem::path markdown;
};
/// Two bodies whose vertices correspond by number, which is not shown: the second is remeshed, its sphere turned and warped.
void evaluate_correspondence(const std::string& first, const std::string& second, const Settings& settings,
                             const CorrespondenceEvaluation& evaluation, Report& report);

struct TrackEvaluation {
  double density = 4;  ///< vertices of a frame, times those of the animation, about
};
/// Every frame of an animation gets triangles of its own, and track() is judged by where the vertices truly are. `out`: both, or
/// empty.
void evaluate_track(const std::string& source, const std::filesystem::path& out, const TrackEvaluation& evaluation,
                    const Settings& settings, Report& report);

struct StatisticsEvaluation {
  std::vector<int> copies{2, 6, 20};
  double degrees = 5;   ///< size of the warps of the spheres, rms
  double noise = 1e-4;  ///< of every coordinate, of the body's size
  int level = 5;        ///< of the icosphere on which the copies are sampled
  int reordered = 6;    ///< the mean is taken again in another order of so many copies, at most
  std::filesystem::path markdown;
};
/// Means of warped, turned, noisy copies of one motion, each on a clock of its own, against that motion.
void evaluate_statistics(const StatisticsEvaluation& evaluation, const Settings& settings, Report& report);

/// In space: one way where options.views is 0, else symmetrically.
SpatialResult register_spatial(const AnyAnimatedSurface& first, const AnyAnimatedSurface& second,
                               const SymmetricOptions& options, const Progress& progress);

/// Where `register --spatial-only` begins.
enum class SpatialBeginning { rotation, correspondence };
/// Registers in space alone: equal times correspond. `out` may be empty: nothing is written.
void register_spatial_only(const Body& first, const Body& second, const std::filesystem::path& out,
                           SpatialBeginning beginning, const LandmarkFile& landmarks, const Settings& settings,
                           Report& report);

}  // namespace dsns::program
