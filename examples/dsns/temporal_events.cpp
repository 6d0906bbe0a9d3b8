#include "temporal_events.hpp"

namespace dsns::program {

std::array<std::optional<double>, 2> foot_strikes(const Body& body) {
  constexpr double far = 0.5;    // a body that goes less, in units of the root of its area, does not walk
  constexpr double foot = 0.05;  // feet are the lowest so much of the height
  const NormalizedSequence& n = body.normalized;
  const std::vector<Mat3X>& frames = n.sequence.frames;
  const Index last = Index(frames.size()) - 1;
  const Vec3d up(0, 1, 0);
  Vec3d way = (n.trajectory.col(last) - n.trajectory.col(0)) / n.scale;
  way -= up * up.dot(way);
  if (way.norm() < far || last < 4) return {};
  const Vec3d ahead = way.normalized(), side = up.cross(ahead);
  Mat3X mean = Mat3X::Zero(3, frames.front().cols());
  for (const Mat3X& x : frames) mean += x / double(frames.size());
  const Eigen::RowVectorXd height = up.transpose() * mean, lateral = side.transpose() * mean;
  const double ground = height.minCoeff() + foot * (height.maxCoeff() - height.minCoeff());
  std::array<std::optional<double>, 2> out;
  for (const int k : {0, 1}) {
    Eigen::VectorXd forward = Eigen::VectorXd::Zero(last + 1);
    double count = 0;
    for (Index i = 0; i < mean.cols(); ++i) {
      if (height[i] > ground || (lateral[i] > 0) != (k == 0)) continue;
      ++count;
      for (Index t = 0; t <= last; ++t) forward[t] += ahead.dot(frames[std::size_t(t)].col(i));
    }
    Index at = 0;
    forward.maxCoeff(&at);
    if (count == 0 || at == 0 || at == last) continue;
    const double before = forward[at - 1], here = forward[at], after = forward[at + 1];
    const double bend = before - 2 * here + after;  // the top of the parabola through the three
    out[std::size_t(k)] = (double(at) + (bend < 0 ? 0.5 * (before - after) / bend : 0)) / double(last);
  }
  return out;
}

}  // namespace dsns::program
