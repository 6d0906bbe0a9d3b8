// What the subcommands that bring bodies into correspondence share.
#include "registration.hpp"

#include <dsns/mesh/sphere_mask.hpp>

namespace dsns::program {

RegistrationOptions registration_options(const Body& first, const Settings& settings) {
  RegistrationOptions options;
  if (first.normalized.sequence.cap_faces > 0)
    options.spatial.mask = SphereMask(first.normalized.sequence, first.sphere.vertices);
  options.spatial.search = settings.search;
  options.spatial.threads = settings.threads;
  options.snapshots = settings.frames;
  options.temporal.alignment = settings.alignment;
  return options;
}

void report_registration(const MovingRegistration& r, Report& report) {
  const SpatialSummary& s = r.spatial.summary;
  const TemporalSummary& t = r.temporal.summary;
  report.figure("spatial.energy_before", "spatial energy before", s.energy_before);
  report.figure("spatial.energy_after", "spatial energy after", s.energy_after);
  report.figure("spatial.norm", "squared norm of the first's field", s.norm);
  report.figure("spatial.min_jacobian", "smallest Jacobian of the sphere map", s.min_jacobian);
  report.figure("spatial.rotation_deg", "rotation of the body, degrees", rotation_angle(r.spatial.rotation) * 180 / pi);
  report.figure("spatial.steps", "spatial steps", s.steps);
  report.figure("spatial.stop", "stopped because", s.stop);
  report.figure("temporal.energy_before", "temporal energy before", t.energy_before);
  report.figure("temporal.energy_after", "temporal energy after", t.energy_after);
  report.figure("temporal.min_slope", "smallest slope of the time warp", t.min_slope);
  const TemporalResult& time = r.temporal;
  if (time.first.length != 1) report.figure("temporal.first_end", "the first is met up to", time.first.length);
  if (time.second.begin != 0) report.figure("temporal.second_begin", "the second is met from", time.second.begin);
  if (time.second.length != 1) report.figure("temporal.second_passes", "so much of the second", time.second.length);
  report.figure("temporal.stop", "stopped because", t.stop);
  if (!t.advice.empty()) report.figure("temporal.advice", "advice", t.advice);
  if (r.rounds > 0) {
    report.figure("rounds", "rounds of space and time", r.rounds);
    report.figure("clock_moved", "  the clock moved in the last, L2 in shares of the clip", r.clock_moved);
  }
  // Where the figures say that the result is doubtful, so do we.
  const auto note = [&](const std::string& text) { report.say("  Note: " + text); };
  if (s.energy_after > 0.3 * s.norm)
    note("little of the bodies' shape corresponds; look at the colours before you use the result.");
  if (t.min_slope < 1.02 * TemporalOptions{}.min_slope)
    note("the clocks hardly agree (the slope is at its limit); do both clips start at the same phase?");
}

void say_not_written(Report& report, const std::string& option) {
  report.say("  No animation was written: give " + option + " for one.");
}

void say_units(Report& report) {
  report.say("  Root motion is removed first, and the mean area of every body is 1: energies are in these units.");
}

MeshSequence as_represented(const Body& body, int frames) {
  const auto& n = body.normalized;
  return denormalize(frames_of(body.surface, body.sphere.vertices, frames), n.sequence.faces,
                     relative_trajectory(n, {}, frames), n.scale, n.sequence.duration, n.sequence.name);
}

std::vector<Mat3X> registered_frames(const Body& body, const MovingRegistration& r, const Mat3X& sphere, int frames) {
  const Mat3X y = r.spatial.gamma(sphere);
  std::vector<Mat3X> out;
  for (int k = 0; k < frames; ++k)
    out.push_back(r.spatial.rotation * positions(body.surface, y, r.temporal.second_time(double(k) / (frames - 1))));
  return out;
}

Mat3X registered_trajectory(const Body& body, const MovingRegistration& r, int frames) {
  const NormalizedSequence& n = body.normalized;
  const CubicSpline spline(n.trajectory.cols());
  const Vec3d pass = n.trajectory.rightCols<1>() - n.trajectory.leftCols<1>();
  Mat3X out(3, frames);
  for (int k = 0; k < frames; ++k) {
    const double z = r.temporal.warp(double(k) / (frames - 1)), t = r.temporal.second(z);
    const double passes = std::round(r.temporal.second.begin + r.temporal.second.length * z - t);
    out.col(k) = n.trajectory * spline.weights(t) + passes * pass;
  }
  return r.spatial.rotation * (out.colwise() - Vec3d(out.col(0))) / n.scale;
}

MeshSequence registered(const Body& body, const MovingRegistration& r, const TriangleMesh& sphere, int frames) {
  return denormalize(registered_frames(body, r, sphere.vertices, frames), sphere.faces,
                     registered_trajectory(body, r, frames), body.normalized.scale,
                     r.temporal.second.length * body.normalized.sequence.duration, body.normalized.sequence.name);
}

MovingRegistration register_bodies(const Body& first, const Body& second, const Settings& settings,
                                   const Progress& progress, const SphereLandmarks& landmarks) {
  RegistrationOptions options = registration_options(first, settings);
  options.spatial.landmarks = landmarks;
  return register_moving(first.surface, second.surface, first.sphere, options, progress);
}

}  // namespace dsns::program
