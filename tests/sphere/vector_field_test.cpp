#include "catch.hpp"
#include "support/sphere_points.hpp"

#include <dsns/sphere/vector_field.hpp>
#include <dsns/surface/jets.hpp>

namespace vector_field_test {

using namespace dsns;

namespace {

SphereVectorField some_field(int degree, double size) {
  SphereVectorField v = SphereVectorField::zero(degree);
  for (Index k = 1; k < v.a.size(); ++k) {
    v.a[k] = size * std::sin(1.3 * double(k)) / double(k);
    v.b[k] = size * std::cos(0.7 * double(k)) / double(k);
  }
  return v;
}

}  // namespace

TEST_CASE("vector fields are tangent, with divergence and curl -l(l+1) Y of the potentials", "[sphere]") {
  const ChartBatch c = charts_at(test::sphere_points());
  const SphereVectorField v = some_field(5, 0.4);
  const Eigen::ArrayXd l = harmonic_degrees(5);
  for (Index i = 0; i < c.size(); ++i) {
    const auto jet = evaluate(v, detail::chart_jet(c, i));
    const Vec3d s = c.s.col(i), value(jet[0].f, jet[1].f, jet[2].f);
    CHECK(std::abs(value.dot(s)) < 1e-14);
    double divergence = 0, curl = 0;
    for (int k = 0; k < 3; ++k) {
      divergence += c.e1(k, i) * jet[k].g[0] + c.e2(k, i) * jet[k].g[1];
      curl += c.e2(k, i) * jet[k].g[0] - c.e1(k, i) * jet[k].g[1];
    }
    const Eigen::VectorXd y = harmonics<double>(s, 5);
    CHECK(curl == Approx((-l * (l + 1) * v.b.array() * y.array()).sum()).margin(1e-12));
    CHECK(divergence == Approx((-l * (l + 1) * v.a.array() * y.array()).sum()).margin(1e-12));
  }
}

TEST_CASE("vector fields at many points are those at each", "[sphere]") {
  const int degree = GENERATE(1, 2, 12);
  const ChartBatch c = charts_at(test::sphere_points());
  const SphereVectorField v = some_field(degree, 1);
  const Mat3X all = evaluate(v, c);
  for (Index i = 0; i < c.size(); ++i) CHECK((all.col(i) - evaluate(v, Vec3d(c.s.col(i)))).norm() < 1e-13);
}

TEST_CASE("vector harmonics are orthogonal with squared norm l(l + 1)", "[sphere]") {
  constexpr int degree = 3;
  const SphereQuadrature q = sphere_quadrature(degree + 2);
  const ChartBatch c = charts_at(q.points);
  const Index count = harmonic_count(degree) - 1;
  Eigen::MatrixXd fields(3 * q.size(), 2 * count);
  for (Index k = 0; k < 2 * count; ++k) {
    SphereVectorField v = SphereVectorField::zero(degree);
    (k < count ? v.a : v.b)[1 + k % count] = 1;
    fields.col(k) = (evaluate(v, c) * q.weights.cwiseSqrt().asDiagonal()).reshaped();
  }
  const Eigen::VectorXd l = harmonic_degrees(degree).tail(count).matrix().replicate(2, 1);
  const Eigen::MatrixXd expected = (l.array() * (l.array() + 1)).matrix().asDiagonal();
  CHECK((fields.transpose() * fields - expected).cwiseAbs().maxCoeff() < 1e-13);
}

TEST_CASE("projection finds a field again, whatever stands on it radially", "[sphere]") {
  const int degree = GENERATE(1, 2, 12);
  SphereVectorField v = some_field(degree, 1);
  v.a[0] = v.b[0] = 0;
  const SphereQuadrature q = sphere_quadrature(degree + 2);
  const Mat3X radial = q.points * q.points.row(2).array().exp().matrix().asDiagonal();
  const SphereVectorField found = project_on_vector_harmonics(evaluate(v, charts_at(q.points)) + radial, q, degree);
  CHECK((found.a - v.a).norm() < 1e-13);
  CHECK((found.b - v.b).norm() < 1e-13);
  CHECK_THROWS_AS(project_on_vector_harmonics(Mat3X(3, 2), q, degree), InvalidArgument);
}

TEST_CASE("projection of e_z x s is the rotation about the z-axis", "[sphere]") {
  const SphereQuadrature q = sphere_quadrature(6);
  Mat3X turning(3, q.size());
  for (Index i = 0; i < q.size(); ++i) turning.col(i) = Vec3d::UnitZ().cross(q.points.col(i));
  SphereVectorField expected = SphereVectorField::zero(4);
  expected.b[2] = -1 / std::sqrt(3 / (4 * pi));  // s x grad z = s x e_z
  const SphereVectorField found = project_on_vector_harmonics(turning, q, 4);
  CHECK(found.a.norm() < 1e-14);
  CHECK((found.b - expected.b).norm() < 1e-14);
}

TEST_CASE("displacement agrees with jets through the exponential, for tiny and for long steps", "[sphere]") {
  const double size = GENERATE(0.0, 1e-9, 1e-3, 0.3, 2.5);
  const ChartBatch c = charts_at(test::sphere_points());
  const SphereVectorField v = some_field(4, size);
  const SphereDisplacement d = displace(v, c);
  double worst = 0;
  for (Index i = 0; i < c.size(); ++i) {
    const auto jet = exponential(v, detail::chart_jet(c, i));
    for (int k = 0; k < 3; ++k)
      worst = std::max({worst, std::abs(jet[k].f - d.y(k, i)), std::abs(jet[k].g[0] - d.y1(k, i)),
                        std::abs(jet[k].g[1] - d.y2(k, i))});
    CHECK(d.y.col(i).norm() == Approx(1).epsilon(1e-14));
    CHECK(d.J[i] == Approx(d.y.col(i).dot(d.y1.col(i).cross(d.y2.col(i)))));
  }
  CHECK(worst < 1e-12 * (1 + size));
}

TEST_CASE("the rotated gradient of a degree-one harmonic turns the sphere", "[sphere]") {
  SphereVectorField v = SphereVectorField::zero(1);
  v.b[2] = 0.7 / std::sqrt(3 / (4 * pi));  // Y = sqrt(3/4pi) z, so v = 0.7 s x e_z at the equator
  const Vec3d moved = exponential<double>(v, Vec3d::UnitX());
  CHECK((moved - Vec3d(std::cos(0.7), -std::sin(0.7), 0)).norm() < 1e-14);
}

}  // namespace vector_field_test
