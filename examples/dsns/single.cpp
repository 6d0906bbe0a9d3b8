// inspect and fit: what is said of one animation.
#include "commands.hpp"
#include "scene.hpp"

#include <dsns/io/gltf_reader.hpp>
#include <dsns/io/source_name.hpp>
#include <dsns/mesh/diagnosis.hpp>

namespace dsns::program {

void inspect(const std::string& name, const Settings& settings, Report& report) {
  const Source source = read_source(name, settings.frames);
  const MeshSequence& raw = source.sequence;
  report.say(name + ":");
  for (const auto& note : source.notes) report.say("  " + note);
  std::vector<std::string> clips;
  if (!source.clip.empty())
    for (const auto& clip : gltf_clips(parse_source(name).file)) clips.push_back(clip.name);
  const MeshDiagnosis file = diagnose(raw.faces, raw.vertex_count());
  report.figure("file.vertices", "vertices in the file", file.vertices);
  report.figure("file.components", "components in the file, unwelded", file.components);
  if (!clips.empty()) report.figure("clips", "clips", clips);
  report.figure("frames", "frames", raw.frame_count());
  report.figure("duration", "duration, seconds", raw.duration);
  std::vector<std::string> actions;
  MeshDiagnosis d = file;
  try {
    const RepairResult repaired = repair(raw);
    d = repaired.welded;
    actions = repaired.actions;
    report.figure("usable", "usable", true);
    report.figure("vertices_used", "vertices after repair", repaired.after.vertices);
    report.figure("faces_used", "faces after repair", repaired.after.faces);
  } catch (const UnusableMesh& reason) {
    report.figure("usable", "usable", false);
    report.figure("reason", "reason", std::string(reason.what()));
  }
  report.figure("vertices", "vertices, welded", d.vertices);
  report.figure("faces", "faces, welded", d.faces);
  report.figure("components", "components, welded", d.components);
  report.figure("euler_characteristic", "Euler characteristic", d.euler_characteristic);
  report.figure("boundary_loops", "boundary loops", d.boundary_loops);
  report.figure("closed", "closed", d.closed);
  if (!actions.empty()) report.figure("actions", "what dsns does to it", actions);
}

void fit(Body& body, const std::filesystem::path& out, const Settings& settings, Report& report) {
  ProgressLine line;
  const FitFigures f = fit_body(body, settings, std::ref(line));
  report.figure("msd_heldout", "mean squared coordinate error, held out", f.msd);
  report.figure("rms_distance_heldout", "RMS distance, held out", f.rms_distance);
  report.figure("max_distance_heldout", "largest distance, held out", f.max_distance);
  report.figure("normal_angle_mean_deg", "mean angle of normals, degrees", f.normal_angle_mean_deg);
  report.figure("parameters", "parameters", f.parameters);
  report.figure("steps", "steps", f.steps);
  report.figure("cpu_seconds", "CPU-seconds", f.cpu_seconds);
  report.say(
      "  Lengths: the smallest ball around the centroid that holds all frames, root motion removed, has radius 1.");
  if (out.empty()) return;
  const MeshSequence& sequence = body.normalized.sequence;
  Scene scene;
  scene.add(denormalize(frames_of(body.surface, body.sphere.vertices, sequence.frame_count()), sequence.faces,
                        relative_trajectory(body.normalized, {}, sequence.frame_count()), body.normalized.scale,
                        sequence.duration, sequence.name));
  scene.write(out);
  report.wrote("fitted", out);
}

}  // namespace dsns::program
