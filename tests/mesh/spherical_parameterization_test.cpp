#include <dsns/io/frames.hpp>
#include <dsns/mesh/spherical_parameterization.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <string>

#include "catch.hpp"
#include "support/bodies.hpp"

namespace spherical_parameterization_test {

using namespace dsns;

namespace {

/// Whether every triangle turns counter-clockwise, in extended precision, and together they cover the sphere once.
bool independently_bijective(const Mat3X& sphere, const Faces& faces) {
  long double covered = 0;
  const Eigen::Matrix<long double, 3, Eigen::Dynamic> p = sphere.cast<long double>();
  for (Index f = 0; f < faces.cols(); ++f) {
    const Eigen::Matrix<long double, 3, 1> a = p.col(faces(0, f)), b = p.col(faces(1, f)), c = p.col(faces(2, f));
    if (!(a.dot(b.cross(c)) > 0)) return false;
    // l'Huilier's theorem
    const auto side = [](const auto& x, const auto& y) { return 2 * std::asin((x - y).norm() / 2); };
    const long double x = side(b, c), y = side(c, a), z = side(a, b), s = (x + y + z) / 2;
    covered += 4 * std::atan(std::sqrt(std::max(
                       0.0L, std::tan(s / 2) * std::tan((s - x) / 2) * std::tan((s - y) / 2) * std::tan((s - z) / 2))));
  }
  return std::abs(static_cast<double>(covered) - 4 * pi) < 1e-7;
}

ParameterizationResult check_bijective(const MeshSequence& sequence) {
  const ParameterizationResult map = spherical_parameterization(sequence);
  REQUIRE(map.sphere.cols() == sequence.vertex_count());
  CHECK(map.certificate.flips == 0);
  CHECK(map.certificate.area_defect < 1e-10);
  CHECK(map.certificate.min_area_ratio > 0);
  CHECK((map.sphere.colwise().norm().array() - 1).abs().maxCoeff() < 1e-15);
  CHECK(independently_bijective(map.sphere, sequence.faces));
  CHECK(map.energy.size() >= 2);
  CHECK(std::is_sorted(map.energy.rbegin(), map.energy.rend()));
  CHECK(map.energy.back() >= 2 - 1e-12);
  return map;
}

std::string refusal(const TriangleMesh& mesh) {
  try {
    spherical_parameterization(mesh);
  } catch (const UnusableMesh& error) {
    return error.what();
  }
  return "";
}

bool mentions(const std::string& text, const std::string& word) { return text.find(word) != std::string::npos; }

}  // namespace

TEST_CASE("small and regular meshes map without a flip", "[parameterization]") {
  check_bijective(test::still(test::octahedron()));
  check_bijective(test::still(latitude_longitude_sphere(1, 3)));
  check_bijective(test::still(icosphere(0)));
  const auto tetrahedron = check_bijective(test::still(test::tetrahedron()));
  for (int i = 0; i < 4; ++i)  // regular stays regular
    for (int j = 0; j < i; ++j) CHECK(tetrahedron.sphere.col(i).dot(tetrahedron.sphere.col(j)) == Approx(-1.0 / 3));
}

TEST_CASE("a sphere maps to itself up to small distortion", "[parameterization]") {
  const auto map = check_bijective(test::still(icosphere(3)));
  CHECK(map.certificate.min_area_ratio > 0.8);
  CHECK(map.energy.back() < 2.05);
}

TEST_CASE("noise, needles, limbs and fans map without a flip", "[parameterization]") {
  SECTION("noise as large as the edges") { check_bijective(test::still(test::noisy(icosphere(3), 0.1, 1))); }
  SECTION("100:1 ellipsoids") {
    check_bijective(test::still(test::stretched(icosphere(3), {100, 1, 1})));
    check_bijective(test::still(test::stretched(icosphere(3), {100, 100, 1})));
  }
  SECTION("400:1 ellipsoids") {
    check_bijective(test::still(test::stretched(icosphere(4), {400, 1, 1})));
    check_bijective(test::still(test::stretched(icosphere(4), {400, 400, 1})));
    check_bijective(test::still(test::noisy(test::stretched(icosphere(3), {1, 400, 20}), 0.3, 2)));
  }
  SECTION("long limbs") {
    const auto map = check_bijective(test::still(test::limbed_body(5, 25, 10)));
    CHECK(map.certificate.min_area_ratio > 0.1);
  }
  SECTION("a vertex with 150 neighbours") { check_bijective(test::still(latitude_longitude_sphere(2, 150))); }
  SECTION("faces without area and vertices that coincide") {
    TriangleMesh mesh = icosphere(2);
    mesh.vertices.col(mesh.faces(0, 7)) = mesh.vertices.col(mesh.faces(1, 7));
    mesh.vertices.col(mesh.faces(2, 7)) = mesh.vertices.col(mesh.faces(1, 7));
    check_bijective(test::still(mesh));
  }
  SECTION("any length unit, any place") {
    TriangleMesh mesh = icosphere(2);
    for (const double unit : {1e-120, 1e120})
      check_bijective(test::still(test::stretched(mesh, Vec3d::Constant(unit))));
    mesh.vertices.colwise() += Vec3d(1e6, 0, 0);
    check_bijective(test::still(mesh));
  }
}

TEST_CASE("200 triangulations drawn at random map without a flip", "[parameterization]") {
  for (unsigned seed = 0; seed < 200; ++seed) {
    INFO("seed " << seed);
    check_bijective(test::still(test::random_triangulation(4 + int(seed) * 3 / 2, seed)));
  }
}

TEST_CASE("100 000 vertices map without a flip", "[parameterization]") {
#ifdef NDEBUG
  const int rings = 250;
#else
  const int rings = 60;  // checked builds are twenty times slower
#endif
  const TriangleMesh sphere = latitude_longitude_sphere(rings, 400);
  check_bijective(test::still(test::stretched(test::noisy(sphere, 0.002, 3), {1, 2, 5})));
}

TEST_CASE("the order of vertices and faces does not matter for certainty", "[parameterization]") {
  const TriangleMesh body = test::limbed_body(4, 10, 4);
  const double reference = check_bijective(test::still(body)).energy.back();
  for (const unsigned seed : {1U, 2U, 3U})
    CHECK(check_bijective(test::still(test::relabelled(body, seed))).energy.back() == Approx(reference).epsilon(0.2));
}

TEST_CASE("the same mesh gives the same bits", "[parameterization]") {
  const TriangleMesh body = test::limbed_body(3, 10, 4);
  CHECK(spherical_parameterization(body).sphere == spherical_parameterization(body).sphere);
}

TEST_CASE("one map for all frames starves no frame's limb", "[parameterization]") {
  // a limb that is long in the first frame only, another in the last frame only
  const auto body = [](const Vec3d& s, double t) {
    const double first = std::exp(12 * (s.z() - 1)), last = std::exp(12 * (-s.z() - 1));
    return Vec3d(s + 4 * ((1 - t) * first - t * last) * Vec3d::UnitZ());
  };
  const MeshSequence sequence = sequence_of(body, icosphere(3), 5);
  const auto map = check_bijective(sequence);
  for (const Mat3X& frame : {sequence.frames.front(), sequence.frames.back()}) {
    const Eigen::VectorXd areas = face_normals(frame, sequence.faces).colwise().norm().transpose();
    CHECK(certify(map.sphere, sequence.faces, areas).min_area_ratio > 0.2);
  }
}

TEST_CASE("faces that close holes get little of the sphere", "[parameterization]") {
  MeshSequence sequence = test::still(latitude_longitude_sphere(6, 24));  // its last faces, 24, surround the south pole
  sequence.frames[0].row(2) *= 0.02;                                      // a disc: caps would be large
  sequence.frames[0].col(sequence.vertex_count() - 1).z() = -3;
  std::vector<Index> caps;
  Faces ordered = sequence.faces;
  Index front = 0, back = ordered.cols();
  for (Index f = ordered.cols() - 1; f >= 0; --f) {
    const bool cap = (sequence.faces.col(f).array() == int(sequence.vertex_count()) - 1).any();
    ordered.col(cap ? --back : front++) = sequence.faces.col(f);
  }
  sequence.faces = ordered;
  sequence.cap_faces = 24;
  const auto map = check_bijective(sequence);
  CHECK(map.masses.sum() == Approx(1));
  CHECK(map.masses.tail(24).sum() == Approx((0.1 / 1.1 + 0.01 * 24 / double(ordered.cols())) / 1.01));
}

TEST_CASE("meshes that are no sphere are refused in one sentence that says why", "[parameterization]") {
  const TriangleMesh ball = icosphere(1);
  CHECK(mentions(refusal(test::torus(8, 6)), "1 handles"));
  CHECK(mentions(refusal(test::joined(ball, test::stretched(ball, Vec3d::Constant(2)))), "2 pieces"));
  TriangleMesh open = ball;
  open.faces.conservativeResize(3, open.faces.cols() - 1);
  CHECK(mentions(refusal(open), "1 holes (3 edges"));
  TriangleMesh turned = ball;
  std::swap(turned.faces(0, 3), turned.faces(1, 3));
  CHECK(mentions(refusal(turned), "oriented differently"));
  TriangleMesh unused = ball;
  unused.vertices.conservativeResize(3, unused.vertices.cols() + 1);
  unused.vertices.rightCols<1>().setZero();
  CHECK(mentions(refusal(unused), "1 vertices without a face"));
  TriangleMesh infinite = ball;
  infinite.vertices(1, 5) = std::numeric_limits<double>::infinity();
  CHECK(mentions(refusal(infinite), "not finite"));
  CHECK(mentions(refusal(test::stretched(ball, Vec3d::Zero())), "size 0"));
  CHECK(mentions(refusal(test::stretched(ball, Vec3d::UnitX())), "no area"));
  TriangleMesh fin = ball;
  fin.faces.conservativeResize(3, fin.faces.cols() + 1);
  fin.faces.rightCols<1>() << fin.faces(1, 0), fin.faces(0, 0), fin.faces(2, 5);
  CHECK(mentions(refusal(fin), "more than two faces"));
  CHECK(refusal(ball).empty());
}

TEST_CASE("two balls that share a vertex are refused though every edge has two faces", "[parameterization]") {
  TriangleMesh two = test::joined(icosphere(1), icosphere(1));
  const int joined = static_cast<int>(icosphere(1).vertices.cols()), last = static_cast<int>(two.vertices.cols()) - 1;
  for (Index f = 0; f < two.faces.cols(); ++f)
    for (int k = 0; k < 3; ++k) {
      if (two.faces(k, f) == joined)
        two.faces(k, f) = 0;
      else if (two.faces(k, f) == last)
        two.faces(k, f) = joined;
    }
  two.vertices.col(joined) = two.vertices.col(last);
  two.vertices.conservativeResize(3, last);
  CHECK_FALSE(refusal(two).empty());
}

TEST_CASE("options outside their range are refused", "[parameterization]") {
  ParameterizationOptions options;
  options.frames = 0;
  CHECK_THROWS_AS(spherical_parameterization(icosphere(1), options), InvalidArgument);
  options = {};
  options.mass_floor = 0;
  CHECK_THROWS_AS(spherical_parameterization(icosphere(1), options), InvalidArgument);
}

TEST_CASE("real galloping animals map without a flip", "[parameterization][data]") {
#ifdef DSNS_TEST_DATA_DIR
  for (const char* name : {"Horse_Gallop", "Wolf_Gallop"}) {
    const std::filesystem::path folder = std::filesystem::path(DSNS_TEST_DATA_DIR) / "obj_sequences" / name;
    if (!std::filesystem::exists(folder)) DSNS_SKIP("no " << folder.string());
    const auto map = check_bijective(read_frames(folder));
    CHECK(map.certificate.min_area_ratio > 0.1);
  }
#else
  DSNS_SKIP("DSNS_TEST_DATA_DIR is not set");
#endif
}

}  // namespace spherical_parameterization_test
