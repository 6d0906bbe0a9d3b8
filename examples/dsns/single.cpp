// inspect and fit: what is said of one animation.
#include "checkpoint.hpp"
#include "commands.hpp"
#include "scene.hpp"

#include <dsns/io/frames.hpp>
#include <dsns/io/gltf_reader.hpp>
#include <dsns/io/source_name.hpp>
#include <dsns/mesh/diagnosis.hpp>

namespace dsns::program {

void inspect(const std::string& name, const Settings& settings, Report& report) {
  if (lower_extension(parse_source(name).file) == ".dsns") return inspect_surface(parse_source(name).file, report);
  const Source source = read_source(name, settings, Still::allowed);
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
  std::string reason;
  try {
    d = diagnose_welded(raw);
    actions = repaired_surface(raw, settings).actions;
  } catch (const UnusableMesh& unusable) {
    reason = unusable.what();
  }
  report.figure("vertices", "vertices, welded", d.vertices);
  report.figure("faces", "faces, welded", d.faces);
  report.figure("dropped_faces", "degenerate and duplicate faces", file.faces - d.faces);
  report.figure("components", "components, welded", d.components);
  report.figure("euler_characteristic", "Euler characteristic", d.euler_characteristic);
  if (d.genus) report.figure("genus", "genus", *d.genus);
  report.figure("boundary_loops", "boundary loops", d.boundary_loops);
  report.figure("boundary_edges", "boundary edges", d.boundary_edges);
  report.figure("nonmanifold_edges", "edges with more than two faces", d.nonmanifold_edges);
  report.figure("nonmanifold_vertices", "pinched vertices", d.nonmanifold_vertices);
  report.figure("consistently_oriented", "faces agree about their sides", d.consistently_oriented);
  report.figure("closed", "closed", d.closed);
  report.figure("usable", "usable", reason.empty());
  if (!reason.empty()) report.figure("reason", "reason", reason);
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
  if (lower_extension(out) == ".dsns") {
    write_surface(out, f.surface, body);
    report.wrote("fitted", out);
    return;
  }
  const MeshSequence& sequence = body.normalized.sequence;
  Scene scene;
  scene.add(denormalize(frames_of(body.surface, body.sphere.vertices, sequence.frame_count()), sequence.faces,
                        relative_trajectory(body.normalized, {}, sequence.frame_count()), body.normalized.scale,
                        sequence.duration, sequence.name));
  scene.write(out);
  report.wrote("fitted", out);
}

}  // namespace dsns::program
