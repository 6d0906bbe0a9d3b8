// evaluate track: an animation whose frames are given triangles of their own, and tracked as if they were scans.
#include "evaluations.hpp"
#include "scene.hpp"

#include <dsns/mesh/isotropic_remesh.hpp>
#include <dsns/stats/frame_registration.hpp>

namespace dsns::program {

void evaluate_track(const std::string& name, const std::filesystem::path& out, const TrackEvaluation& evaluation,
                    const Settings& settings, Report& report) {
  const MeshSequence given =
      normalize(repaired_surface(read_source(name, settings).sequence, settings).sequence).sequence;
  std::vector<MeshSequence> frames;
  MeshSequence truth;
  for (int k = 0; k < given.frame_count(); ++k) {
    RemeshOptions options;
    // Another number of vertices in each frame, so that no two are alike.
    options.vertices = Index(evaluation.density * double(given.vertex_count()) * (0.95 + 0.01 * ((k * 7) % 11)));
    const Remeshing mesh = isotropic_remesh(given.frame(k), options);
    MeshSequence all = remeshed(given, mesh), one = all;
    one.frames = {all.frames[std::size_t(k)]};
    frames.push_back(std::move(one));
    if (k == 0) truth = std::move(all);
  }
  FrameRegistrationOptions options;
  options.spatial.threads = settings.threads;
  options.views = settings.views;
  FrameRegistration tracked = [&] {
    ProgressLine line;
    return register_frames(frames, given.duration, options, std::ref(line));
  }();
  report.say(name + ":");
  report.say(
      "  frame: misses in % of the diameter, median, 90th percentile, root mean square; energy left of the squared "
      "norm");
  for (int k = 1; k < truth.frame_count(); ++k) {
    const Mat3X& x = truth.frames[std::size_t(k)];
    const Vec3d centre = (x.rowwise().minCoeff() + x.rowwise().maxCoeff()) / 2;
    const double diameter = 2 * (x.colwise() - centre).colwise().norm().maxCoeff();
    Eigen::VectorXd missed =
        100 / diameter * (tracked.sequence.frames[std::size_t(k)] - x).colwise().norm().transpose();
    std::sort(missed.begin(), missed.end());
    const SpatialSummary& s = tracked.frames[std::size_t(k) - 1];
    const double median = missed[missed.size() / 2], p90 = missed[missed.size() * 9 / 10],
                 rms = std::sqrt(missed.squaredNorm() / double(missed.size())), left = s.energy_after / s.norm;
    report.row("rows");
    report.note("frame", std::int64_t(k));
    report.note("median_percent", median);
    report.note("p90_percent", p90);
    report.note("rms_percent", rms);
    report.note("energy_left", left);
    report.note("min_jacobian", s.min_jacobian);
    report.say(message("  ", k, ": ", median, ", ", p90, ", ", rms, "; ", left));
  }
  report.section("");
  if (out.empty()) return;
  Scene scene;
  const Mat3X colors = position_colors(truth.frames.front());
  scene.add(std::move(truth), colors);
  scene.add(std::move(tracked.sequence), colors);
  scene.write(out);
  report.say("  Side by side: the truth and what was tracked, on the first frame's triangles.");
  report.wrote("tracked", out);
}

}  // namespace dsns::program
