#pragma once
/// Surfaces whose coordinates are band-limited: f(s) = sum_k c_k Y_k(s).
#include <dsns/sphere/harmonics.hpp>
#include <dsns/sphere/quadrature.hpp>
#include <dsns/surface/jets.hpp>

namespace dsns {

/// coefficients (degree + 1)^2 x 3.
class HarmonicSurface {
 public:
  explicit HarmonicSurface(Eigen::MatrixX3d coefficients) : coefficients_(std::move(coefficients)) {
    degree_ = static_cast<int>(std::lround(std::sqrt(double(coefficients_.rows())))) - 1;
    require(harmonic_count(degree_) == coefficients_.rows(), "HarmonicSurface: ", coefficients_.rows(),
            " coefficients a coordinate, give the square of a whole number");
  }

  int degree() const { return degree_; }
  const Eigen::MatrixX3d& coefficients() const { return coefficients_; }

  template <class T>
  Vec3<T> operator()(const Vec3<T>& s) const {
    const auto y = harmonics<T>(s, degree_);
    Vec3<T> sum(T(0.0), T(0.0), T(0.0));
    for (Index k = 0; k < y.size(); ++k)
      for (int c = 0; c < 3; ++c) sum[c] += coefficients_(k, c) * y[k];
    return sum;
  }
  Mat3X positions(const Mat3X& s) const { return (harmonics(s, degree_) * coefficients_).transpose(); }
  SurfaceJets jets(const ChartBatch& c) const { return jets(c, harmonic_jets(c.s, degree_)); }

  /// The same from harmonics already evaluated at the charts' points, of any degree at least this one's.
  SurfaceJets jets(const ChartBatch& c, const HarmonicJets& h) const {
    const auto times = [&](const Eigen::MatrixXd& m) {
      return Mat3X((m.leftCols(coefficients_.rows()) * coefficients_).transpose());
    };
    const Mat3X x = times(h.dx), y = times(h.dy), z = times(h.dz), xx = times(h.dxx), yy = times(h.dyy),
                zz = times(h.dzz), xy = times(h.dxy), xz = times(h.dxz), yz = times(h.dyz);
    SurfaceJets out(c.size());
    out.f = times(h.y);
    for (Index i = 0; i < c.size(); ++i) {
      const Vec3d s = c.s.col(i), a = c.e1.col(i), b = c.e2.col(i);
      const auto along = [&](const Vec3d& p) -> Vec3d { return x.col(i) * p[0] + y.col(i) * p[1] + z.col(i) * p[2]; };
      const auto twice = [&](const Vec3d& p, const Vec3d& q) -> Vec3d {
        return xx.col(i) * (p[0] * q[0]) + yy.col(i) * (p[1] * q[1]) + zz.col(i) * (p[2] * q[2]) +
               xy.col(i) * (p[0] * q[1] + p[1] * q[0]) + xz.col(i) * (p[0] * q[2] + p[2] * q[0]) +
               yz.col(i) * (p[1] * q[2] + p[2] * q[1]);
      };
      const Vec3d radial = along(s);  // s_uu = s_vv = -s
      out.fu.col(i) = along(a);
      out.fv.col(i) = along(b);
      out.fuu.col(i) = twice(a, a) - radial;
      out.fuv.col(i) = twice(a, b);
      out.fvv.col(i) = twice(b, b) - radial;
    }
    return out;
  }

  /// The surface cut to a lower degree and smoothed by the heat kernel: c_k exp(-time l(l + 1)).
  HarmonicSurface smoothed(int degree, double time) const {
    const Index count = harmonic_count(std::min(degree, degree_));
    const Eigen::ArrayXd l = harmonic_degrees(std::min(degree, degree_));
    Eigen::MatrixX3d c = coefficients_.topRows(count);
    c.array().colwise() *= (-time * l * (l + 1)).exp();
    return HarmonicSurface(std::move(c));
  }

 private:
  Eigen::MatrixX3d coefficients_;
  int degree_;
};

/// Projection of positions at the nodes of a quadrature, 3 x n, on the harmonics up to `degree`.
inline HarmonicSurface project_on_harmonics(const Mat3X& values, const SphereQuadrature& q, int degree) {
  const Eigen::MatrixXd y = harmonics(q.points, degree);
  return HarmonicSurface(y.transpose() * q.weights.asDiagonal() * values.transpose());
}

/// Nodes for projections up to `degree`: exact for surfaces that are band-limited to 3 degree + 15.
inline SphereQuadrature projection_nodes(int degree) { return sphere_quadrature(2 * degree + 8); }

/// Projection of any surface on the harmonics up to `degree` by quadrature.
template <Surface S>
HarmonicSurface project_on_harmonics(const S& surface, int degree) {
  const SphereQuadrature q = projection_nodes(degree);
  return project_on_harmonics(positions(surface, q.points), q, degree);
}

static_assert(Surface<HarmonicSurface>);

}  // namespace dsns
