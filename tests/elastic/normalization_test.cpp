#include "catch.hpp"

#include <dsns/elastic/normalization.hpp>
#include <dsns/mesh/sphere_mesh.hpp>

namespace normalization_test {

using namespace dsns;

TEST_CASE("normalising takes place and size out and keeps them", "[elastic]") {
  const auto walking = [](const Vec3d& s, double t) -> Vec3d {
    return 3 * Vec3d(s.x(), 2 * s.y(), s.z()) + Vec3d(10 * t, 1, -4 * t * t);
  };
  const MeshSequence walk = sequence_of(walking, icosphere(3), 5);
  const NormalizedSequence n = normalize(walk);
  double mean_area = 0;
  for (int k = 0; k < 5; ++k) {
    const double t = k / 4.0;
    CHECK((n.trajectory.col(k) - Vec3d(10 * t, 1, -4 * t * t)).norm() < 1e-12);
    const Mat3X& x = n.sequence.frames[std::size_t(k)];
    const Eigen::VectorXd w = vertex_areas(x, walk.faces);
    CHECK((x * w).norm() < 1e-13);
    mean_area += w.sum() / 5;
    CHECK(((n.scale * x).colwise() + Vec3d(n.trajectory.col(k)) - walk.frames[std::size_t(k)]).norm() < 1e-11);
  }
  CHECK(mean_area == Approx(1).epsilon(1e-12));
}

TEST_CASE("a sequence with a frame of no area is refused", "[elastic]") {
  MeshSequence s = sequence_of([](const Vec3d& p, double t) -> Vec3d { return (1 - t) * p; }, icosphere(1), 3);
  s.name = "vanishing";
  try {
    normalize(s);
    FAIL("no exception");
  } catch (const UnusableMesh& e) {
    CHECK(std::string(e.what()).find("vanishing: frame 2") != std::string::npos);
  }
}

}  // namespace normalization_test
