// register, transfer: what is made of two animations.
#include "commands.hpp"
#include "registration.hpp"
#include "scene.hpp"

#include <dsns/mesh/deformation_transfer.hpp>

namespace dsns::program {

void register_two(const Body& a, const Body& b, const std::filesystem::path& out, const std::filesystem::path& own,
                  const LandmarkFile& landmarks, const Settings& settings, Report& report) {
  ProgressLine line;
  const BodyLandmarks marks = landmarks_on(landmarks, a, b);
  const MovingRegistration r = register_bodies(a, b, settings, std::ref(line), marks.used);
  report_registration(r, report);
  report_landmarks(marks, b, r.spatial, report);
  say_units(report);
  if (!own.empty()) {
    write_on_own_mesh(own, a, registered(b, r, a.sphere, settings.frames), settings);
    report.wrote("own_mesh", own);
  }
  if (out.empty()) return own.empty() ? say_not_written(report) : void();
  Scene scene;
  const Mat3X colors = place_colors(a, a.sphere.vertices);
  scene.add(as_represented(a, settings.frames), colors);
  scene.add(as_represented(b, settings.frames), place_colors(a, r.spatial.gamma.inverse(b.sphere.vertices)));
  scene.add(registered(b, r, a.sphere, settings.frames), colors);
  scene.write(out);
  report.say(
      "  Side by side: the first, the second, the second on the first's triangles and clock. Colours correspond.");
  report.wrote("registered", out);
}

void transfer(const Body& a, const Body& b, const std::filesystem::path& out, const std::filesystem::path& own,
              const Settings& settings, Report& report) {
  ProgressLine line;
  const MovingRegistration r = register_bodies(a, b, settings, std::ref(line));
  report_registration(r, report);
  // The first body on the second's triangles, turned as the second stands.
  const int frames = settings.frames;
  const Mat3 turn = r.spatial.rotation.transpose();
  const Mat3X places = r.spatial.gamma.inverse(b.sphere.vertices);
  const auto first_at = [&](double t) -> Mat3X { return turn * positions(a.surface, places, t); };
  const Faces& faces = b.normalized.sequence.faces;
  const DeformationTransfer deformed(first_at(r.temporal.first_time(0)),
                                     positions(b.surface, b.sphere.vertices, r.temporal.second_time(0)), faces);
  std::vector<Mat3X> result;
  for (int k = 0; k < frames; ++k) result.push_back(deformed(first_at(double(k) / (frames - 1))));
  const MeshSequence moved =
      denormalize(result, faces, turn * relative_trajectory(a.normalized, {}, frames), b.normalized.scale,
                  a.normalized.sequence.duration, b.normalized.sequence.name + " as " + a.normalized.sequence.name);
  if (!own.empty()) {
    write_on_own_mesh(own, b, moved, settings);
    report.wrote("own_mesh", own);
  }
  if (out.empty()) return own.empty() ? say_not_written(report) : void();
  Scene scene;
  const Mat3X colors = place_colors(a, places);
  scene.add(as_represented(a, frames), place_colors(a, a.sphere.vertices));
  scene.add(as_represented(b, frames), colors);
  scene.add(moved, colors);
  scene.write(out);
  report.say("  Side by side: the first, the second, the second moving as the first. Colours correspond.");
  report.wrote("transfer", out);
}

}  // namespace dsns::program
