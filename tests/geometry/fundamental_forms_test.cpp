#include "catch.hpp"
#include "support/smooth_surfaces.hpp"
#include "support/sphere_points.hpp"

#include <dsns/geometry/curvature.hpp>

namespace fundamental_forms_test {

using namespace dsns;

namespace {

/// One fixed chart around point i in two outer variables u, v, with two inner ones for f_u, f_v: the metric as a 2-jet.
struct MetricJet {
  Jet2<double> E, F, G;
};

template <class S>
MetricJet metric_jet(const S& surface, const ChartBatch& c, Index i) {
  using Outer = Jet2<double>;
  using T = Dual<Outer, 2>;
  const T u = T::variable(Outer::variable(0.0, 0), 0), v = T::variable(Outer::variable(0.0, 1), 1);
  const auto exponential = detail::cos_sinc<T>(u * u + v * v);
  Vec3<T> s;
  for (int k = 0; k < 3; ++k) s[k] = exponential.c * c.s(k, i) + exponential.s * (u * c.e1(k, i) + v * c.e2(k, i));
  const Vec3<T> p = surface(s);
  MetricJet m{Outer(0.0), Outer(0.0), Outer(0.0)};
  for (int k = 0; k < 3; ++k) {
    m.E += p[k].g[0] * p[k].g[0];
    m.F += p[k].g[0] * p[k].g[1];
    m.G += p[k].g[1] * p[k].g[1];
  }
  return m;
}

/// Gaussian curvature from the metric alone (Brioschi's formula).
double brioschi(const MetricJet& m) {
  const double E = m.E.f, F = m.F.f, G = m.G.f, Eu = m.E.g[0], Ev = m.E.g[1], Fu = m.F.g[0], Fv = m.F.g[1],
               Gu = m.G.g[0], Gv = m.G.g[1];
  Mat3 a, b;
  a << -m.E.h[2] / 2 + m.F.h[1] - m.G.h[0] / 2, Eu / 2, Fu - Ev / 2, Fv - Gu / 2, E, F, Gv / 2, F, G;
  b << 0, Ev / 2, Gu / 2, Ev / 2, E, F, Gu / 2, F, G;
  return (a.determinant() - b.determinant()) / std::pow(E * G - F * F, 2);
}

}  // namespace

TEST_CASE("Theorema egregium: the metric alone gives the curvature of the shape operator", "[law]") {
  const ChartBatch c = charts_at(test::sphere_points(20));
  test::visit_formulas([&](const std::string& name, const test::AnySurface& surface) {
    INFO(name);
    const Eigen::VectorXd K = curvature(jets(surface, c)).gaussian;
    for (Index i = 0; i < c.size(); ++i)
      CHECK(brioschi(metric_jet(surface, c, i)) == Approx(K[i]).epsilon(1e-10).margin(1e-10));
  });
}

TEST_CASE("the metric, its derivatives and Christoffel symbols are those of one fixed chart", "[law]") {
  const ChartBatch c = charts_at(test::sphere_points(20));
  test::visit_formulas([&](const std::string& name, const test::AnySurface& surface) {
    INFO(name);
    const SurfaceJets j = jets(surface, c);
    const FirstFundamentalForm I = first_fundamental_form(j);
    const MetricDerivatives d = metric_derivatives(j);
    const ChristoffelSymbols gamma = christoffel_symbols(j);
    const auto near = [](double x) { return Approx(x).epsilon(1e-11).margin(1e-11); };
    for (Index i = 0; i < c.size(); ++i) {
      const MetricJet m = metric_jet(surface, c, i);
      CHECK(I.E[i] == near(m.E.f));
      CHECK(I.F[i] == near(m.F.f));
      CHECK(I.G[i] == near(m.G.f));
      CHECK(d.Eu[i] == near(m.E.g[0]));
      CHECK(d.Ev[i] == near(m.E.g[1]));
      CHECK(d.Fu[i] == near(m.F.g[0]));
      CHECK(d.Fv[i] == near(m.F.g[1]));
      CHECK(d.Gu[i] == near(m.G.g[0]));
      CHECK(d.Gv[i] == near(m.G.g[1]));
      // Gamma from the metric: do Carmo 1976, section 4-3, (2)
      Eigen::Matrix2d metric;
      metric << m.E.f, m.F.f, m.F.f, m.G.f;
      Eigen::Matrix<double, 2, 3> first, symbols;
      first << m.E.g[0] / 2, m.E.g[1] / 2, m.F.g[1] - m.G.g[0] / 2, m.F.g[0] - m.E.g[1] / 2, m.G.g[0] / 2, m.G.g[1] / 2;
      symbols << gamma.u_uu[i], gamma.u_uv[i], gamma.u_vv[i], gamma.v_uu[i], gamma.v_uv[i], gamma.v_vv[i];
      CHECK((metric * symbols - first).cwiseAbs().maxCoeff() < 1e-11 * (1 + first.cwiseAbs().maxCoeff()));
    }
  });
}

TEST_CASE("the second derivatives fall apart into Christoffel symbols and the second form", "[law]") {
  const ChartBatch c = charts_at(test::sphere_points(20));
  test::visit_smooth_surfaces([&](const std::string& name, const test::AnySurface& surface) {
    INFO(name);
    const SurfaceJets j = jets(surface, c);
    const ChristoffelSymbols g = christoffel_symbols(j);
    const SecondFundamentalForm b = second_fundamental_form(j);
    const Mat3X n = unit_normals(j);
    const auto sum = [&](const Eigen::VectorXd& u, const Eigen::VectorXd& v, const Eigen::VectorXd& normal) {
      return Mat3X(j.fu * u.asDiagonal() + j.fv * v.asDiagonal() + n * normal.asDiagonal());
    };
    CHECK(test::difference(sum(g.u_uu, g.v_uu, b.L), j.fuu) < 1e-12);
    CHECK(test::difference(sum(g.u_uv, g.v_uv, b.M), j.fuv) < 1e-12);
    CHECK(test::difference(sum(g.u_vv, g.v_vv, b.N), j.fvv) < 1e-12);
  });
}

TEST_CASE("normals point outward, densities are those of the metric, and a crushed surface is refused", "[geometry]") {
  const ChartBatch c = charts_at(test::sphere_points());
  const SurfaceTangents j = tangents(Ellipsoid{2, 3, 4}, c);
  CHECK((unit_normals(j).array() * c.s.array()).colwise().sum().minCoeff() > 0);
  CHECK(unit_normals(j) == unit_normals(jets(Ellipsoid{2, 3, 4}, c)));
  const FirstFundamentalForm I = first_fundamental_form(j);
  const Eigen::VectorXd determinant = I.E.cwiseProduct(I.G) - I.F.cwiseAbs2();
  CHECK((area_densities(j).cwiseAbs2() - determinant).cwiseAbs().maxCoeff() < 1e-12 * determinant.maxCoeff());
  const SurfaceJets crushed = jets(Ellipsoid{0, 0, 1}, c);
  CHECK_THROWS_AS(unit_normals(crushed), DegenerateSurface);
  CHECK_THROWS_AS(dual_basis(crushed), DegenerateSurface);
  CHECK_THROWS_AS(christoffel_symbols(crushed), DegenerateSurface);
  CHECK_THROWS_AS(tangent_tensor(crushed, I.E, I.F, I.G), DegenerateSurface);
}

}  // namespace fundamental_forms_test
