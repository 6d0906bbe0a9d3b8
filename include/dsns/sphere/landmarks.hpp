#pragma once
/// Points whose places on another sphere are known: what a user clicked, or vertices with known partners.
#include <dsns/sphere/sphere_map.hpp>

namespace dsns {

struct SphereLandmarks {
  Mat3X points{3, 0}, targets{3, 0};  ///< unit, 3 x n
  /// n, not negative. 1 is as much as all else together: missing by one radian costs as much as all targets of vertices that are
  /// missed by one radian, or as the whole squared norm of the fields that a registration compares.
  Eigen::VectorXd weights{};

  Index size() const { return points.cols(); }
};

/// throws   InvalidArgument naming `who`, where sizes differ, weights are negative or columns no unit vectors
inline void require_landmarks(const SphereLandmarks& landmarks, const char* who) {
  const Index n = landmarks.size();
  require(landmarks.targets.cols() == n && landmarks.weights.size() == n, who, ": ", n, " landmarks with ",
          landmarks.targets.cols(), " targets and ", landmarks.weights.size(), " weights, give as many of each");
  require(landmarks.weights.allFinite() && !(landmarks.weights.array() < 0).any(), who,
          ": a landmark's weight is negative or not finite, give weights from 0");
  for (const Mat3X* columns : {&landmarks.points, &landmarks.targets})
    for (Index i = 0; i < n; ++i)
      require(std::abs(columns->col(i).norm() - 1) < 1e-6, who, ": column ", i,
              " of the landmarks is no unit vector, its length is ", columns->col(i).norm());
}

/// The same with both spheres changed over.
inline SphereLandmarks changed_over(const SphereLandmarks& landmarks) {
  return {landmarks.targets, landmarks.points, landmarks.weights};
}

}  // namespace dsns
