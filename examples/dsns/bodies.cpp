#include "bodies.hpp"

#include <dsns/core/spline.hpp>
#include <dsns/io/gltf_reader.hpp>
#include <dsns/io/frames.hpp>
#include <dsns/io/source_name.hpp>
#include <dsns/mesh/sampling.hpp>
#include <dsns/mesh/spherical_parameterization.hpp>
#include <dsns/nn/fit.hpp>
#include <dsns/surface/sampled.hpp>
#include <dsns/surface/surface_error.hpp>

namespace dsns::program {

Source read_source(const std::string& name, int frames) {
  const SourceName parsed = parse_source(name);
  Source source;
  if (std::filesystem::is_directory(parsed.file)) {
    source.sequence = read_obj_sequence(parsed.file);
    source.notes.push_back(message("read ", source.sequence.frame_count(), " OBJ frames"));
    return source;
  }
  GltfAnimation animation = read_gltf(parsed.file, {parsed.clip, frames});
  source.sequence = std::move(animation.sequence);
  source.clip = animation.clip;
  source.notes.push_back(message("clip '", animation.clip, "'", animation.clip_chosen_by_default ? " (the first)" : "",
                                 ", ", frames, " frames over ", source.sequence.duration, " s"));
  return source;
}

Body load_body(const std::string& name, const Settings& settings, Report& report, const Progress& progress) {
  const Source source = read_source(name, settings.frames);
  const RepairResult repaired = repair(source.sequence);
  NormalizedSequence normalized = normalize(repaired.sequence);
  ParameterizationResult map = spherical_parameterization(normalized.sequence, {}, progress);
  report.say(name + ":");
  for (const auto& note : source.notes) report.say("  " + note);
  for (const auto& action : repaired.actions) report.say("  " + action);
  report.say(message("  mapped to the sphere: ", normalized.sequence.vertex_count(), " vertices, ",
                     map.certificate.flips, " flipped triangles, smallest area ratio ",
                     map.certificate.min_area_ratio));
  const TriangleMesh sphere{map.sphere, normalized.sequence.faces};
  AnyAnimatedSurface surface(SampledSurface(normalized.sequence, map.sphere));
  return {std::move(normalized), sphere, map.certificate, std::move(surface)};
}

FitFigures fit_body(Body& body, const Settings& settings, const Progress& progress) {
  const MeshSequence& sequence = body.normalized.sequence;
  const Mat3X& sphere = body.sphere.vertices;
  const SampledSurface reference(sequence, sphere);
  FitOptions options;
  options.seed = settings.seed;
  options.threads = settings.threads;
  options.seconds = settings.seconds;
  if (settings.steps > 0) options.steps = settings.steps;
  // Half by area of the surface, half by area of the sphere: limbs are small on the sphere, trunks large.
  options.sampler = [&](int n, std::mt19937_64& random) {
    Mat3X s(3, n);
    s.leftCols(n / 2) = sample_faces(sequence, sphere, n / 2, random);
    MeshSequence round = sequence;
    round.frames = {sphere};
    s.rightCols(n - n / 2) = sample_faces(round, sphere, n - n / 2, random);
    return s;
  };
  const FitResult fit = fit_neural_surface(reference, options, progress);

  double radius = 0;
  std::vector<double> times;
  for (int k = 0; k < sequence.frame_count(); ++k) {
    radius = std::max(radius, sequence.frames[std::size_t(k)].colwise().norm().maxCoeff());
    times.push_back(double(k) / std::max(1, sequence.frame_count() - 1));
  }
  std::mt19937_64 held_out(~settings.seed);
  const SurfaceError e = compare(fit.surface, reference, sample_faces(sequence, sphere, 4000, held_out), times, radius);
  body.surface = AnyAnimatedSurface(fit.surface);
  return {e.msd,
          e.rms_distance,
          e.max_distance,
          e.normal_angle_mean_deg,
          fit.summary.parameters,
          fit.summary.steps,
          fit.summary.cpu_seconds};
}

std::vector<Mat3X> frames_of(const AnyAnimatedSurface& surface, const Mat3X& sphere, int frames) {
  std::vector<Mat3X> out;
  for (int k = 0; k < frames; ++k) out.push_back(surface.positions(sphere, double(k) / (frames - 1)));
  return out;
}

MeshSequence denormalize(const std::vector<Mat3X>& frames, const Faces& faces, const Mat3X& trajectory, double scale,
                         double duration, const std::string& name) {
  MeshSequence out;
  out.faces = faces;
  out.duration = duration;
  out.name = name;
  for (std::size_t k = 0; k < frames.size(); ++k)
    out.frames.push_back(scale * (frames[k].colwise() + Vec3d(trajectory.col(Index(k)))));
  return out;
}

Mat3X relative_trajectory(const NormalizedSequence& body, const TimeWarp& warp, int frames) {
  const UniformSpline spline(body.trajectory.cols());
  Mat3X out(3, frames);
  for (int k = 0; k < frames; ++k) {
    const Vec3d place = body.trajectory * spline.weights(warp(double(k) / (frames - 1)));
    out.col(k) = (place - body.trajectory.col(0)) / body.scale;
  }
  return out;
}

}  // namespace dsns::program
