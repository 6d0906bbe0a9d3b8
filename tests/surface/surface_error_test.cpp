#include <dsns/surface/surface_error.hpp>

#include <cmath>

#include "catch.hpp"
#include "support/bodies.hpp"

namespace surface_error_test {

using namespace dsns;

namespace {

/// A round sphere, moved.
struct Ball {
  double radius = 1;
  Vec3d shift = Vec3d::Zero();
  template <class T>
  Vec3<T> operator()(const Vec3<T>& s, const T& t) const {
    return s * (radius * (1.0 + 0.1 * t)) + shift.cast<T>();
  }
};

/// x + slope z: normals in the plane of x and z turn.
struct Sheared {
  double slope;
  template <class T>
  Vec3<T> operator()(const Vec3<T>& s, const T&) const {
    return Vec3<T>(s.x() + slope * s.z(), s.y(), s.z());
  }
};

MeshSequence mesh_of(const TriangleMesh& sphere) {
  return sequence_of([](const Vec3d& s, double t) { return Ball{}(s, t); }, sphere, 4);
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

}  // namespace

TEST_CASE("a surface is at no distance from itself", "[surface_error]") {
  const Mat3X s = test::random_unit_vectors(50, 1);
  const SurfaceError e = compare(Ball{}, Ball{}, s, {0, 0.5});
  CHECK(e.msd == 0);
  CHECK(e.max_distance == 0);
  CHECK(e.normal_angle_mean_deg < 1e-5);
}

TEST_CASE("a shift is a distance in units of the unit, and turns no normal", "[surface_error]") {
  const Mat3X s = test::random_unit_vectors(50, 2);
  const SurfaceError e = compare(Ball{}, Ball{1, Vec3d(0.2, 0, 0.1)}, s, {0, 0.3, 1}, 2);
  CHECK(e.msd == Approx(0.05 / 3 / 4));
  CHECK(e.rms_distance == Approx(std::sqrt(0.05) / 2));
  CHECK(e.max_distance == Approx(std::sqrt(0.05) / 2));
  CHECK(e.normal_angle_median_deg < 1e-5);
}

TEST_CASE("angles of normals are those of the closed form, in mean and median", "[surface_error]") {
  const Mat3X s = test::random_unit_vectors(51, 3);
  const SurfaceError e = compare(Ball{}, Sheared{0.3}, s, {0.4});
  std::vector<double> angles;
  for (const Vec3d n : s.colwise()) {  // normals go by the inverse transposed
    const Vec3d other = Vec3d(n.x(), n.y(), n.z() - 0.3 * n.x()).normalized();
    angles.push_back(std::acos(std::min(1.0, n.dot(other))) * 180 / pi);
  }
  double mean = 0;
  for (const double a : angles) mean += a / double(angles.size());
  CHECK(e.normal_angle_mean_deg == Approx(mean).epsilon(1e-5));
  CHECK(e.normal_angle_median_deg == Approx(median(angles)).epsilon(1e-5));
  CHECK(e.normal_angle_median_deg != Approx(mean).epsilon(1e-3));
}

TEST_CASE("a smooth surface is near a mesh's interpolated normals and as far from its faces' as they are",
          "[surface_error]") {
  const TriangleMesh sphere = icosphere(3);
  const MeshSequence sequence = mesh_of(sphere);
  const SampledSurface mesh(sequence, sphere.vertices);
  const Mat3X s = test::random_unit_vectors(400, 4);
  const SampledSurfaceError e = compare(Ball{}, mesh, s, {0, 1});
  CHECK(e.smooth_normal_angle_median_deg < 0.15 * e.normal_angle_median_deg);
  CHECK(e.smooth_normal_angle_mean_deg < 0.15 * e.normal_angle_mean_deg);
  CHECK(e.mesh_normal_angle_mean_deg == Approx(e.normal_angle_mean_deg).epsilon(0.05));
  CHECK(e.mesh_normal_angle_median_deg == Approx(e.normal_angle_median_deg).epsilon(0.05));
  // The flat faces' angle: to the middle of the face, where the sphere's normal is the face's.
  const auto hits = mesh.locate(s);
  std::vector<double> angles;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    Mat3 x;
    for (int k = 0; k < 3; ++k) x.col(k) = sphere.vertices.col(sphere.faces(k, hits[i].face));
    const Vec3d n = (x.col(1) - x.col(0)).cross(x.col(2) - x.col(0)).normalized();
    angles.push_back(std::acos(n.dot(s.col(Index(i)))) * 180 / pi);
  }
  CHECK(e.normal_angle_median_deg == Approx(median(angles)).epsilon(0.01));
}

TEST_CASE("on faces that close holes nothing is compared", "[surface_error]") {
  const TriangleMesh sphere = icosphere(2);
  MeshSequence sequence = mesh_of(sphere);
  sequence.cap_faces = sphere.faces.cols() / 2;
  const SampledSurface whole(mesh_of(sphere), sphere.vertices), open(sequence, sphere.vertices);
  const Mat3X s = test::random_unit_vectors(300, 5);
  Mat3X own(3, 0), caps(3, 0);
  for (Index i = 0; const SphereHit& hit : open.locate(s)) {
    Mat3X& part = open.on_cap(hit) ? caps : own;
    part.conservativeResize(3, part.cols() + 1);
    part.rightCols<1>() = s.col(i++);
  }
  REQUIRE(own.cols() > 50);
  REQUIRE(caps.cols() > 50);
  CHECK(compare(Ball{1.1}, open, s, {0.5}).msd == Approx(compare(Ball{1.1}, whole, own, {0.5}).msd));
  CHECK_THROWS_AS(compare(Ball{}, open, caps, {0.5}), InvalidArgument);
}

TEST_CASE("comparisons refuse no points, no times and no unit", "[surface_error]") {
  const Mat3X s = test::random_unit_vectors(3, 6);
  CHECK_THROWS_AS(compare(Ball{}, Ball{}, Mat3X(3, 0), {0}), InvalidArgument);
  CHECK_THROWS_AS(compare(Ball{}, Ball{}, s, {}), InvalidArgument);
  CHECK_THROWS_AS(compare(Ball{}, Ball{}, s, {0}, 0), InvalidArgument);
}

}  // namespace surface_error_test
