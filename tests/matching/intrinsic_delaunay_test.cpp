#include "catch.hpp"
#include "support/bodies.hpp"

#include <dsns/matching/intrinsic_delaunay.hpp>

namespace intrinsic_delaunay_test {

using namespace dsns;

namespace {

IntrinsicTriangulation intrinsic(const TriangleMesh& mesh) {
  IntrinsicTriangulation t{mesh.faces, Mat3X(3, mesh.faces.cols())};
  for (Index f = 0; f < mesh.faces.cols(); ++f)
    for (int k = 0; k < 3; ++k)
      t.lengths(k, f) =
          (mesh.vertices.col(mesh.faces((k + 1) % 3, f)) - mesh.vertices.col(mesh.faces((k + 2) % 3, f))).norm();
  return t;
}

/// Heron's formula as Kahan sorts it.
double total_area(const IntrinsicTriangulation& t) {
  double sum = 0;
  for (Index f = 0; f < t.faces.cols(); ++f) {
    Vec3d l = t.lengths.col(f);
    std::sort(l.data(), l.data() + 3, std::greater<>());
    const double a = l[0], b = l[1], c = l[2];
    sum += std::sqrt((a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c))) / 4;
  }
  return sum;
}

/// Sums of cotangents by edge, from angles; edges of the same ends and length are taken together.
double least_weight(const IntrinsicTriangulation& t) {
  std::map<std::tuple<int, int, long>, double> weights;
  for (Index f = 0; f < t.faces.cols(); ++f)
    for (int k = 0; k < 3; ++k) {
      const double a = t.lengths(k, f), b = t.lengths((k + 1) % 3, f), c = t.lengths((k + 2) % 3, f);
      const auto [u, v] = std::minmax(t.faces((k + 1) % 3, f), t.faces((k + 2) % 3, f));
      weights[{u, v, std::lround(1e7 * a)}] += 1 / std::tan(std::acos((b * b + c * c - a * a) / (2 * b * c)));
    }
  double least = 1e9;
  for (const auto& [edge, weight] : weights) least = std::min(least, weight);
  return least;
}

/// Directed edges as multisets, to check that faces still close up.
bool closed(const IntrinsicTriangulation& t) {
  std::map<std::tuple<int, int, long>, int> count;
  for (Index f = 0; f < t.faces.cols(); ++f)
    for (int k = 0; k < 3; ++k) {
      const int u = t.faces((k + 1) % 3, f), v = t.faces((k + 2) % 3, f);
      ++count[{u, v, std::lround(1e7 * t.lengths(k, f))}];
      --count[{v, u, std::lround(1e7 * t.lengths(k, f))}];
    }
  return std::all_of(count.begin(), count.end(), [](const auto& c) { return c.second == 0; });
}

}  // namespace

TEST_CASE("Delaunay flips keep area and closure and leave no negative weight", "[matching]") {
  const TriangleMesh needles = test::stretched(latitude_longitude_sphere(20, 8), Vec3d(1, 1, 0.2));
  for (const TriangleMesh& mesh : {test::stretched(icosphere(2), Vec3d(1, 0.05, 6)), needles,
                                   test::noisy(icosphere(3), 0.06, 3), test::limbed_body(5, 6, 2)}) {
    const IntrinsicTriangulation before = intrinsic(mesh), after = intrinsic_delaunay(before);
    CHECK(total_area(after) == Approx(total_area(before)).epsilon(1e-10));
    CHECK(closed(after));
    CHECK(least_weight(before) < -0.1);
    CHECK(least_weight(after) > -1e-6);
  }
}

TEST_CASE("a flipped diagonal of a flat quadrilateral is the other diagonal", "[matching]") {
  // A flat double-sided kite: corners (+-1, 0) and (0, +-4), split along the long diagonal in front, the short one behind.
  TriangleMesh kite{Mat3X(3, 4), Faces(3, 4)};
  kite.vertices << 1, 0, -1, 0, 0, 4, 0, -4, 0, 0, 0, 0;
  kite.faces << 0, 2, 3, 2, 1, 3, 2, 1, 3, 1, 0, 0;
  const IntrinsicTriangulation t = intrinsic_delaunay(intrinsic(kite));
  int short_diagonals = 0;
  for (const double length : t.lengths.reshaped()) short_diagonals += std::abs(length - 2) < 1e-12;
  CHECK(short_diagonals == 4);
  CHECK((t.lengths.array() < 5).all());
}

TEST_CASE("Delaunay meshes stay as they are; open ones are refused", "[matching]") {
  const IntrinsicTriangulation sphere = intrinsic(icosphere(2));
  CHECK(intrinsic_delaunay(sphere).faces == sphere.faces);
  IntrinsicTriangulation open = sphere;
  open.faces.conservativeResize(3, 10);
  open.lengths.conservativeResize(3, 10);
  CHECK_THROWS_AS(intrinsic_delaunay(open), InvalidArgument);
}

}  // namespace intrinsic_delaunay_test
