#pragma once
/// Random members of a group that are motions of a surface as its members are: time goes forward, nothing is torn, nothing swells.
/// A linear model knows none of this, so samples are drawn until enough are valid.
///
///   const MotionInspection inspect(frames, modes.at({}).points(), faces);     // frames of a MovingMean
///   const ValidityBounds bounds = bounds_of_members(defects_of_members);      // by inspect
///   const ValidSamples samples = draw_valid_samples(modes, inspect, bounds, {.modes = 3, .count = 20, .seed = 1});
#include <dsns/mesh/folds.hpp>
#include <dsns/stats/principal_modes.hpp>

#include <functional>
#include <utility>

namespace dsns {

struct MotionDefects {
  double min_slope = 1;  ///< of the warp to the mean's clock
  double folded = 0;     ///< largest share of the area over the times, see FoldedShare
  double collapsed = 0;  ///< the same, of the mean's area
  double growth = 0;     ///< largest |log| of the area, divided by the mean's, over the times
};

struct InspectionOptions {
  int times = 9;
  FoldOptions folds;
};

class MotionInspection {
 public:
  /// Points of a curve on the grid of time_grid() as vertices at so many equidistant times.
  using Frames = std::function<std::vector<Mat3X>(const Eigen::MatrixXd& points, int times)>;

  /// mean   points of the mean's curve
  /// faces  those that count, of the frames' vertices
  MotionInspection(Frames frames, const Eigen::MatrixXd& mean, Faces faces, const InspectionOptions& options = {})
      : frames_(std::move(frames)), share_(std::move(faces), options.folds), mean_(frames_(mean, options.times)) {}

  MotionDefects operator()(const RegisteredMotion& motion) const {
    MotionDefects defects{motion.warp.min_slope()};
    const std::vector<Mat3X> shown = frames_(motion.points(), static_cast<int>(mean_.size()));
    for (std::size_t k = 0; k < shown.size(); ++k) {
      defects.folded = std::max(defects.folded, share_.folded(shown[k]));
      defects.collapsed = std::max(defects.collapsed, share_.collapsed(shown[k], mean_[k]));
      const double ratio = area({shown[k], share_.faces()}) / area({mean_[k], share_.faces()});
      defects.growth = std::max(defects.growth, std::abs(std::log(ratio)));
    }
    return defects;
  }

 private:
  Frames frames_;
  FoldedShare share_;
  std::vector<Mat3X> mean_;
};

struct ValidityBounds {
  double min_slope = 0.01;  ///< at least: below a hundredth of the mean's pace time as good as stands
  double folded = 0;        ///< at most; likewise below
  double collapsed = 0;
  double growth = 0.1;
};

/// Registration itself tears some members, so none can be asked of a sample what they do not keep; the worst of them is no
/// example either. A sample may be as torn as the median member, and `tolerance` of the area more. Its area may differ from the
/// mean's by a tenth more than that of any member: q enters squared, so that far from the mean limbs swell without a fold.
inline ValidityBounds bounds_of_members(const std::vector<MotionDefects>& members, double tolerance = 0.002) {
  require(!members.empty() && tolerance >= 0, "bounds_of_members: ", members.size(), " members, tolerance ", tolerance,
          ", give at least one and no negative tolerance");
  const auto median = [&](double MotionDefects::*what) {
    std::vector<double> values;
    for (const MotionDefects& m : members) values.push_back(m.*what);
    std::sort(values.begin(), values.end());
    return (values[(values.size() - 1) / 2] + values[values.size() / 2]) / 2;
  };
  ValidityBounds bounds;
  bounds.folded = median(&MotionDefects::folded) + tolerance;
  bounds.collapsed = median(&MotionDefects::collapsed) + tolerance;
  double most = 0;
  for (const MotionDefects& m : members) most = std::max(most, m.growth);
  bounds.growth += most;
  return bounds;
}

struct SampleOptions {
  Index modes = 3;    ///< along which the samples vary
  int count = 20;     ///< how many are wanted
  int attempts = 20;  ///< draws for each of these, at most
  double spread = 1;  ///< standard deviations of the scores, of the members'
  std::uint64_t seed = 0;
};

struct ValidSample {
  RegisteredMotion motion;
  Eigen::VectorXd scores;
  MotionDefects defects;
};

struct ValidSamples {
  std::vector<ValidSample> samples;
  int draws = 0;
  int slow = 0, folded = 0, collapsed = 0, swollen = 0;  ///< draws rejected, each for the first of these that it is
  bool complete = false;                                 ///< as many as were wanted
};

/// Scores are normal, cut off at three deviations; of the draws, in their order, the first that are within the bounds.
/// accuracy exactly those that do not fold, where the folding is known [stats/valid_samples_test]
inline ValidSamples draw_valid_samples(const PrincipalModes& modes,
                                       const std::function<MotionDefects(const RegisteredMotion&)>& inspect,
                                       const ValidityBounds& bounds, const SampleOptions& options = {}) {
  require(options.count >= 1 && options.attempts >= 1 && options.spread > 0 && std::isfinite(options.spread),
          "draw_valid_samples: ", options.count, " samples, ", options.attempts, " draws for each, spread ",
          options.spread, ", all must be positive");
  const Eigen::MatrixXd scores =
      options.spread * random_scores(modes.model(), options.modes, options.count * options.attempts, options.seed);
  ValidSamples result;
  while (!result.complete && result.draws < scores.cols()) {
    const Eigen::VectorXd drawn = scores.col(result.draws++);
    RegisteredMotion motion = modes.at(drawn);
    const MotionDefects defects = inspect(motion);
    if (!(defects.min_slope >= bounds.min_slope))
      ++result.slow;
    else if (!(defects.folded <= bounds.folded))
      ++result.folded;
    else if (!(defects.collapsed <= bounds.collapsed))
      ++result.collapsed;
    else if (!(defects.growth <= bounds.growth))
      ++result.swollen;
    else
      result.samples.push_back({std::move(motion), drawn, defects});
    result.complete = static_cast<int>(result.samples.size()) == options.count;
  }
  return result;
}

}  // namespace dsns
