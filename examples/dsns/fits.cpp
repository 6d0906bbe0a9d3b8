#include "fits.hpp"

#include "checkpoint.hpp"

#include <dsns/mesh/sampling.hpp>
#include <dsns/nn/closed_form.hpp>
#include <dsns/surface/sampled.hpp>

#include <chrono>
#include <numeric>

namespace dsns::program {

namespace {

/// Half by area of the surface, half by area of the sphere: limbs are small on the sphere, trunks large. The second half sees
/// caps too: they count nowhere, but a function that is free there disturbs every projection on harmonics.
auto sampler(const MeshSequence& sequence, const Mat3X& sphere) {
  return [&sequence, &sphere](int n, std::mt19937_64& random) {
    Mat3X s(3, n);
    s.leftCols(n / 2) = sample_faces(sequence, sphere, n / 2, random);
    MeshSequence round = sequence;
    round.frames = {sphere};
    round.cap_faces = 0;
    s.rightCols(n - n / 2) = sample_faces(round, sphere, n - n / 2, random);
    return s;
  };
}

/// What both kinds of fit are told.
template <class Options>
Options told(Options options, const MeshSequence& sequence, const Mat3X& sphere, std::vector<double> times,
             const CheckpointFile& checkpoint, const Settings& settings) {
  constexpr int endless = 100000000;  // steps, which a budget of seconds ends
  options.frame_times = std::move(times);
  options.sampler = sampler(sequence, sphere);
  options.seed = settings.seed;
  options.threads = settings.threads;
  options.seconds = settings.seconds;
  options.target_msd = settings.target_msd;
  options.checkpoint = checkpoint.options();
  if (settings.steps > 0)
    options.steps = settings.steps;
  else if (settings.seconds > 0)
    options.steps = endless;
  return options;
}

/// Twice the functions, where an error or a time says when it is enough.
SeparableFitOptions fast_options(const Settings& settings) {
  SeparableFitOptions options = closed_form_fit();
  if (settings.seconds > 0 || settings.target_msd > 0) {
    options.radial.functions *= 2;
    options.points *= 2;
  }
  return options;
}

FitOptions network_options(Preset preset) {
  if (preset == Preset::paper) return paper_fit();
  FitOptions options;
  options.batch = 1024;
  options.steps = 12000;
  options.learning_rate = 1e-2;
  return options;
}

std::string word(FitStop stop) {
  switch (stop) {
    case FitStop::seconds:
      return "seconds";
    case FitStop::target_msd:
      return "target";
    case FitStop::functions:
      return "functions";
    case FitStop::steps:
      break;
  }
  return "steps";
}

}  // namespace

std::vector<int> spread_frames(int of, int count) {
  std::vector<int> frames(static_cast<std::size_t>(std::min(of, count)));
  const auto last = std::max(1, int(frames.size()) - 1);
  for (int k = 0; k < int(frames.size()); ++k) frames[std::size_t(k)] = (k * (of - 1) + last / 2) / last;
  return frames;
}

MeshSequence frames_alone(const Body& body, const std::vector<int>& frames) {
  MeshSequence part = body.normalized.sequence;
  part.frames.clear();
  for (const int k : frames) part.frames.push_back(body.normalized.sequence.frames[std::size_t(k)]);
  return part;
}

std::vector<double> frame_times(const Body& body, const std::vector<int>& frames) {
  const std::vector<double> all = equidistant_times(body.normalized.sequence.frame_count());
  std::vector<double> times;
  for (const int k : frames) times.push_back(all[std::size_t(k)]);
  return times;
}

double unit_of(const Body& body) {
  double radius = 0;
  for (const Mat3X& frame : body.normalized.sequence.frames)
    radius = std::max(radius, frame.colwise().norm().maxCoeff());
  return radius;
}

Mat3X held_out_points(const Body& body, const Settings& settings) {
  std::mt19937_64 random(~settings.seed);
  return sample_faces(body.normalized.sequence, body.sphere.vertices, 4000, random);
}

Fitted fit_frames(const Body& body, const std::vector<int>& frames, const Settings& settings,
                  const Progress& progress) {
  const MeshSequence sequence = frames_alone(body, frames);
  const Mat3X& sphere = body.sphere.vertices;
  const std::vector<double> times = frame_times(body, frames);
  const SampledSurface reference(sequence, sphere, times);
  const double unit = unit_of(body);
  const auto start = std::chrono::steady_clock::now();
  FitFigures f;
  f.frames = static_cast<int>(frames.size());
  const auto finished = [&](const auto& surface, const FitSummary& training) {
    f.wall_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    f.cpu_seconds = training.cpu_seconds;
    f.parameters = training.parameters;
    f.steps = training.steps;
    f.stop = word(training.stopped);
    f.error = compare(surface, reference, held_out_points(body, settings), times, unit);
    return Fitted{surface, f};
  };
  // The fits' own unit is the ball of their samples, which is all but this one.
  const CheckpointFile checkpoint(settings);
  if (settings.preset == Preset::fast) {
    const SeparableFitResult fit = fit_closed_form(
        reference, told(fast_options(settings), sequence, sphere, times, checkpoint, settings), progress);
    const double square = std::pow(fit.surface.scale() / unit, 2);
    f.separable = {fit.summary.modes, fit.summary.functions, square * fit.summary.mode_residual,
                   square * fit.summary.harmonic_residual, square * fit.summary.radial_residual};
    return finished(fit.surface, fit.summary.training);
  }
  const FitResult fit = fit_neural_surface(
      reference, told(network_options(settings.preset), sequence, sphere, times, checkpoint, settings), progress);
  return finished(fit.surface, fit.summary);
}

Fitted fit_body(Body& body, const Settings& settings, const Progress& progress) {
  const int all = body.normalized.sequence.frame_count();
  Fitted fit = fit_frames(body, spread_frames(all, all), settings, progress);
  body.surface = std::visit([](const auto& surface) { return AnyAnimatedSurface(surface); }, fit.surface);
  return fit;
}

void report_fit(const FitFigures& f, Report& report) {
  const SampledSurfaceError& e = f.error;
  report.figure("frames", "frames", f.frames);
  report.figure("msd_heldout", "mean squared coordinate error, held out", e.msd);
  report.figure("rms_distance_heldout", "RMS distance, held out", e.rms_distance);
  report.figure("max_distance_heldout", "largest distance, held out", e.max_distance);
  report.figure("normal_angle_mean_deg", "angle to the flat faces' normals, mean", e.normal_angle_mean_deg);
  report.figure("normal_angle_median_deg", "  median", e.normal_angle_median_deg);
  report.figure("smooth_normal_angle_mean_deg", "angle to interpolated normals, mean", e.smooth_normal_angle_mean_deg);
  report.figure("smooth_normal_angle_median_deg", "  median", e.smooth_normal_angle_median_deg);
  report.figure("mesh_normal_angle_mean_deg", "between these two on the mesh, mean", e.mesh_normal_angle_mean_deg);
  report.figure("mesh_normal_angle_median_deg", "  median", e.mesh_normal_angle_median_deg);
  if (f.separable) {
    report.figure("modes", "temporal modes", f.separable->modes);
    report.figure("mode_residual", "mean squared error they leave", f.separable->mode_residual);
    report.figure("harmonic_residual", "and with the harmonics, at the samples", f.separable->harmonic_residual);
    report.figure("functions", "local functions", f.separable->functions);
    report.figure("radial_residual", "and with these", f.separable->radial_residual);
  } else {
    report.figure("parameters", "parameters of the network", f.parameters);
    report.figure("steps", "steps", f.steps);
  }
  report.figure("stop", "ended by", f.stop);
  report.figure("wall_seconds", "seconds of the fit", f.wall_seconds);
  report.figure("cpu_seconds", "CPU-seconds", f.cpu_seconds);
}

void say_fit_units(Report& report) {
  report.say(
      "  Lengths: the smallest ball around the centroid that holds all frames, root motion removed, has radius 1.");
  report.say("  Angles in degrees.");
}

void say_preset(const Settings& settings, Report& report) {
  if (settings.preset != Preset::paper) return;
  const FitOptions o = paper_fit();
  const MlpShape shape{static_cast<int>(o.encoding.features()), o.width, o.blocks, 3, o.activation};
  const double steps = settings.steps > 0 ? settings.steps : o.steps;
  // Two operations a parameter and sample forward, four backward.
  report.say(message("The paper's network has ", shape.parameter_count(), " parameters; its ", steps, " steps of ",
                     o.batch, " samples are ", 6 * double(shape.parameter_count()) * steps * o.batch,
                     " floating-point operations: weeks on a processor. --seconds ends it after the step it is in."));
}

std::string word(Preset preset) {
  switch (preset) {
    case Preset::general:
      return "general";
    case Preset::paper:
      return "paper";
    case Preset::fast:
      break;
  }
  return "fast";
}

}  // namespace dsns::program
