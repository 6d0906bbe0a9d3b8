#include "catch.hpp"

#include <dsns/mesh/sphere_mesh.hpp>
#include <dsns/stats/frame_registration.hpp>
#include <dsns/surface/bodies.hpp>

namespace frame_registration_test {

using namespace dsns;

TEST_CASE("frames on triangles of their own become one moving mesh", "[stats]") {
  LimbedBody body;
  body.axes = {1, 0.7, 0.6};
  body.limbs = {{Vec3d(0.8, -0.7, -0.5).normalized(), 6, Vec3d(0.3, -0.9, -0.2), Vec3d(0, 0.3, 0.2)},
                {Vec3d(-0.8, 0.6, -0.5).normalized(), 6, Vec3d(-0.2, 0.6, -0.7), Vec3d(0.3, 0, 0.1)},
                {Vec3d(0.6, 0, 0.9).normalized(), 7, Vec3d(0.4, 0, 0.8), Vec3d(0.2, 0.2, 0)}};
  std::vector<TriangleMesh> meshes;
  const TriangleMesh sphere = icosphere(3);
  constexpr int frames = 3;
  for (int k = 0; k < frames; ++k) {
    const Mat3X s = rotation_exp(k * Vec3d(1.1, -0.7, 0.4)) * sphere.vertices;
    meshes.push_back({positions(body, s, 0.1 * k), sphere.faces});
  }
  FrameRegistrationOptions options;
  options.views = 0;  // the other way is tested where both are
  options.spatial.latitudes = 14;
  options.spatial.refinement = {{10, 12, 0.0, 0.5}};
  const FrameRegistration r = register_frames(meshes, 2.0, options);
  REQUIRE(r.sequence.frame_count() == frames);
  CHECK(r.sequence.faces == sphere.faces);
  CHECK(r.sequence.frames[0] == meshes[0].vertices);
  CHECK(r.frames.size() == frames - 1);
  const Mat3X truth = positions(body, sphere.vertices, 0.1 * (frames - 1));
  const auto rms = [&](const Mat3X& x) { return std::sqrt((x - truth).squaredNorm() / double(truth.cols())); };
  const double size = (truth.rowwise().maxCoeff() - truth.rowwise().minCoeff()).norm();
  const double missed = rms(r.sequence.frames.back());
  INFO("missed by " << missed / size << " of the size");
  CHECK(missed < 0.02 * size);
  CHECK(missed < 0.1 * rms(meshes.back().vertices));  // whose vertices of equal number lie elsewhere
  CHECK_THROWS_AS(register_frames(std::vector<TriangleMesh>(), 1), InvalidArgument);
}

}  // namespace frame_registration_test
