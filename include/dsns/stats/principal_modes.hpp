#pragma once
/// Principal modes of motions that are registered to their mean: starting pose, shape in motion and pace, together or each
/// alone. A motion is the vector of its start, its q on the mean's clock, and the tangent of its warp at the identity.
///
///   const PrincipalModes modes(mean, curves);
///   const RegisteredMotion faster = modes.at(modes.deviations(0, 2));   // two standard deviations along the first
#include <dsns/stats/karcher_mean.hpp>
#include <dsns/stats/linear_model.hpp>

#include <utility>

namespace dsns {

/// On the Hilbert sphere of psi = sqrt(zeta'), the tangent at the identity that leads to the warp: its values on the grid.
inline Eigen::VectorXd warp_tangent(const TimeWarp& warp, const TimeGrid& grid) {
  Eigen::VectorXd psi(grid.times.size());
  for (Index k = 0; k < psi.size(); ++k) psi[k] = std::sqrt(std::max(warp.slope(grid.times[k]), 0.0));
  psi /= std::sqrt(psi.cwiseAbs2().dot(grid.weights));
  const double cosine = std::clamp(psi.dot(grid.weights), -1.0, 1.0), angle = std::acos(cosine);
  return (psi.array() - cosine) * (angle > 1e-8 ? angle / std::sin(angle) : 1.0);
}

/// The warp to which a tangent at the identity leads. It increases whatever the tangent is.
inline TimeWarp warp_of_tangent(const Eigen::VectorXd& tangent, const TimeGrid& grid) {
  constexpr double least_psi =
      1e-3;  // beyond a right angle from the identity psi would pass 0, where time stands still
  const double angle = std::sqrt(tangent.cwiseAbs2().dot(grid.weights));
  if (angle < 1e-14) return {};
  const Eigen::ArrayXd psi = std::cos(angle) + tangent.array() * (std::sin(angle) / angle);
  return TimeWarp::from_log_slope(2 * psi.abs().max(least_psi).log().matrix());
}

struct RegisteredMotion {
  Eigen::VectorXd start;  ///< K
  Eigen::MatrixXd q;      ///< on the mean's clock, K x n on the grid of time_grid()
  TimeWarp warp;          ///< takes the motion to the mean's clock

  /// Points on the mean's clock, K x n on the grid.
  Eigen::MatrixXd points() const { return integrate_srvf(start, q, time_grid()); }
  /// Points on the motion's own clock.
  Eigen::MatrixXd points_at_own_pace() const {
    const TimeGrid grid = time_grid();
    const Curve curve = curve_of_srvf(start, q);
    return integrate_srvf(start, warped_srvf(curve, inverse(warp), grid), grid);
  }
};

/// The motions of which a mean was taken, registered to it.
inline std::vector<RegisteredMotion> registered_motions(const KarcherMean& mean, const std::vector<Curve>& curves) {
  require(mean.warps.size() == curves.size(), "registered_motions: the mean of ", mean.warps.size(), " curves and ",
          curves.size(), " curves, give those of which it was taken");
  const TimeGrid grid = time_grid();
  std::vector<RegisteredMotion> motions;
  for (std::size_t i = 0; i < curves.size(); ++i)
    motions.push_back({curves[i].start(), warped_srvf(curves[i], mean.warps[i], grid), mean.warps[i]});
  return motions;
}

enum class MotionPart { all, start, shape, pace };

/// Motions as vectors whose Euclidean distances are sqrt(|starts|^2 + |qs|^2 + pace_weight |tangents of warps|^2).
class MotionFeatures {
 public:
  /// pace_weight  squared length unit; negative: such that pace varies as much as start and shape together
  MotionFeatures(const std::vector<RegisteredMotion>& motions, MotionPart part = MotionPart::all,
                 double pace_weight = -1)
      : part_(part), grid_(time_grid()), pace_root_(1) {
    require(!motions.empty(), "MotionFeatures: no motions, give at least one");
    dimension_ = motions.front().start.size();
    members_.resize(vector_of(motions.front()).size(), Index(motions.size()));
    for (std::size_t i = 0; i < motions.size(); ++i) members_.col(Index(i)) = vector_of(motions[i]);
    if (part_ != MotionPart::all) return;
    const auto pace = members_.bottomRows(grid_.times.size());
    const auto variance = [](const auto& x) { return (x.colwise() - x.rowwise().mean()).squaredNorm(); };
    const double paces = variance(pace), shapes = variance(members_.topRows(members_.rows() - grid_.times.size()));
    pace_root_ = std::sqrt(pace_weight >= 0 ? pace_weight : paces > 0 ? shapes / paces : 0.0);
    members_.bottomRows(grid_.times.size()) *= pace_root_;
  }

  /// One a column.
  const Eigen::MatrixXd& members() const { return members_; }
  double pace_weight() const { return pace_root_ * pace_root_; }

  Eigen::VectorXd vector_of(const RegisteredMotion& motion) const {
    const Eigen::RowVectorXd root = grid_.weights.cwiseSqrt().transpose();
    const Eigen::VectorXd shape = (motion.q * root.asDiagonal()).reshaped();
    const Eigen::VectorXd pace = pace_root_ * warp_tangent(motion.warp, grid_).cwiseProduct(root.transpose());
    if (part_ == MotionPart::start) return motion.start;
    if (part_ == MotionPart::shape) return shape;
    if (part_ == MotionPart::pace) return pace;
    Eigen::VectorXd all(motion.start.size() + shape.size() + pace.size());
    all << motion.start, shape, pace;
    return all;
  }
  /// The motion of a vector; parts that the vector does not have are those of `rest`.
  RegisteredMotion motion_of(const Eigen::VectorXd& vector, RegisteredMotion rest) const {
    const Index n = grid_.times.size(), K = dimension_;
    const Eigen::VectorXd inverse_root = grid_.weights.cwiseSqrt().cwiseInverse();
    const auto shape = [&](Index begin) {
      return Eigen::MatrixXd(vector.segment(begin, K * n).reshaped(K, n) * inverse_root.asDiagonal());
    };
    const auto pace = [&](Index begin) {
      if (!(pace_root_ > 0)) return rest.warp;
      return warp_of_tangent(vector.segment(begin, n).cwiseProduct(inverse_root) / pace_root_, grid_);
    };
    if (part_ == MotionPart::all || part_ == MotionPart::start) rest.start = vector.head(K);
    if (part_ == MotionPart::all || part_ == MotionPart::shape) rest.q = shape(part_ == MotionPart::all ? K : 0);
    if (part_ == MotionPart::all || part_ == MotionPart::pace)
      rest.warp = pace(part_ == MotionPart::all ? K + K * n : 0);
    return rest;
  }

 private:
  MotionPart part_;
  TimeGrid grid_;
  Index dimension_ = 0;
  double pace_root_;
  Eigen::MatrixXd members_;
};

/// accuracy a family along known directions has these modes and their variances [stats/principal_modes_test]
/// source   elastic functional components as in Tucker, Wu, Srivastava 2013, jointly with the pace
class PrincipalModes {
 public:
  PrincipalModes(const KarcherMean& mean, const std::vector<Curve>& curves, MotionPart part = MotionPart::all,
                 double pace_weight = -1)
      : features_(registered_motions(mean, curves), part, pace_weight),
        model_(features_.members()),
        mean_{mean.start, mean.q, TimeWarp()} {}

  const MotionFeatures& features() const { return features_; }
  const LinearModel& model() const { return model_; }

  /// Scores `deviations` standard deviations along one mode.
  Eigen::VectorXd deviations(Index mode, double deviations) const {
    require(mode >= 0 && mode < model_.modes(), "PrincipalModes: mode ", mode, " of ", model_.modes());
    Eigen::VectorXd scores = Eigen::VectorXd::Zero(mode + 1);
    scores[mode] = deviations * std::sqrt(model_.variances()[mode]);
    return scores;
  }
  /// The motion with these scores of the first modes; the mean in the parts that vary not.
  RegisteredMotion at(const Eigen::VectorXd& scores) const { return features_.motion_of(model_.at(scores), mean_); }

 private:
  MotionFeatures features_;
  LinearModel model_;
  RegisteredMotion mean_;
};

}  // namespace dsns
