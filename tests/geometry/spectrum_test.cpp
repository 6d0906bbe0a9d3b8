#include "catch.hpp"
#include "support/sphere_points.hpp"

#include <dsns/geometry/integrals.hpp>
#include <dsns/geometry/spectrum.hpp>
#include <dsns/mesh/sphere_mesh.hpp>
#include <dsns/sphere/diffeomorphism.hpp>
#include <dsns/surface/analytic.hpp>

#include <Eigen/SparseCholesky>

namespace spectrum_test {

using namespace dsns;

namespace {

/// f o gamma, turned and scaled.
struct Moved {
  Ellipsoid shape;
  SphereDiffeomorphism gamma;
  Mat3 matrix = Mat3::Identity();
  template <class T>
  Vec3<T> operator()(const Vec3<T>& s) const {
    const Vec3<T> p = shape(gamma(s));
    Vec3<T> out(T(0.0), T(0.0), T(0.0));
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) out[i] += matrix(i, j) * p[j];
    return out;
  }
};

Eigen::VectorXd sphere_eigenvalues(int degree) {
  const Eigen::ArrayXd l = harmonic_degrees(degree);
  return l * (l + 1);
}

/// The lowest eigenvalues of linear finite elements on a triangle mesh: cotangents, consistent mass, subspace
/// iteration.
Eigen::VectorXd finite_element_eigenvalues(const TriangleMesh& mesh, Index count) {
  using Sparse = Eigen::SparseMatrix<double>;
  const Index n = mesh.vertices.cols(), block = count + 8;
  std::vector<Eigen::Triplet<double>> s, m;
  for (Index f = 0; f < mesh.faces.cols(); ++f) {
    const Eigen::Vector3i v = mesh.faces.col(f);
    Mat3 edge;  // opposite corner k
    for (int k = 0; k < 3; ++k) edge.col(k) = mesh.vertices.col(v[(k + 2) % 3]) - mesh.vertices.col(v[(k + 1) % 3]);
    const double area = Vec3d(edge.col(0)).cross(Vec3d(edge.col(1))).norm() / 2;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        s.emplace_back(v[i], v[j], edge.col(i).dot(edge.col(j)) / (4 * area));
        m.emplace_back(v[i], v[j], area * (i == j ? 2 : 1) / 12);
      }
  }
  Sparse S(n, n), M(n, n);
  S.setFromTriplets(s.begin(), s.end());
  M.setFromTriplets(m.begin(), m.end());
  const Sparse shifted = S + 0.1 * M;
  const Eigen::SimplicialLDLT<Sparse> solver(shifted);
  Eigen::MatrixXd x = harmonics(mesh.vertices.colwise().normalized(), 10).leftCols(block);
  Eigen::VectorXd values;
  for (int iteration = 0; iteration < 25; ++iteration) {
    x = solver.solve(Eigen::MatrixXd(M * x));
    const Eigen::MatrixXd a = x.transpose() * (S * x), b = x.transpose() * (M * x);
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> ritz(a, b);
    x *= ritz.eigenvectors();
    values = ritz.eigenvalues().head(count);
  }
  return values;
}

/// Eigenvalues of mode m (cos and sin of m times the longitude) of the spheroid (a, a, c), ascending: with h^2 = a^2
/// z^2 + c^2 (1 - z^2) they solve -((1 - z^2) a/h u')' + m^2 h / (a (1 - z^2)) u = lambda a h u on [-1, 1]. For
/// u = (1 - z^2)^(m/2) v and g = (1 - z^2) v' - m z v this is regular,
///   -((a/h)' g + (a/h)(g' - m z v') - m^2 c^2 / (a h) v) = lambda a h v,
/// and v is collocated at Chebyshev's nodes.
std::vector<double> spheroid_eigenvalues(double a, double c, int m, int n) {
  Eigen::VectorXd z(n), scale(n);
  for (int i = 0; i < n; ++i) {
    z[i] = std::cos(pi * (i + 0.5) / n);
    scale[i] = (i % 2 == 0 ? 1 : -1) * std::sin(pi * (i + 0.5) / n);  // of barycentric interpolation
  }
  Eigen::MatrixXd D = Eigen::MatrixXd::Zero(n, n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      if (i != j) {
        D(i, j) = scale[j] / scale[i] / (z[i] - z[j]);
        D(i, i) -= D(i, j);
      }
  const Eigen::ArrayXd x = z, h = (a * a * x.square() + c * c * (1 - x.square())).sqrt();
  const auto diagonal = [](const Eigen::ArrayXd& d) { return Eigen::MatrixXd(d.matrix().asDiagonal()); };
  const Eigen::MatrixXd g = diagonal(1 - x.square()) * D - diagonal(m * x);
  // g' from v'', not D g: g is of degree n, which the nodes mistake for a lower one.
  const Eigen::MatrixXd dg =
      diagonal(1 - x.square()) * D * D - diagonal((2.0 + m) * x) * D - m * Eigen::MatrixXd::Identity(n, n);
  const Eigen::MatrixXd A = diagonal(-a * x * (a * a - c * c) / h.cube()) * g +
                            diagonal(a / h) * (dg - diagonal(m * x) * D) - diagonal(m * m * c * c / (a * h));
  const Eigen::VectorXcd all = Eigen::EigenSolver<Eigen::MatrixXd>(diagonal(-1 / (a * h)) * A, false).eigenvalues();
  std::vector<double> values;
  for (Index k = 0; k < n; ++k) values.push_back(all[k].real());
  std::sort(values.begin(), values.end());
  values.resize(std::size_t(n / 3));  // those of modes that the nodes resolve
  return values;
}

double relative_error(const Eigen::VectorXd& value, const Eigen::VectorXd& exact, Index count) {
  return ((value.segment(1, count) - exact.segment(1, count)).array() / exact.segment(1, count).array())
      .abs()
      .maxCoeff();
}

}  // namespace

TEST_CASE("eigenvalues of a sphere are l(l + 1), 2 l + 1 of each", "[geometry]") {
  const auto spectrum = laplace_beltrami_spectrum(Ellipsoid{1, 1, 1}, {.degree = 10});
  CHECK(spectrum.eigenvalues[0] == 0);
  CHECK(relative_error(spectrum.eigenvalues, sphere_eigenvalues(10), 120) < 1e-12);
  CHECK(spectrum.summary.area == Approx(4 * pi).epsilon(1e-13));
  CHECK(spectrum.summary.mass_condition == Approx(1));
  CHECK(spectrum.summary.residual < 1e-12);
}

TEST_CASE("a sphere keeps its spectrum when its points are moved about", "[geometry]") {
  const Moved sphere{{1, 1, 1}, random_diffeomorphism(5, 3, 0.1)};
  const auto spectrum = laplace_beltrami_spectrum(sphere, {.degree = 16});
  CHECK(relative_error(spectrum.eigenvalues, sphere_eigenvalues(16), 35) < 1e-9);   // l <= 5
  CHECK(relative_error(spectrum.eigenvalues, sphere_eigenvalues(16), 120) < 1e-4);  // l <= 10
  CHECK(
      (spectrum.summary.estimated_errors.head(36) - spectrum.eigenvalues.head(36) + sphere_eigenvalues(5)).minCoeff() >
      -1e-10);
  CHECK(trusted_count(spectrum, 1e-6) >= 30);
  CHECK(trusted_count(spectrum, 1e-6) < 200);
}

TEST_CASE("eigenvalues of an ellipsoid are the limit of finite elements", "[geometry]") {
  const Ellipsoid e{1, 1.2, 1.7};
  std::vector<Eigen::VectorXd> coarse_to_fine;
  for (const int level : {2, 3, 4})
    coarse_to_fine.push_back(finite_element_eigenvalues(mesh_of(e, icosphere(level)), 11));
  const auto& [a, b, c] = std::tie(coarse_to_fine[0], coarse_to_fine[1], coarse_to_fine[2]);
  const Eigen::VectorXd once = (4 * b - a) / 3, again = (4 * c - b) / 3, limit = (16 * again - once) / 15;
  const auto spectrum = laplace_beltrami_spectrum(e, {.degree = 12});
  INFO("finest " << relative_error(c, spectrum.eigenvalues, 10) << ", extrapolated "
                 << relative_error(again, spectrum.eigenvalues, 10) << " and twice "
                 << relative_error(limit, spectrum.eigenvalues, 10));
  CHECK(relative_error(limit, spectrum.eigenvalues, 10) < 2e-5);
}

TEST_CASE("eigenvalues of spheroids solve Sturm-Liouville problems", "[geometry]") {
  const auto [c, tolerance] = GENERATE(table<double, double>({{1.7, 1e-9}, {0.6, 1e-8}}));
  std::vector<double> exact;
  for (int m = 0; m <= 8; ++m)
    for (const double value : spheroid_eigenvalues(1, c, m, 40))
      for (int copy = 0; copy < (m == 0 ? 1 : 2); ++copy) exact.push_back(value);
  std::sort(exact.begin(), exact.end());
  const auto spectrum = laplace_beltrami_spectrum(Ellipsoid{1, 1, c}, {.degree = 18, .count = 40});
  REQUIRE(spectrum.size() == 40);
  INFO(relative_error(spectrum.eigenvalues, Eigen::Map<Eigen::VectorXd>(exact.data(), 40), 25));
  CHECK(relative_error(spectrum.eigenvalues, Eigen::Map<Eigen::VectorXd>(exact.data(), 40), 25) < tolerance);
}

TEST_CASE("the spectrum turns with nothing and scales as length^-2", "[geometry]") {
  const Ellipsoid e{1, 1.3, 0.8};
  const Mat3 R = rotation_exp(Vec3d(0.3, -1.2, 0.7));
  const auto at_rest = laplace_beltrami_spectrum(e, {.degree = 12, .count = 30});
  const auto moved = laplace_beltrami_spectrum(Moved{e, {}, 2.5 * R}, {.degree = 12, .count = 30});
  const auto turned_first = laplace_beltrami_spectrum(Moved{e, SphereDiffeomorphism(R)}, {.degree = 12, .count = 30});
  CHECK(relative_error(2.5 * 2.5 * moved.eigenvalues, at_rest.eigenvalues, 29) < 1e-11);
  CHECK(relative_error(turned_first.eigenvalues, at_rest.eigenvalues, 29) < 1e-8);  // the nodes are others
}

TEST_CASE("eigenfunctions are orthonormal on the surface and satisfy the equation pointwise", "[geometry]") {
  const Ellipsoid e{1, 1.2, 0.9};
  const auto spectrum = laplace_beltrami_spectrum(e, {.degree = 14, .count = 12});
  const SphereQuadrature q = sphere_quadrature(45);
  const ChartBatch charts = charts_at(q.points);
  const Eigen::VectorXd dA = detail::area_densities(tangents(e, charts)).cwiseProduct(q.weights);
  const Eigen::MatrixXd phi = spectrum.values(q.points);
  const Eigen::MatrixXd gram = phi.transpose() * dA.asDiagonal() * phi;
  CHECK((gram - Eigen::MatrixXd::Identity(12, 12)).cwiseAbs().maxCoeff() < 1e-12);
  // On a level set of a quadratic function, Laplacian(u) = trace of the Hessian in the tangent plane - 2 H du/dn, here
  // of u = phi(A^-1 X / |A^-1 X|) in space, by second differences.
  for (const Index k : {1, 4, 11}) {
    const HarmonicFunction f = spectrum.eigenfunction(k);
    const Vec3d axes(e.a, e.b, e.c), s = Vec3d(1, -2, 0.5).normalized(), X = axes.cwiseProduct(s);
    const auto u = [&](const Vec3d& p) { return f(Vec3d(p.cwiseQuotient(axes).normalized())); };
    const Vec3d n = s.cwiseQuotient(axes).normalized();
    const TangentFrame frame = tangent_frame(n);
    const double d = 1e-3, du = (u(X + d * n) - u(X - d * n)) / (2 * d);
    double trace = 0;
    for (const Vec3d& t : {frame.e1, frame.e2}) trace += (u(X + d * t) - 2 * u(X) + u(X - d * t)) / (d * d);
    CHECK(trace - 2 * mean_curvature(e, s) * du == Approx(-spectrum.eigenvalues[k] * u(X)).epsilon(1e-4).margin(1e-5));
  }
}

TEST_CASE("the eigenvalues count as Weyl's law has it", "[geometry]") {
  const auto spectrum = laplace_beltrami_spectrum(Ellipsoid{1, 1.5, 1.2}, {.degree = 16});
  const Index k = trusted_count(spectrum, 1e-3);
  REQUIRE(k > 60);
  CHECK(spectrum.summary.area * spectrum.eigenvalues[k - 1] / (4 * pi) == Approx(double(k)).epsilon(0.08));
}

TEST_CASE("the heat trace begins as area / (4 pi t) + 1/3 + t / (60 pi) integral K^2", "[geometry]") {
  const Ellipsoid e{1, 1.2, 1.3};
  const auto spectrum = laplace_beltrami_spectrum(e, {.degree = 18});
  const SphereQuadrature q = sphere_quadrature(40);
  const Eigen::VectorXd dA = detail::area_densities(tangents(e, charts_at(q.points))).cwiseProduct(q.weights);
  const double k2 = curvature(e, q.points).gaussian.cwiseAbs2().dot(dA);
  for (const double t : {0.1, 0.15})
    CHECK(heat_trace(spectrum, t) ==
          Approx(dA.sum() / (4 * pi * t) + 1.0 / 3 + t * k2 / (60 * pi)).margin(0.05 * t * t));
}

TEST_CASE("heat keeps its amount, spreads evenly, and decays on the sphere as l(l + 1)", "[geometry]") {
  const auto ellipsoid = laplace_beltrami_spectrum(Ellipsoid{1, 2, 0.7}, {.degree = 14});
  const auto initial = [](const Vec3d& s) { return std::exp(s.x() - 0.4 * s.y()) + 0.2; };
  const auto content = [&](const HarmonicFunction& u) {
    return ellipsoid.nodes.weights.dot(u.values(ellipsoid.nodes.points));
  };
  double exact = 0;
  for (Index i = 0; i < ellipsoid.nodes.size(); ++i)
    exact += ellipsoid.nodes.weights[i] * initial(ellipsoid.nodes.points.col(i));
  for (const double t : {0.0, 0.1, 3.0})
    CHECK(content(heat_flow(ellipsoid, initial, t)) == Approx(exact).epsilon(1e-12));
  const Vec3d x = Vec3d(1, 2, 3).normalized();
  CHECK(heat_flow(ellipsoid, initial, 0)(x) == Approx(initial(x)).epsilon(1e-7));
  CHECK(heat_flow(ellipsoid, initial, 300)(x) == Approx(exact / ellipsoid.summary.area).epsilon(1e-12));

  const auto sphere = laplace_beltrami_spectrum(Ellipsoid{1, 1, 1}, {.degree = 6});
  const auto xyz = [](const Vec3d& s) { return s.x() * s.y() * s.z(); };  // of degree 3
  CHECK(heat_flow(sphere, xyz, 0.3)(x) == Approx(std::exp(-12 * 0.3) * xyz(x)).epsilon(1e-12));
}

TEST_CASE("the heat kernel is the sphere's, symmetric, and a semigroup", "[geometry]") {
  const double t = 0.2;
  const Mat3X s = test::sphere_points(12);
  const auto sphere = laplace_beltrami_spectrum(Ellipsoid{1, 1, 1}, {.degree = 14});
  const Eigen::MatrixXd k = heat_kernel(sphere, s, s, t);
  for (Index j = 0; j < s.cols(); ++j) {
    double sum = 0;  // (2 l + 1) / (4 pi) exp(-l (l + 1) t) P_l(x . y)
    for (int l = 0; l <= 14; ++l)
      sum += (2 * l + 1) / (4 * pi) * std::exp(-l * (l + 1) * t) *
             std::legendre(unsigned(l), std::clamp(s.col(0).dot(s.col(j)), -1.0, 1.0));
    CHECK(k(0, j) == Approx(sum).margin(1e-12));
  }
  CHECK((k - k.transpose()).cwiseAbs().maxCoeff() < 1e-13);

  const auto body = laplace_beltrami_spectrum(Ellipsoid{1, 1.4, 0.8}, {.degree = 10});
  const Eigen::MatrixXd half = heat_kernel(body, s, body.nodes.points, t / 2);
  CHECK((half * body.nodes.weights.asDiagonal() * half.transpose() - heat_kernel(body, s, s, t)).cwiseAbs().maxCoeff() <
        1e-12);
  const Eigen::MatrixXd distance = diffusion_distances(body, s, s, t);
  const Eigen::MatrixXd k2 = heat_kernel(body, s, s, 2 * t);
  CHECK(std::pow(distance(4, 15), 2) == Approx(k2(4, 4) + k2(15, 15) - 2 * k2(4, 15)));
  CHECK(distance.diagonal().maxCoeff() < 1e-13);
}

TEST_CASE("spectra refuse what they cannot do", "[geometry]") {
  const auto spectrum = laplace_beltrami_spectrum(Ellipsoid{}, {.degree = 2, .count = 3});
  CHECK_THROWS_AS(spectrum.eigenfunction(3), InvalidArgument);
  CHECK_THROWS_AS(heat_trace(spectrum, -1), InvalidArgument);
  CHECK_THROWS_AS(expand(spectrum, Eigen::VectorXd::Zero(5)), InvalidArgument);
  CHECK_THROWS_AS(laplace_beltrami_spectrum(Ellipsoid{}, {.count = -1}), InvalidArgument);
  CHECK_THROWS_AS(laplace_beltrami_spectrum(Ellipsoid{1, 0, 0}), DegenerateSurface);
}

}  // namespace spectrum_test
