#include <dsns/mesh/area_ratios.hpp>

#include <cmath>

#include "catch.hpp"
#include "support/bodies.hpp"

namespace area_ratios_test {

using namespace dsns;

TEST_CASE("a sphere on itself has area ratios near 1, a rotated one the same", "[parameterization]") {
  const TriangleMesh sphere = icosphere(3);
  const AreaRatios r = area_ratios(test::still(sphere), sphere.vertices);
  // Flat triangles against spherical ones: the ratio falls with the triangle.
  CHECK(r.least == Approx(1).epsilon(0.01));
  CHECK(r.percentile_99 == Approx(1).epsilon(0.01));
  CHECK(r.least <= r.percentile_1);
  CHECK(r.percentile_1 <= r.percentile_99);
  CHECK(r.worst_frame_least == r.least);
}

TEST_CASE("a frame that stretches is the worst frame", "[parameterization]") {
  const TriangleMesh sphere = icosphere(4);
  MeshSequence sequence = test::still(sphere);
  sequence.frames.push_back(test::stretched(sphere, {1, 1, 3}).vertices);
  const AreaRatios r = area_ratios(sequence, sphere.vertices);
  // Around the equator the spheroid has three times the sphere's area.
  const double e = std::sqrt(8.0 / 9), spheroid = 2 * pi * (1 + 3 / e * std::asin(e));
  CHECK(r.worst_frame_least == Approx(spheroid / (4 * pi) / 3).epsilon(0.01));
  CHECK(r.least > r.worst_frame_least);
}

TEST_CASE("faces that close holes and slivers have no ratio", "[parameterization]") {
  const TriangleMesh sphere = icosphere(2);
  MeshSequence sequence = test::still(sphere);
  const Index last = sphere.faces.cols() - 1;
  sequence.cap_faces = 1;
  // A cap that is a point of the surface yet has its share of the sphere.
  Mat3X& points = sequence.frames[0];
  const Vec3d middle = points(Eigen::all, sphere.faces.col(last)).rowwise().mean();
  const double before = area_ratios(sequence, sphere.vertices).percentile_99;
  for (int k = 0; k < 3; ++k)
    points.col(sphere.faces(k, last)) = middle + 1e-6 * (points.col(sphere.faces(k, last)) - middle);
  CHECK(area_ratios(sequence, sphere.vertices).percentile_99 < 10 * before);
  CHECK_THROWS_AS(area_ratios(sequence, Mat3X::Zero(3, 5)), InvalidArgument);
}

}  // namespace area_ratios_test
