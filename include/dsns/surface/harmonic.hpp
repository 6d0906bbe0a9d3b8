#pragma once
/// Surfaces whose coordinates are band-limited: f(s) = sum_k c_k Y_k(s).
#include <dsns/sphere/harmonics.hpp>
#include <dsns/sphere/quadrature.hpp>
#include <dsns/surface/jets.hpp>

namespace dsns {

/// coefficients (degree + 1)^2 x 3.
class HarmonicSurface {
 public:
  explicit HarmonicSurface(Eigen::MatrixX3d coefficients)
      : coefficients_(std::move(coefficients)), degree_(harmonic_degree(coefficients_.rows())) {}

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
  Mat3X positions(const Mat3X& s) const { return harmonic_sum<3>(coefficients_, s); }
  SurfaceTangents tangents(const ChartBatch& c) const {
    auto [f, fu, fv] = harmonic_sum_tangents<3>(coefficients_, c);
    SurfaceTangents out(0);
    out.f = std::move(f);
    out.fu = std::move(fu);
    out.fv = std::move(fv);
    return out;
  }
  SurfaceJets jets(const ChartBatch& c) const {
    auto [f, fu, fv, fuu, fuv, fvv] = harmonic_sum_jets<3>(coefficients_, c);
    SurfaceJets out(0);
    out.f = std::move(f);
    out.fu = std::move(fu);
    out.fv = std::move(fv);
    out.fuu = std::move(fuu);
    out.fuv = std::move(fuv);
    out.fvv = std::move(fvv);
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
  return HarmonicSurface(harmonic_coefficients<3>(values, q, degree));
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
