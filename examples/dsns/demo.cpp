#include "commands.hpp"
#include "group.hpp"
#include "scene.hpp"

#include <dsns/mesh/sphere_mesh.hpp>
#include <dsns/surface/analytic.hpp>

namespace dsns::program {

namespace {

/// A four-legged body with head and tail that walks on the spot; nose to +x, up is +y.
struct Build {
  double length, girth, leg, neck, pace;
};

LimbedBody quadruped(const Build& b) {
  LimbedBody body;
  body.axes = {b.length, b.girth, 0.85 * b.girth};
  body.pace = b.pace;
  const auto leg = [&](double x, double z, double phase) {
    body.limbs.push_back(
        {Vec3d(x, -0.75, z).normalized(), 16, Vec3d(0.05 * x, -b.leg, 0.12 * z), Vec3d(0.3 * b.leg, 0, 0), phase});
  };
  leg(0.85, 0.55, 0);
  leg(0.85, -0.55, 0.5);
  leg(-0.85, 0.55, 0.5);
  leg(-0.85, -0.55, 0);
  body.limbs.push_back({Vec3d(1, 0.45, 0).normalized(), 14, Vec3d(0.55, b.neck, 0), Vec3d(0.08, 0.1, 0), 0.25});
  body.limbs.push_back({Vec3d(-1, 0.25, 0).normalized(), 40, Vec3d(-0.45, 0.2, 0), Vec3d(0, 0.08, 0.2), 0});
  return body;
}

std::vector<std::string> make_bodies(const std::filesystem::path& folder, int frames, Report& report) {
  // Different builds, paces, triangles and poses of the sphere: nothing corresponds by construction.
  const TriangleMesh fine = icosphere(4), rings = latitude_longitude_sphere(30, 48);
  TriangleMesh turned = icosphere(4);
  turned.vertices = (rotation_exp(Vec3d(0.4, -1.1, 0.6)) * turned.vertices).colwise().normalized();
  const std::vector<std::pair<Build, TriangleMesh>> bodies{{{1.0, 0.50, 0.85, 0.60, 0.0}, fine},
                                                           {{0.9, 0.62, 0.55, 0.35, 0.6}, rings},
                                                           {{1.2, 0.45, 1.00, 0.85, -0.5}, turned}};
  std::vector<std::string> files;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    MeshSequence sequence = sequence_of(quadruped(bodies[i].first), bodies[i].second, frames);
    sequence.duration = 1 + 0.2 * double(i);
    const auto path = folder / message("body_", i + 1, ".glb");
    Scene scene;
    scene.add(std::move(sequence));
    scene.write(path);
    report.wrote(message("body_", i + 1), path);
    files.push_back(path.string());
  }
  return files;
}

}  // namespace

void demo(std::vector<std::string> sources, const std::filesystem::path& folder, const Settings& settings,
          Report& report) {
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  require<FileError>(!failure, "folder '", folder.string(), "' cannot be created: ", failure.message());
  if (sources.empty()) {
    report.say("Three bodies, made from formulas:");
    sources = make_bodies(folder, settings.frames, report);
  }
  require(sources.size() >= 2, "demo: one animation, give at least two or none");
  ProgressLine line;
  std::vector<Body> bodies;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    report.say("");
    bodies.push_back(load_body(sources[i], settings, report, std::ref(line)));
    if (settings.representation == Representation::sampled) continue;
    report.section(message("fit.", i + 1));
    fit(bodies.back(), folder / message("body_", i + 1, "_fitted.glb"), settings, report);
  }
  report.say("\nThe second registered to the first:");
  report.section("register");
  register_two(bodies[0], bodies[1], folder / "registered.glb", {}, {}, settings, report);
  report.say("\nGeodesic from the first to the second:");
  report.section("geodesic");
  GeodesicOptions way;
  way.out = folder / "geodesic.glb";
  geodesic(bodies[0], bodies[1], way, settings, report);
  report.say("\nThe mean of all:");
  report.section("mean");
  mean(Group(std::move(bodies)), {folder / "mean.glb", folder / "overview.glb", {}, {}, {}}, settings, report);
}

}  // namespace dsns::program
