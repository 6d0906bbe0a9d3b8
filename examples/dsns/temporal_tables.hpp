#pragma once
/// What `evaluate temporal` measures, as CSV, Markdown and a plot.
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace dsns::program {

/// A known warp of a sequence, recovered.
struct RecoveryRow {
  std::string file;
  std::string surface;  ///< fitted, sampled (of which the curves are functions), or raw (samples of the curves alone)
  std::string method;   ///< before, dp, network, ours
  int samples = 0;      ///< frames that the surface is fitted from, or samples of the curves
  int warp = 0;
  double warp_l2 = 0;  ///< where the curve moves, in shares of the clip
  double seconds = 0;
};

/// Two sequences, registered in time.
struct PairRow {
  std::string first, second;
  std::string method;  ///< before, dp, ours
  int samples = 0;     ///< of the dynamic programming
  double distance = 0;
  std::optional<double> timing;  ///< RMS error at the frames of a clip that both perform, in shares of the clip
  std::optional<double> events;  ///< mean error at foot strikes or jaw openings, likewise
  double seconds = 0;
};

/// A motion against a part of it, or against more than one of its cycles.
struct StretchRow {
  std::string file, content;
  int warp = 0;                           ///< 0: at the motion's own pace
  double miss_whole = 0, miss_named = 0;  ///< RMS, by the default and by the option made for it, in shares of the clip
  double energy_whole = 0, energy_named = 0;  ///< left, as a share of the first's length
  double first_end = 1, second_begin = 0, second_passes = 1;
  double seconds = 0;
  std::string advice;  ///< of the default
};

struct Quantiles {
  std::size_t count = 0;
  double mean = 0, std = 0, median = 0, high = 0, most = 0;  ///< high: the 95th percentile
};
Quantiles quantiles(std::vector<double> values);

/// Rows of one method, surface and number of samples, in the order in which they first appear.
struct RecoveryGroup {
  std::string label, surface, method;
  int samples = 0;
  Quantiles warp_l2, seconds;
  std::vector<double> values;
};
std::vector<RecoveryGroup> groups(const std::vector<RecoveryRow>& rows);

struct PairGroup {
  std::string label, method;
  int samples = 0;
  Quantiles distance, timing, events, seconds;
};
std::vector<PairGroup> groups(const std::vector<PairRow>& rows);

std::string csv(const std::vector<RecoveryRow>& rows);
std::string csv(const std::vector<PairRow>& rows);
std::string csv(const std::vector<StretchRow>& rows);
std::string markdown(const std::vector<RecoveryRow>& rows);
std::string markdown(const std::vector<PairRow>& rows);
std::string markdown(const std::vector<StretchRow>& rows);

/// Boxes of the errors, drawn by gnuplot into folder/temporal_warps.svg; the script stays beside it.
/// returns  whether there is a picture
bool draw_boxes(const std::vector<RecoveryRow>& rows, const std::filesystem::path& folder);

}  // namespace dsns::program
