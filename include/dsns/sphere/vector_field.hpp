#pragma once
/// Tangent vector fields of the sphere in the span of the vector harmonics, and the flow of one for unit time along geodesics:
///   v(s) = grad(sum a_k Y_k) + s x grad(sum b_k Y_k),   div v = -sum l(l + 1) a_k Y_k,   exp(v)(s) = exp_s(v(s)).
#include <dsns/autodiff/dual.hpp>
#include <dsns/sphere/charts.hpp>
#include <dsns/sphere/harmonics.hpp>

namespace dsns {

/// Coefficients over the harmonics of degree 0 to `degree` (index l^2 + l + m; the constants are without effect).
struct SphereVectorField {
  int degree = 1;
  Eigen::VectorXd a, b;  ///< gradient part and rotated-gradient part, (degree + 1)^2 each, radians

  static SphereVectorField zero(int degree) {
    return {degree, Eigen::VectorXd::Zero(harmonic_count(degree)), Eigen::VectorXd::Zero(harmonic_count(degree))};
  }
};

namespace detail {

/// cos(theta) and sin(theta)/theta with their derivatives, all as functions of x = theta^2, smooth at 0.
template <class T>
struct CosSinc {
  T c, s;
};

/// Taylor series for x <= 1 (next term below 1e-18 at double precision, its derivatives below 1e-14), closed form beyond.
template <class T>
CosSinc<T> cos_sinc(const T& x) {
  using std::cos, std::sin, std::sqrt;
  if (x > T(1.0)) {
    const T theta = sqrt(x);
    return {cos(theta), sin(theta) / theta};
  }
  T c(1.0), s(1.0);  // Horner from the last term: 1 - x/(k(k-1)) (1 - ...)
  for (int k = 22; k >= 2; k -= 2) {
    c = 1.0 - x * c / (double(k) * (k - 1));
    s = 1.0 - x * s / (double(k) * (k + 1));
  }
  return {c, s};
}

/// Gradients in R^3 of sum a_k Y_k and sum b_k Y_k at one point.
template <class T>
struct GradientPair {
  Vec3<T> a, b;
};

template <class T>
GradientPair<T> harmonic_gradients(const Vec3<T>& s, const SphereVectorField& v) {
  LegendreFactors<T> legendre(v.degree);
  PlanePowers<T> powers(v.degree);
  legendre.evaluate(s.z());
  powers.evaluate(s.x(), s.y());
  GradientPair<T> sum{Vec3<T>(T(0.0), T(0.0), T(0.0)), Vec3<T>(T(0.0), T(0.0), T(0.0))};
  const auto add = [&](Index k, const T& gx, const T& gy, const T& gz) {
    const double a = v.a[k], b = v.b[k];
    if (a != 0) sum.a += Vec3<T>(a * gx, a * gy, a * gz);
    if (b != 0) sum.b += Vec3<T>(b * gx, b * gy, b * gz);
  };
  for (int l = 1; l <= v.degree; ++l) {
    const Index middle = Index(l) * l + l;
    for (int m = 0; m <= l; ++m) {
      const T& p = legendre.at(l, m);
      const double undo = m == 0 ? std::sqrt(0.5) : 1;
      const T dp = m < l ? undo * std::sqrt(double(l - m) * (l + m + 1)) * legendre.at(l, m + 1) : T(0.0);
      const auto i = std::size_t(m);
      if (m == 0) {
        add(middle, T(0.0), T(0.0), dp);
        continue;
      }
      const double n = m;
      add(middle + m, n * p * powers.re[i - 1], -n * p * powers.im[i - 1], dp * powers.re[i]);
      add(middle - m, n * p * powers.im[i - 1], n * p * powers.re[i - 1], dp * powers.im[i]);
    }
  }
  return sum;
}

}  // namespace detail

/// The tangent vector at one point; T any scalar.
template <class T>
Vec3<T> evaluate(const SphereVectorField& v, const Vec3<T>& s) {
  const auto [ga, gb] = detail::harmonic_gradients(s, v);
  return ga - s * s.dot(ga) + s.cross(gb);
}

/// exp_s(v(s)) at one point; T any scalar.
template <class T>
Vec3<T> exponential(const SphereVectorField& v, const Vec3<T>& s) {
  const Vec3<T> tangent = evaluate(v, s);
  const auto [c, sinc] = detail::cos_sinc<T>(tangent.dot(tangent));
  return s * c + tangent * sinc;
}

/// n points carried by exp(v), with the images of the frame vectors and the area factor.
struct SphereDisplacement {
  Mat3X y;                  ///< unit, 3 x n
  Mat3X y1, y2;             ///< differential of the map on e1 and e2, 3 x n
  Eigen::VectorXd J;        ///< y . (y1 x y2): ratio of areas, n
  double longest_step = 0;  ///< radians
};

/// The displacement of the charts' points by exp(v), given the harmonics' jets there (of any degree at least v's).
/// accuracy 1e-12 against Jet2 through exponential() [sphere/vector_field_test]
inline SphereDisplacement displace(const SphereVectorField& v, const ChartBatch& c, const HarmonicJets& h) {
  const Index n = c.size(), count = v.a.size();
  const auto times = [&](const Eigen::MatrixXd& m, const Eigen::VectorXd& k) {
    return Eigen::VectorXd(m.leftCols(count) * k);
  };
  const auto gradient = [&](const Eigen::VectorXd& k) {
    Mat3X g(3, n);
    g << times(h.dx, k).transpose(), times(h.dy, k).transpose(), times(h.dz, k).transpose();
    return g;
  };
  const auto hessian = [&](const Eigen::VectorXd& k) {
    Eigen::Matrix<double, 9, Eigen::Dynamic> m(9, n);
    m.row(0) = times(h.dxx, k).transpose();
    m.row(1) = m.row(3) = times(h.dxy, k).transpose();
    m.row(2) = m.row(6) = times(h.dxz, k).transpose();
    m.row(4) = times(h.dyy, k).transpose();
    m.row(5) = m.row(7) = times(h.dyz, k).transpose();
    m.row(8) = times(h.dzz, k).transpose();
    return m;
  };
  const Mat3X ga = gradient(v.a), gb = gradient(v.b);
  const auto ha = hessian(v.a), hb = hessian(v.b);
  SphereDisplacement out{Mat3X(3, n), Mat3X(3, n), Mat3X(3, n), Eigen::VectorXd(n)};
  for (Index i = 0; i < n; ++i) {
    const Vec3d s = c.s.col(i), g = ga.col(i), r = gb.col(i);
    const Eigen::Map<const Mat3> A(ha.col(i).data()), B(hb.col(i).data());
    const double normal = s.dot(g);
    const Vec3d tangent = g - normal * s + s.cross(r);
    const double x = tangent.squaredNorm();
    Dual<double, 1> seed(x);
    seed.g = {1.0};
    const auto at = detail::cos_sinc(seed);
    const auto image = [&](const Vec3d& t) -> Vec3d {
      const Vec3d turned = A * t;
      const Vec3d dv = turned - (t.dot(g) + s.dot(turned)) * s - normal * t + t.cross(r) + s.cross(B * t);
      const double dx = 2 * tangent.dot(dv);
      return at.c.f * t + at.c.g[0] * dx * s + at.s.f * dv + at.s.g[0] * dx * tangent;
    };
    const Vec3d y1 = image(c.e1.col(i)), y2 = image(c.e2.col(i));
    const Vec3d y = (at.c.f * s + at.s.f * tangent).normalized();
    out.y.col(i) = y;
    out.y1.col(i) = y1;
    out.y2.col(i) = y2;
    out.J[i] = y.dot(y1.cross(y2));
    out.longest_step = std::max(out.longest_step, std::sqrt(x));
  }
  return out;
}

}  // namespace dsns
