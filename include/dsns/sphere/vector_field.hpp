#pragma once
/// Tangent vector fields of the sphere in the span of the vector harmonics, and the flow of one for unit time along geodesics:
///   v(s) = grad(sum a_k Y_k) + s x grad(sum b_k Y_k),   div v = -sum l(l + 1) a_k Y_k,   exp(v)(s) = exp_s(v(s)).
#include <dsns/autodiff/dual.hpp>
#include <dsns/sphere/charts.hpp>
#include <dsns/sphere/harmonics.hpp>

namespace dsns {

/// What a field is to a composition, see increment.hpp.
enum class FieldStep {
  forward,  ///< exp(v)
  inverse,  ///< the map that undoes exp(v)
};

/// Coefficients over the harmonics of degree 0 to `degree` (index l^2 + l + m; the constants are without effect).
struct SphereVectorField {
  int degree = 1;
  Eigen::VectorXd a, b;  ///< gradient part and rotated-gradient part, (degree + 1)^2 each, radians
  FieldStep step = FieldStep::forward;

  static SphereVectorField zero(int degree) {
    return {degree, Eigen::VectorXd::Zero(harmonic_count(degree)), Eigen::VectorXd::Zero(harmonic_count(degree)), {}};
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
      const T dp = legendre.derivative(l, m);
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

namespace detail {

/// Coefficients of both potentials side by side.
inline HarmonicCoefficients<2> potentials(const SphereVectorField& v) {
  HarmonicCoefficients<2> both(v.a.size(), 2);
  both << v.a, v.b;
  return both;
}

}  // namespace detail

/// The tangent vectors at n charts, 3 x n.
/// accuracy 1e-13 of the largest, at degree 12, against evaluate() at a point [sphere/vector_field_test]
inline Mat3X evaluate(const SphereVectorField& v, const ChartBatch& c) {
  const FunctionTangents<2> h = harmonic_sum_tangents<2>(detail::potentials(v), c);  // s x e1 = e2, s x e2 = -e1
  return c.e1 * (h.fu.row(0) - h.fv.row(1)).asDiagonal() + c.e2 * (h.fv.row(0) + h.fu.row(1)).asDiagonal();
}

/// The field up to `degree` nearest to vectors at the nodes of a quadrature, 3 x n; their radial parts do not count.
///   a_lm = integral of v . grad Y_lm / (l(l + 1)),   b_lm = integral of v . (s x grad Y_lm) / (l(l + 1))
/// accuracy finds a SphereVectorField again to 1e-13 with sphere_quadrature(degree + 2) [sphere/vector_field_test]
inline SphereVectorField project_on_vector_harmonics(const Mat3X& vectors, const SphereQuadrature& q, int degree) {
  require(vectors.cols() == q.size(), "project_on_vector_harmonics: ", vectors.cols(), " vectors at ", q.size(),
          " nodes");
  SphereVectorField v = SphereVectorField::zero(degree);
  constexpr Index tile = 64;
  HarmonicTangents h;
  for (Index first = 0; first < q.size(); first += tile) {
    const Index n = std::min(tile, q.size() - first);
    const ChartBatch c = charts_at(q.points.middleCols(first, n));
    h = harmonic_tangents(c, degree, std::move(h));
    const auto along = [&](const Mat3X& e) -> Eigen::VectorXd {
      return e.cwiseProduct(vectors.middleCols(first, n))
          .colwise()
          .sum()
          .transpose()
          .cwiseProduct(q.weights.segment(first, n));
    };
    const Eigen::VectorXd v1 = along(c.e1), v2 = along(c.e2);
    v.a += h.yu.transpose() * v1 + h.yv.transpose() * v2;
    v.b += h.yu.transpose() * v2 - h.yv.transpose() * v1;
  }
  const Eigen::ArrayXd l = harmonic_degrees(degree), square = (l * (l + 1)).max(1);  // of the constants both sums are 0
  v.a.array() /= square;
  v.b.array() /= square;
  return v;
}

/// n points carried by exp(v), with the images of the frame vectors and the area factor.
struct SphereDisplacement {
  Mat3X y;                  ///< unit, 3 x n
  Mat3X y1, y2;             ///< differential of the map on e1 and e2, 3 x n
  Eigen::VectorXd J;        ///< y . (y1 x y2): ratio of areas, n
  double longest_step = 0;  ///< radians
};

/// The displacement of the charts' points by exp(v).
/// accuracy 1e-12 against Jet2 through exponential() [sphere/vector_field_test]
inline SphereDisplacement displace(const SphereVectorField& v, const ChartBatch& c) {
  const Index n = c.size();
  const FunctionJets<2> h = harmonic_sum_jets<2>(detail::potentials(v), c);
  SphereDisplacement out{Mat3X(3, n), Mat3X(3, n), Mat3X(3, n), Eigen::VectorXd(n)};
  for (Index i = 0; i < n; ++i) {
    Mat3 frame;  // all below in its coordinates: vectors along e1, e2 and s
    frame << c.e1.col(i), c.e2.col(i), c.s.col(i);
    const Vec3d tangent(h.fu(0, i) - h.fv(1, i), h.fv(0, i) + h.fu(1, i), 0);
    // v's derivatives along e1 and e2: covariant parts from the potentials' Hessians, and -v . e_k along s
    const Vec3d dv1(h.fuu(0, i) - h.fuv(1, i), h.fuv(0, i) + h.fuu(1, i), -tangent[0]);
    const Vec3d dv2(h.fuv(0, i) - h.fvv(1, i), h.fvv(0, i) + h.fuv(1, i), -tangent[1]);
    const double x = tangent.squaredNorm();
    Dual<double, 1> seed(x);
    seed.g = {1.0};
    const auto at = detail::cos_sinc(seed);
    const auto image = [&, s = Vec3d::UnitZ()](const Vec3d& e, const Vec3d& dv) -> Vec3d {
      const double dx = 2 * tangent.dot(dv);
      return frame * (at.c.f * e + at.c.g[0] * dx * s + at.s.f * dv + at.s.g[0] * dx * tangent);
    };
    const Vec3d y1 = image(Vec3d::UnitX(), dv1), y2 = image(Vec3d::UnitY(), dv2);
    const Vec3d y = (frame * Vec3d(at.s.f * tangent[0], at.s.f * tangent[1], at.c.f)).normalized();
    out.y.col(i) = y;
    out.y1.col(i) = y1;
    out.y2.col(i) = y2;
    out.J[i] = y.dot(y1.cross(y2));
    out.longest_step = std::max(out.longest_step, std::sqrt(x));
  }
  return out;
}

}  // namespace dsns
