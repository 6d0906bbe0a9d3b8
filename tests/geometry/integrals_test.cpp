#include "catch.hpp"
#include "support/smooth_surfaces.hpp"

#include <dsns/geometry/integrals.hpp>
#include <dsns/mesh/sphere_mesh.hpp>
#include <dsns/mesh/triangle_mesh.hpp>
#include <dsns/surface/sampled.hpp>

namespace integrals_test {

using namespace dsns;

namespace {

/// The unit ball sheared by (x, y, z + 0.3 x^2), which keeps volumes, then moved.
struct Bent {
  Vec3d offset = Vec3d::Zero();
  template <class T>
  Vec3<T> operator()(const Vec3<T>& s) const {
    return {s.x() + offset.x(), s.y() + offset.y(), s.z() + 0.3 * s.x() * s.x() + offset.z()};
  }
};

/// p / |p|^2 of a star-shaped surface around the origin, which stays outward.
template <class S>
struct Inverted {
  S surface;
  template <class T>
  Vec3<T> operator()(const Vec3<T>& s) const {
    const Vec3<T> p = surface(s);
    const T square = p[0] * p[0] + p[1] * p[1] + p[2] * p[2];
    return {p[0] / square, p[1] / square, p[2] / square};
  }
};

/// Resolves a surface of smooth_surfaces.hpp to 1e-9, the sharpest ripples to 1e-7.
const SphereQuadrature& resolving(const std::string& name) {
  static const SphereQuadrature smooth = sphere_quadrature(90), rippled = sphere_quadrature(160);
  return name == "bumpier sphere" ? rippled : smooth;
}

}  // namespace

TEST_CASE("area, volume, centroid and total curvature of a spheroid are the closed forms", "[geometry]") {
  const double c = 2, eccentricity = std::sqrt(1 - 1 / (c * c));
  const SphereQuadrature q = sphere_quadrature(60);
  const Ellipsoid e{1, 1, c};
  const SurfaceMeasures m = measure(e, q);
  CHECK(m.area == Approx(2 * pi * (1 + c / eccentricity * std::asin(eccentricity))).epsilon(1e-10));
  CHECK(m.volume == Approx(4 * pi / 3 * c).epsilon(1e-12));
  CHECK(m.area_centroid.norm() < 1e-12);
  CHECK(m.volume_centroid.norm() < 1e-12);
  CHECK(m.total_curvature == Approx(4 * pi).epsilon(1e-8));
  // Of convex bodies the integral of H is 2 pi times the mean width, here of 2 sqrt(1 + (c^2 - 1) x^2) over x in [0, 1].
  const double f = std::sqrt(c * c - 1);
  CHECK(m.total_mean_curvature == Approx(2 * pi * (c + std::asinh(f) / f)).epsilon(1e-9));
  CHECK(area(e, q) == Approx(m.area).epsilon(1e-13));
  CHECK(volume(e, q) == Approx(m.volume).epsilon(1e-13));
}

TEST_CASE("measures of a round sphere are those of school", "[geometry]") {
  const SurfaceMeasures m = measure(Ellipsoid{3, 3, 3}, sphere_quadrature(8));
  CHECK(m.area == Approx(36 * pi).epsilon(1e-12));
  CHECK(m.volume == Approx(36 * pi).epsilon(1e-12));
  CHECK(m.total_mean_curvature == Approx(12 * pi).epsilon(1e-12));
  CHECK(m.willmore_energy == Approx(4 * pi).epsilon(1e-12));
}

TEST_CASE("a sheared ball keeps its volume, and its centroid is a moment of the ball", "[geometry]") {
  const Vec3d offset(2, -1, 0.5);
  const SurfaceMeasures m = measure(Bent{offset}, sphere_quadrature(20));
  CHECK(m.volume == Approx(4 * pi / 3).epsilon(1e-12));
  CHECK((m.volume_centroid - offset - Vec3d(0, 0, 0.3 / 5)).norm() < 1e-12);  // the mean of x^2 in the ball is 1/5
  CHECK((m.area_centroid - m.volume_centroid).norm() > 5e-4);
}

TEST_CASE("Gauss-Bonnet and the divergence theorem hold for every surface", "[law]") {
  test::visit_smooth_surfaces([&](const std::string& name, const test::AnySurface& surface) {
    INFO(name);
    const SphereQuadrature& q = resolving(name);
    const SurfaceMeasures m = measure(surface, q);
    CHECK(m.total_curvature == Approx(4 * pi).epsilon(1e-6));
    CHECK(m.volume > 0);
    CHECK(m.willmore_energy > 4 * pi - 1e-6);
    const SurfaceTangents j = tangents(surface, charts_at(q.points));
    const Mat3X n = area_normals(j);
    CHECK((n * q.weights).norm() < 1e-7);  // the flux of a constant
    for (int k = 0; k < 3; ++k) {
      CHECK(j.f.row(k).cwiseProduct(n.row(k)) * q.weights == Approx(m.volume).epsilon(1e-7));
      // div (x_k^2 e_k) = 2 x_k: another way to the centroid of the body
      const double moment = j.f.row(k).cwiseAbs2().cwiseProduct(n.row(k)) * q.weights;
      CHECK(moment / 2 / m.volume == Approx(m.volume_centroid[k]).epsilon(1e-6).margin(1e-7));
    }
  });
}

TEST_CASE("the Willmore energy does not change under inversion", "[law]") {
  const SphereQuadrature q = sphere_quadrature(80);
  const auto check = [&](const auto& surface) {
    const SurfaceMeasures m = measure(surface, q),
                          inverse = measure(Inverted<std::decay_t<decltype(surface)>>{surface}, q);
    CHECK(inverse.area != Approx(m.area).epsilon(0.01));
    CHECK(inverse.volume > 0);
    CHECK(inverse.willmore_energy == Approx(m.willmore_energy).epsilon(1e-8));
  };
  check(Ellipsoid{1, 1.5, 0.7});
  check(Bent{Vec3d(0.1, 0.2, 0)});
  check(test::bumpy_harmonics());
}

TEST_CASE("measures do not change under rotation and reparametrisation", "[law]") {
  const Mat3 O = rotation_exp(Vec3d(0.7, -0.2, 0.4));
  const SphereDiffeomorphism gamma = random_diffeomorphism(6, 3, 0.08);
  test::visit_formulas([&](const std::string& name, const test::AnySurface& surface) {
    INFO(name);
    const SphereQuadrature& q = resolving(name);
    const SurfaceMeasures a = measure(surface, q), b = measure(rotated(reparametrized(surface, gamma), O), q);
    CHECK(b.area == Approx(a.area).epsilon(1e-9));
    CHECK(b.volume == Approx(a.volume).epsilon(1e-9));
    CHECK((b.area_centroid - O * a.area_centroid).norm() < 1e-9);
    CHECK((b.volume_centroid - O * a.volume_centroid).norm() < 1e-9);
    CHECK(b.total_mean_curvature == Approx(a.total_mean_curvature).epsilon(1e-8));
    CHECK(b.willmore_energy == Approx(a.willmore_energy).epsilon(1e-8));
  });
}

TEST_CASE("any function can be integrated, numbers and vectors", "[geometry]") {
  const SphereQuadrature q = sphere_quadrature(30);
  const Ellipsoid e{1, 1, 2};
  CHECK(integral(e, q, [](const Vec3d&) { return 1.0; }) == Approx(area(e, q)).epsilon(1e-13));
  CHECK(integral(Ellipsoid{2, 2, 2}, q, [](const Vec3d& s) { return s.z() * s.z(); }) == Approx(16 * pi / 3));
  const Bent bent{Vec3d(1, 2, 3)};
  const Vec3d moment = integral(bent, q, [&](const Vec3d& s) -> Vec3d { return bent(s); });
  CHECK((moment / area(bent, q) - measure(bent, q).area_centroid).norm() < 1e-12);
}

TEST_CASE("a sampled body has the mesh's area and volume, up to the quadrature's view of its faces", "[geometry]") {
  const TriangleMesh sphere = icosphere(2);
  TriangleMesh mesh = sphere;
  for (Index i = 0; i < mesh.vertices.cols(); ++i)
    mesh.vertices.col(i) = Ellipsoid{1, 1.5, 0.7}(Vec3d(sphere.vertices.col(i)));
  MeshSequence sequence;
  sequence.frames = {mesh.vertices};
  sequence.faces = mesh.faces;
  const SampledSurface sampled(sequence, sphere.vertices);
  const SphereQuadrature q = sphere_quadrature(60);
  CHECK(area(at_time(sampled, 0.0), q) == Approx(area(mesh)).epsilon(1e-3));
  CHECK(volume(at_time(sampled, 0.0), q) == Approx(volume(mesh)).epsilon(1e-3));
}

}  // namespace integrals_test
