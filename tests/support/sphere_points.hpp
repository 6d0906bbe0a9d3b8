#pragma once
#include <dsns/sphere/quadrature.hpp>

namespace dsns::test {

/// Poles, points near them, axes, and points in general position.
inline Mat3X sphere_points(int general = 40) {
  Mat3X s(3, 8 + general);
  s.col(0) << 0, 0, 1;
  s.col(1) << 0, 0, -1;
  s.col(2) << 1e-9, 0, 1;
  s.col(3) << 1e-5, -1e-5, -1;
  s.col(4) << 1, 0, 0;
  s.col(5) << 0, -1, 0;
  s.col(6) << 0.5, 0.5, 0.9;
  s.col(7) << -1, 1e-7, 0;
  s.rightCols(general) = fibonacci_sphere(general).points;
  return s.colwise().normalized();
}

}  // namespace dsns::test
