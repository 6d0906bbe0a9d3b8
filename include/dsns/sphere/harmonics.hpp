#pragma once
/// Real orthonormal spherical harmonics as polynomials in (x, y, z): no pole is special.
///   Y_lm = P_l|m|(z) Re (x + iy)^m  for m >= 0,   P_l|m|(z) Im (x + iy)^|m|  for m < 0,   index l^2 + l + m,
/// where P carries the normalisation and the factor sqrt(2) of m != 0. The polynomials extend Y off the sphere (not
/// homogeneously); gradients and Hessians are those of this extension, and their tangential parts do not depend on it.
#include <dsns/core/errors.hpp>
#include <dsns/core/types.hpp>

#include <cmath>
#include <vector>

namespace dsns {

/// Number of harmonics of degree 0 to `degree`.
constexpr Index harmonic_count(int degree) { return Index(degree + 1) * (degree + 1); }

/// Degree l of each index, length (degree + 1)^2.
inline Eigen::ArrayXd harmonic_degrees(int degree) {
  Eigen::ArrayXd l(harmonic_count(degree));
  for (int d = 0; d <= degree; ++d) l.segment(Index(d) * d, 2 * d + 1).setConstant(d);
  return l;
}

namespace detail {

/// Legendre factors P_lm(z) of degree up to L, m <= l, at one point; T any scalar.
template <class T>
struct LegendreFactors {
  int degree;
  std::vector<T> table;

  const T& at(int l, int m) const { return table[std::size_t(l * (l + 1) / 2 + m)]; }
  T& at(int l, int m) { return table[std::size_t(l * (l + 1) / 2 + m)]; }

  explicit LegendreFactors(int degree_) : degree(degree_), table(std::size_t((degree_ + 1) * (degree_ + 2) / 2)) {}

  void evaluate(const T& z) {
    double diagonal = std::sqrt(1 / (4 * pi));
    for (int m = 0; m <= degree; ++m) {
      if (m > 0) diagonal *= std::sqrt((2.0 * m + 1) / (2.0 * m));
      at(m, m) = T(m > 0 ? std::sqrt(2.0) * diagonal : diagonal);
      if (m < degree) at(m + 1, m) = std::sqrt(2.0 * m + 3) * z * at(m, m);
      for (int l = m + 2; l <= degree; ++l) {
        const double a = std::sqrt((4.0 * l * l - 1) / (1.0 * l * l - m * m));
        const double b = std::sqrt((1.0 * (l - 1) * (l - 1) - m * m) / (4.0 * (l - 1) * (l - 1) - 1));
        at(l, m) = a * (z * at(l - 1, m) - b * at(l - 2, m));
      }
    }
  }
};

/// Re and Im of (x + iy)^m for m up to the degree.
template <class T>
struct PlanePowers {
  std::vector<T> re, im;
  explicit PlanePowers(int degree) : re(std::size_t(degree + 1)), im(std::size_t(degree + 1)) {}
  void evaluate(const T& x, const T& y) {
    re[0] = T(1);
    im[0] = T(0);
    for (std::size_t m = 1; m < re.size(); ++m) {
      re[m] = x * re[m - 1] - y * im[m - 1];
      im[m] = x * im[m - 1] + y * re[m - 1];
    }
  }
};

}  // namespace detail

/// All harmonics up to `degree` at one unit point; T any scalar, so derivatives may ride along.
template <class T>
Eigen::Matrix<T, Eigen::Dynamic, 1> harmonics(const Vec3<T>& s, int degree) {
  detail::LegendreFactors<T> legendre(degree);
  detail::PlanePowers<T> powers(degree);
  legendre.evaluate(s.z());
  powers.evaluate(s.x(), s.y());
  Eigen::Matrix<T, Eigen::Dynamic, 1> y(harmonic_count(degree));
  for (int l = 0; l <= degree; ++l) {
    const Index middle = Index(l) * l + l;
    y[middle] = legendre.at(l, 0);
    for (int m = 1; m <= l; ++m) {
      y[middle + m] = legendre.at(l, m) * powers.re[std::size_t(m)];
      y[middle - m] = legendre.at(l, m) * powers.im[std::size_t(m)];
    }
  }
  return y;
}

/// Values at the n columns of s: n x (degree + 1)^2.
/// accuracy orthonormal to 1e-13 [sphere/harmonics_test]
inline Eigen::MatrixXd harmonics(const Mat3X& s, int degree) {
  Eigen::MatrixXd y(s.cols(), harmonic_count(degree));
  for (Index i = 0; i < s.cols(); ++i) y.row(i) = harmonics<double>(Vec3d(s.col(i)), degree).transpose();
  return y;
}

/// Values, gradients and Hessians in R^3 of the polynomials above; each matrix n x (degree + 1)^2.
struct HarmonicJets {
  Eigen::MatrixXd y, dx, dy, dz, dxx, dyy, dzz, dxy, dxz, dyz;

  HarmonicJets(Index points, Index count)
      : y(points, count),
        dx(points, count),
        dy(points, count),
        dz(points, count),
        dxx(points, count),
        dyy(points, count),
        dzz(points, count),
        dxy(points, count),
        dxz(points, count),
        dyz(points, count) {}
};

namespace detail {

/// Column `k` of the jets at point i from the z-factor p, p', p'' and the plane factor c = Re or Im (x + iy)^m with its
/// derivatives (Re' = m Re_(m-1) in x and -m Im_(m-1) in y, and so on).
struct HarmonicFactors {
  double p, dp, ddp, c, cx, cy, cxx, cxy;
};

inline void store(HarmonicJets& out, Index i, Index k, const HarmonicFactors& h) {
  out.y(i, k) = h.p * h.c;
  out.dx(i, k) = h.p * h.cx;
  out.dy(i, k) = h.p * h.cy;
  out.dz(i, k) = h.dp * h.c;
  out.dxx(i, k) = h.p * h.cxx;
  out.dyy(i, k) = -h.p * h.cxx;  // (x + iy)^m is harmonic in the plane
  out.dzz(i, k) = h.ddp * h.c;
  out.dxy(i, k) = h.p * h.cxy;
  out.dxz(i, k) = h.dp * h.cx;
  out.dyz(i, k) = h.dp * h.cy;
}

}  // namespace detail

/// Values with first and second derivatives at the n columns of s.
/// accuracy 1e-8 against central differences, 1e-12 against Jet2 [sphere/harmonics_test]
inline HarmonicJets harmonic_jets(const Mat3X& s, int degree) {
  HarmonicJets out(s.cols(), harmonic_count(degree));
  detail::LegendreFactors<double> legendre(degree);
  detail::PlanePowers<double> powers(degree);
  for (Index i = 0; i < s.cols(); ++i) {
    legendre.evaluate(s(2, i));
    powers.evaluate(s(0, i), s(1, i));
    const auto re = [&](int m) { return m < 0 ? 0.0 : powers.re[std::size_t(m)]; };
    const auto im = [&](int m) { return m < 0 ? 0.0 : powers.im[std::size_t(m)]; };
    for (int l = 0; l <= degree; ++l) {
      const Index middle = Index(l) * l + l;
      for (int m = 0; m <= l; ++m) {
        // d/dz P_lm = sqrt((l - m)(l + m + 1)) P_l,m+1, with 1/sqrt(2) undone where the factor sqrt(2) first appears
        const double first = std::sqrt(double(l - m) * (l + m + 1));
        const double second = std::sqrt(std::max(0.0, double(l - m - 1) * (l + m + 2)));
        const double undo = m == 0 ? std::sqrt(0.5) : 1;
        const double p = legendre.at(l, m);
        const double dp = m < l ? undo * first * legendre.at(l, m + 1) : 0;
        const double ddp = m + 1 < l ? undo * first * second * legendre.at(l, m + 2) : 0;
        const double n = m, n2 = double(m) * (m - 1);
        detail::store(out, i, middle + m,
                      {p, dp, ddp, re(m), n * re(m - 1), -n * im(m - 1), n2 * re(m - 2), -n2 * im(m - 2)});
        if (m > 0)
          detail::store(out, i, middle - m,
                        {p, dp, ddp, im(m), n * im(m - 1), n * re(m - 1), n2 * im(m - 2), n2 * re(m - 2)});
      }
    }
  }
  return out;
}

}  // namespace dsns
