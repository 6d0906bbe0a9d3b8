#include "temporal_events.hpp"

#include <algorithm>
#include <numeric>

namespace dsns::program {

namespace {

/// Times in [0, 1] at which the left and the right foot are farthest ahead of the body, which is when heels strike; none for a
/// foot that is so at the ends of the clip, and for bodies that do not go anywhere.
/// source   Zeni, Richards, Higginson 2008
Landmarks foot_strikes(const Body& body) {
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
  Landmarks out;
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

/// Times at which a chin has first come half way down and is last half way up again; none for a body whose lowest-going part
/// goes down by less than 3 % of the root of its area, or is not up again at the end.
Landmarks jaw_openings(const Body& body) {
  constexpr double far = 0.03;
  constexpr double chin = 0.02;  // of the vertices, those that go down most
  const std::vector<Mat3X>& frames = body.normalized.sequence.frames;
  const Index n = frames.front().cols();
  Eigen::VectorXd lowest = Eigen::VectorXd::Zero(n);
  for (const Mat3X& x : frames) lowest = lowest.cwiseMin((x.row(1) - frames.front().row(1)).transpose());
  std::vector<Index> order(std::size_t(n), 0);
  std::iota(order.begin(), order.end(), Index(0));
  const std::size_t count = std::max<std::size_t>(1, std::size_t(chin * double(n)));
  std::nth_element(order.begin(), order.begin() + std::ptrdiff_t(count) - 1, order.end(),
                   [&](Index a, Index b) { return lowest[a] < lowest[b]; });
  std::vector<double> opening;
  for (const Mat3X& x : frames) {
    double sum = 0;
    for (std::size_t k = 0; k < count; ++k) sum += frames.front()(1, order[k]) - x(1, order[k]);
    opening.push_back(sum / double(count));
  }
  const double half = *std::max_element(opening.begin(), opening.end()) / 2;
  if (2 * half < far) return {};
  const auto crossing = [&](std::size_t k) {  // between frames k and k + 1
    return (double(k) + (half - opening[k]) / (opening[k + 1] - opening[k])) / double(opening.size() - 1);
  };
  Landmarks out;
  for (std::size_t k = 0; k + 1 < opening.size(); ++k) {
    if (!out[0] && opening[k] < half && opening[k + 1] >= half) out[0] = crossing(k);
    if (opening[k] >= half && opening[k + 1] < half) out[1] = crossing(k);
  }
  return opening.back() < half ? out : Landmarks{};
}

}  // namespace

Landmarks landmarks(const Body& body) {
  const Landmarks strikes = foot_strikes(body);
  return strikes[0] || strikes[1] ? strikes : jaw_openings(body);
}

}  // namespace dsns::program
