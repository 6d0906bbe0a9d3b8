#pragma once
/// Motions as curves of principal components, for the experiments of `evaluate temporal`.
#include "commands.hpp"

#include <dsns/stats/co_registration.hpp>

#include <chrono>
#include <string>
#include <vector>

namespace dsns::program {

class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Points of the body's sphere drawn by the area of its surface, so that all weigh the same.
Mat3X points_of(const Body& body, const Settings& settings);
/// O F(y, t) at points of the sphere.
SurfaceSamples samples_at(const AnyAnimatedSurface& surface, const Mat3X& y, const Mat3& rotation, int snapshots);
FunctionalPca basis_of(const std::vector<SurfaceSamples>& samples);

/// Where a curve moves: |a'| of at least a hundredth of its maximum.
struct Moving {
  static constexpr int count = 1000;
  Eigen::VectorXd weights;  // at the middles of as many intervals; their sum is 1
  double rests = 0;         // share of the time

  explicit Moving(const Curve& curve) : weights(count) {
    for (int k = 0; k < count; ++k) weights[k] = curve.velocity((k + 0.5) / count).norm();
    weights = (weights.array() >= 0.01 * weights.maxCoeff()).cast<double>();
    rests = 1 - weights.sum() / count;
    weights /= weights.sum();
  }

  /// RMS difference of two warps there; the second is the inverse of `truth`.
  template <class W>
  double miss(const W& warp, const TimeWarp& truth) const {
    double sum = 0;
    for (int k = 0; k < count; ++k) {
      if (weights[k] == 0) continue;
      const double t = (k + 0.5) / count, error = warp(t) - truth.inverse(t);
      sum += weights[k] * error * error;
    }
    return std::sqrt(sum);
  }
};

/// A random warp of the slopes that the experiment asks for.
TimeWarp random_pace(const TemporalEvaluation& evaluation, int number, const Settings& settings);
/// Draws those of an evaluation into its folder.
/// returns  whether there is a picture; the script for gnuplot is there in any case
bool draw_paces(const TemporalEvaluation& evaluation, const Settings& settings);

/// A curve as a function, or samples of it alone.
struct MotionCurve {
  std::string surface;
  int samples;  // frames of the fit, or of the curve; 0: all
  int frames;   // the same, counted
  Curve curve;
};

/// The curves of one sequence, as functions of surfaces fitted from so many frames, 0 for all.
std::vector<MotionCurve> curves_of(const Body& body, const std::vector<int>& frame_counts, const Settings& settings,
                                   Report& report);

}  // namespace dsns::program
