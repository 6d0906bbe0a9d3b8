// register, geodesic, transfer: what is said of two animations.
#include "commands.hpp"
#include "registration.hpp"
#include "scene.hpp"

#include <dsns/mesh/deformation_transfer.hpp>
#include <dsns/mesh/sphere_mask.hpp>
#include <dsns/sphere/sphere_map.hpp>
#include <dsns/stats/moving_mean.hpp>
#include <dsns/stats/principal_modes.hpp>

#include <numeric>

namespace dsns::program {

namespace {

/// Frames of the body on another's sphere mesh and clock. The sphere's points are moved once for all times.
std::vector<Mat3X> registered_frames(const Body& body, const MovingRegistration& r, const Mat3X& sphere, int frames) {
  const Mat3X y = r.spatial.gamma(sphere);
  std::vector<Mat3X> out;
  for (int k = 0; k < frames; ++k)
    out.push_back(r.spatial.rotation * positions(body.surface, y, r.temporal.second_time(double(k) / (frames - 1))));
  return out;
}

/// Where the body's root goes along the registered times, from its place at the first of them; another pass goes on where the
/// last ended.
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

/// Root mean square angle between gamma and the rotation nearest to it, degrees.
double warp_beside_turn(const SphereDiffeomorphism& gamma) {
  const SphereQuadrature q = sphere_quadrature(40);
  const Mat3X y = gamma(q.points);
  const Mat3 turn = nearest_rotation(y * q.weights.asDiagonal() * q.points.transpose());
  return angular_distance(y, turn * q.points, q.weights).rms * 180 / pi;
}

double mix(double a, double b, double tau) { return (1 - tau) * a + tau * b; }

}  // namespace

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

MeshSequence registered(const Body& body, const MovingRegistration& r, const TriangleMesh& sphere, int frames) {
  return denormalize(registered_frames(body, r, sphere.vertices, frames), sphere.faces,
                     registered_trajectory(body, r, frames), body.normalized.scale,
                     r.temporal.second.length * body.normalized.sequence.duration, body.normalized.sequence.name);
}

MovingRegistration register_bodies(const Body& first, const Body& second, const Settings& settings,
                                   const Progress& progress) {
  return register_moving(first.surface, second.surface, first.sphere, registration_options(first, settings), progress);
}

void register_two(const Body& a, const Body& b, const std::filesystem::path& out, const std::filesystem::path& own,
                  const Settings& settings, Report& report) {
  ProgressLine line;
  const MovingRegistration r = register_bodies(a, b, settings, std::ref(line));
  report_registration(r, report);
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

void geodesic(const Body& a, const Body& b, const std::filesystem::path& out, int steps, GeodesicEnds ends,
              const Settings& settings, Report& report) {
  ProgressLine line;
  const RegistrationOptions options = registration_options(a, settings);
  const MovingRegistration r =
      ends == GeodesicEnds::registered ? register_bodies(a, b, settings, std::ref(line)) : MovingRegistration{};
  const std::vector<SurfaceSamples> samples{sample(a.surface, {}, a.sphere.vertices, options),
                                            sample(b.surface, r.spatial, a.sphere.vertices, options)};
  const FunctionalPca pca = joint_pca(samples, a.sphere, options);
  const CurveGeodesic path(shape_curve(samples[0], pca), shape_curve(samples[1], pca), r.temporal.warp);
  if (ends == GeodesicEnds::registered) report_registration(r, report);
  report.figure("components", "principal components", pca.modes());
  report.figure("components_residual", "mean squared error they leave", pca.residual());
  report.figure("distance", "distance", path.distance());
  report.figure("distance_start", "  of the first poses", path.start_distance());
  report.figure("distance_motion", "  of the motions, pace taken out", path.motion_distance());
  const TimeGrid grid = time_grid();
  report.figure("pace_angle_deg", "what pace takes: angle of the time warp to none, degrees",
                std::sqrt(warp_tangent(r.temporal.warp, grid).cwiseAbs2().dot(grid.weights)) * 180 / pi);
  report.figure("sphere_warp_deg", "what the sphere map takes besides a turn, degrees rms",
                warp_beside_turn(r.spatial.gamma));
  say_units(report);
  if (out.empty()) return say_not_written(report);

  const int frames = settings.frames;
  const Mat3X colors = place_colors(a, a.sphere.vertices);
  // What the components leave of either end goes in by its share, so that the ends are the bodies themselves.
  std::vector<Mat3X> rest_a = frames_of(a.surface, a.sphere.vertices, frames);
  std::vector<Mat3X> rest_b = registered_frames(b, r, a.sphere.vertices, frames);
  const auto remove_components = [&](std::vector<Mat3X>& rest, const Eigen::MatrixXd& curve) {
    for (int k = 0; k < frames; ++k)
      rest[std::size_t(k)] -= pca.reconstruct(interpolate(curve, double(k) / (frames - 1)));
  };
  remove_components(rest_a, path.points(0));
  remove_components(rest_b, path.points(1));
  const Mat3X way_a = relative_trajectory(a.normalized, {}, frames);
  const Mat3X way_b = r.spatial.rotation * relative_trajectory(b.normalized, r.temporal.warp, frames);
  Scene scene;
  for (int j = 0; j < steps; ++j) {
    const double tau = steps > 1 ? double(j) / (steps - 1) : 0.5;
    const Eigen::MatrixXd curve = path.points(tau);
    std::vector<Mat3X> body;
    for (int k = 0; k < frames; ++k)
      body.push_back(pca.reconstruct(interpolate(curve, double(k) / (frames - 1))) +
                     (1 - tau) * rest_a[std::size_t(k)] + tau * rest_b[std::size_t(k)]);
    scene.add(denormalize(body, a.sphere.faces, (1 - tau) * way_a + tau * way_b,
                          mix(a.normalized.scale, b.normalized.scale, tau),
                          mix(a.normalized.sequence.duration, b.normalized.sequence.duration, tau), "geodesic"),
              colors);
  }
  scene.write(out);
  report.say(message("  ", steps, " steps side by side: the first body, the way between, the second",
                     ends == GeodesicEnds::registered ? " registered to it." : " through its sphere map."));
  report.wrote("geodesic", out);
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
