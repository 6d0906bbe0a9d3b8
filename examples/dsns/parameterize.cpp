// parameterize: the map to the sphere, and how good it is.
#include "commands.hpp"
#include "scene.hpp"

#include <dsns/mesh/area_ratios.hpp>

#include <chrono>

namespace dsns::program {

void parameterize(const std::string& name, const std::filesystem::path& out, const Settings& settings, Report& report) {
  const Source source = read_source(name, settings, Still::allowed);
  const RepairResult repaired = repaired_surface(source.sequence, settings);
  const MeshSequence& sequence = repaired.sequence;
  report.say(name + ":");
  for (const auto& note : source.notes) report.say("  " + note);
  for (const auto& action : repaired.actions) report.say("  " + action);
  const auto start = std::chrono::steady_clock::now();
  const ParameterizationResult map = [&] {
    ProgressLine line;
    return spherical_parameterization(sequence, {}, std::ref(line));
  }();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const AreaRatios ratios = area_ratios(sequence, map.sphere);
  report.figure("vertices", "vertices", sequence.vertex_count());
  report.figure("faces", "faces", sequence.faces.cols());
  report.figure("cap_faces", "faces that close holes", sequence.cap_faces);
  report.figure("flips", "flipped triangles", map.certificate.flips);
  report.figure("bijective", "bijective", map.certificate.bijective());
  report.figure("min_area_ratio", "smallest share of the sphere over share of the area", ratios.least);
  report.figure("p01_area_ratio", "1st percentile", ratios.percentile_1);
  report.figure("p99_area_ratio", "99th percentile", ratios.percentile_99);
  report.figure("worst_frame_min_area_ratio", "smallest in any one frame", ratios.worst_frame_least);
  report.figure("seconds", "seconds", seconds);
  if (out.empty()) return;
  require<UnusableMesh>(sequence.frame_count() > 1, name, " is one frame and not an animation to write: leave -o out");

  // The body, and beside it its sphere, as large and in the same colours, turning so that all of it is seen.
  MeshSequence sphere = sequence;
  const Mat3X& first = sequence.frames.front();
  const Vec3d low = first.rowwise().minCoeff(), high = first.rowwise().maxCoeff(),
              extent = (high - low).cwiseMax(1e-300);
  const int frames = sphere.frame_count();
  for (int k = 0; k < frames; ++k) {
    const Mat3 turn = Eigen::AngleAxisd(2 * pi * k / frames, Vec3d::UnitY()).toRotationMatrix();
    sphere.frames[std::size_t(k)] = (0.5 * extent.maxCoeff() * turn * map.sphere).colwise() + Vec3d((low + high) / 2);
  }
  sphere.name += "_sphere";
  const Mat3X colors = position_colors(first);
  Scene scene;
  scene.add(sequence, colors);
  scene.add(std::move(sphere), colors);
  scene.write(out);
  report.wrote("parameterized", out);
}

}  // namespace dsns::program
