#pragma once
/// Harmonics with first and second derivatives in R^3 as one writes them down: a point at a time, coefficients where they
/// are needed. What the benchmarks measure sphere/harmonics.hpp against.
#include <dsns/core/types.hpp>

#include <cmath>
#include <vector>

namespace reference {

struct HarmonicJets {
  Eigen::MatrixXd y, dx, dy, dz, dxx, dyy, dzz, dxy, dxz, dyz;  ///< n x (degree + 1)^2 each
};

inline HarmonicJets harmonic_jets(const dsns::Mat3X& s, int degree) {
  const Eigen::MatrixXd empty(s.cols(), (degree + 1) * (degree + 1));
  HarmonicJets out{empty, empty, empty, empty, empty, empty, empty, empty, empty, empty};
  const auto size = std::size_t(degree + 1);
  std::vector<double> re(size), im(size), table(size * size);
  const auto legendre = [&](int l, int m) -> double& { return table[std::size_t(l) * size + std::size_t(m)]; };
  for (Eigen::Index i = 0; i < s.cols(); ++i) {
    const double x = s(0, i), y = s(1, i), z = s(2, i);
    re[0] = 1;
    im[0] = 0;
    for (std::size_t m = 1; m < size; ++m) {
      re[m] = x * re[m - 1] - y * im[m - 1];
      im[m] = x * im[m - 1] + y * re[m - 1];
    }
    double diagonal = std::sqrt(1 / (4 * dsns::pi));
    for (int m = 0; m <= degree; ++m) {
      if (m > 0) diagonal *= std::sqrt((2.0 * m + 1) / (2.0 * m));
      legendre(m, m) = m > 0 ? std::sqrt(2.0) * diagonal : diagonal;
      if (m < degree) legendre(m + 1, m) = std::sqrt(2.0 * m + 3) * z * legendre(m, m);
      for (int l = m + 2; l <= degree; ++l) {
        const double a = std::sqrt((4.0 * l * l - 1) / (1.0 * l * l - m * m));
        const double b = std::sqrt((1.0 * (l - 1) * (l - 1) - m * m) / (4.0 * (l - 1) * (l - 1) - 1));
        legendre(l, m) = a * (z * legendre(l - 1, m) - b * legendre(l - 2, m));
      }
    }
    for (int l = 0; l <= degree; ++l)
      for (int m = -l; m <= l; ++m) {
        const int n = std::abs(m), k = l * l + l + m;
        const double undo = n == 0 ? std::sqrt(0.5) : 1, first = undo * std::sqrt(double(l - n) * (l + n + 1));
        const double p = legendre(l, n), dp = n < l ? first * legendre(l, n + 1) : 0;
        const double ddp = n + 1 < l ? first * std::sqrt(double(l - n - 1) * (l + n + 2)) * legendre(l, n + 2) : 0;
        // Re' = n Re_(n-1) in x and -n Im_(n-1) in y; Im' = n Im_(n-1) in x and n Re_(n-1) in y
        const auto& c = m >= 0 ? re : im;
        const auto& d = m >= 0 ? im : re;
        const double sign = m >= 0 ? -1 : 1, n2 = double(n) * (n - 1);
        const auto at = [](const std::vector<double>& v, int j) { return j < 0 ? 0.0 : v[std::size_t(j)]; };
        const double cx = n * at(c, n - 1), cy = sign * n * at(d, n - 1);
        const double cxx = n2 * at(c, n - 2), cxy = sign * n2 * at(d, n - 2), f = c[std::size_t(n)];
        out.y(i, k) = p * f, out.dx(i, k) = p * cx, out.dy(i, k) = p * cy, out.dz(i, k) = dp * f;
        out.dxx(i, k) = p * cxx, out.dyy(i, k) = -p * cxx, out.dzz(i, k) = ddp * f;
        out.dxy(i, k) = p * cxy, out.dxz(i, k) = dp * cx, out.dyz(i, k) = dp * cy;
      }
  }
  return out;
}

}  // namespace reference
