#pragma once
/// Random matrices that are the same on every machine.
#include <Eigen/Core>

#include <cstdint>
#include <random>

namespace dsns::test {

/// Entries uniform in [-1, 1].
inline Eigen::MatrixXd random_matrix(Eigen::Index rows, Eigen::Index cols, std::uint32_t seed) {
  std::mt19937 random(seed);
  Eigen::MatrixXd m(rows, cols);
  for (double& x : m.reshaped()) x = 2 * double(random()) / 4294967295.0 - 1;
  return m;
}

}  // namespace dsns::test
