#pragma once
/// Quadrature on the sphere: Gauss-Legendre in z times equidistant longitudes.
#include <dsns/core/errors.hpp>
#include <dsns/core/types.hpp>

#include <cmath>

namespace dsns {

/// Nodes (unit, 3 x n) and weights (n, sum 4 pi).
struct SphereQuadrature {
  Mat3X points;
  Eigen::VectorXd weights;
  Index size() const { return points.cols(); }
};

/// Nodes and weights of the n-point Gauss-Legendre rule on [-1, 1], exact for polynomials of degree 2n - 1.
struct GaussLegendre {
  Eigen::VectorXd nodes, weights;
};

/// Newton's method on the Legendre polynomial from Tricomi's asymptotic roots.
/// accuracy 1e-15 a node [sphere/quadrature_test]
inline GaussLegendre gauss_legendre(int n) {
  require(n >= 1, "gauss_legendre: ", n, " nodes, give at least 1");
  GaussLegendre rule{Eigen::VectorXd(n), Eigen::VectorXd(n)};
  for (int i = 0; i < n; ++i) {
    double x = -std::cos(pi * (i + 0.75) / (n + 0.5)), derivative = 1, step = 1;
    for (int iteration = 0; iteration < 20 && std::abs(step) > 1e-15; ++iteration) {
      double previous = 1, value = x;
      for (int k = 2; k <= n; ++k) {
        const double next = ((2 * k - 1) * x * value - (k - 1) * previous) / k;
        previous = value;
        value = next;
      }
      derivative = n * (x * value - previous) / (x * x - 1);
      step = value / derivative;
      x -= step;
    }
    rule.nodes[i] = x;
    rule.weights[i] = 2 / ((1 - x * x) * derivative * derivative);
  }
  return rule;
}

/// n x 2n nodes, exact for polynomials in (x, y, z) of degree 2n - 1, products of harmonics of degrees that add up to it among
/// them, and not for all of degree 2n.
/// accuracy 1e-13 [sphere/quadrature_test]
inline SphereQuadrature sphere_quadrature(int n) {
  const GaussLegendre rule = gauss_legendre(n);
  const int sectors = 2 * n;
  SphereQuadrature q{Mat3X(3, n * sectors), Eigen::VectorXd(n * sectors)};
  for (int i = 0, k = 0; i < n; ++i) {
    const double z = rule.nodes[i], r = std::sqrt(1 - z * z);
    for (int j = 0; j < sectors; ++j, ++k) {
      const double longitude = 2 * pi * (j + 0.5) / sectors;
      q.points.col(k) = Vec3d(r * std::cos(longitude), r * std::sin(longitude), z).normalized();
      q.weights[k] = rule.weights[i] * 2 * pi / sectors;
    }
  }
  return q;
}

/// n nearly equidistant points on a spiral, equal weights: for searches, not for integrals.
inline SphereQuadrature fibonacci_sphere(int n) {
  require(n >= 1, "fibonacci_sphere: ", n, " points, give at least 1");
  SphereQuadrature q{Mat3X(3, n), Eigen::VectorXd::Constant(n, 4 * pi / n)};
  for (int i = 0; i < n; ++i) {
    const double z = 1 - (2 * i + 1.0) / n, r = std::sqrt(1 - z * z), longitude = i * pi * (3 - std::sqrt(5.0));
    q.points.col(i) = Vec3d(r * std::cos(longitude), r * std::sin(longitude), z).normalized();
  }
  return q;
}

}  // namespace dsns
