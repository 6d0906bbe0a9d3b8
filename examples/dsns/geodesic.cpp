// geodesic: the way between two animations.
#include "commands.hpp"
#include "registration.hpp"
#include "scene.hpp"

#include <dsns/elastic/geodesic.hpp>
#include <dsns/elastic/srnf_inversion.hpp>
#include <dsns/sphere/sphere_map.hpp>
#include <dsns/stats/principal_modes.hpp>

#include <iomanip>
#include <limits>
#include <sstream>

namespace dsns::program {

namespace {

/// Root mean square angle between gamma and the rotation nearest to it, degrees.
double warp_beside_turn(const SphereDiffeomorphism& gamma) {
  const SphereQuadrature q = sphere_quadrature(40);
  const Mat3X y = gamma(q.points);
  const Mat3 turn = nearest_rotation(y * q.weights.asDiagonal() * q.points.transpose());
  return angular_distance(y, turn * q.points, q.weights).rms * 180 / pi;
}

double mix(double a, double b, double tau) { return (1 - tau) * a + tau * b; }

/// The frames of every step of the way.
using Way = std::vector<std::vector<Mat3X>>;

double fraction(int step, int steps) { return steps > 1 ? double(step) / (steps - 1) : 0.5; }

/// Both bodies, registered, at the same times on the first's sphere.
struct Ends {
  std::vector<Mat3X> first, second;
};

Ends ends_at(const Mat3X& sphere, const Body& a, const Body& b, const MovingRegistration& r, int frames) {
  std::vector<Mat3X> first;
  for (int k = 0; k < frames; ++k)
    first.push_back(positions(a.surface, sphere, r.temporal.first_time(double(k) / (frames - 1))));
  return {std::move(first), registered_frames(b, r, sphere, frames)};
}

/// Along the geodesic of curves in the space of the components. What the components leave of either end goes in by its share,
/// so that the ends are the bodies themselves.
Way component_way(const CurveGeodesic& path, const FunctionalPca& pca, const Ends& ends, int steps) {
  const int frames = static_cast<int>(ends.first.size());
  const auto at = [&](const Eigen::MatrixXd& curve, int k) {
    return pca.reconstruct(interpolate(curve, double(k) / (frames - 1)));
  };
  const Eigen::MatrixXd curve_a = path.points(0), curve_b = path.points(1);
  Way way;
  for (int j = 0; j < steps; ++j) {
    const double tau = fraction(j, steps);
    const Eigen::MatrixXd curve = path.points(tau);
    std::vector<Mat3X>& body = way.emplace_back();
    for (int k = 0; k < frames; ++k) {
      const std::size_t i = std::size_t(k);
      body.push_back(at(curve, k) + (1 - tau) * (ends.first[i] - at(curve_a, k)) +
                     tau * (ends.second[i] - at(curve_b, k)));
    }
  }
  return way;
}

/// Along straight lines between square-root normal fields, at every time by itself. What lies above the degree goes in by its
/// share.
Way field_way(const Body& a, const Body& b, const MovingRegistration& r, const Ends& ends, const GeodesicOptions& asked,
              const Settings& settings, Report& report) {
  const int frames = settings.frames, steps = asked.steps;
  const SphereQuadrature q = projection_nodes(asked.degree);
  const SrnfInversion inversion(q, asked.degree);
  const Ends nodes = ends_at(q.points, a, b, r, frames);
  Way way(static_cast<std::size_t>(steps));
  for (auto& body : way) body.resize(std::size_t(frames));
  Eigen::VectorXd squares(frames);
  Eigen::MatrixXd mixed = Eigen::MatrixXd::Zero(frames, steps), left = mixed, open = mixed;
  parallel_for(frames, settings.threads, [&](int k) {
    const std::size_t i = std::size_t(k);
    const HarmonicSurface first = project_on_harmonics(nodes.first[i], q, asked.degree),
                          second = project_on_harmonics(nodes.second[i], q, asked.degree);
    const Mat3X rest_a = ends.first[i] - first.positions(a.sphere.vertices),
                rest_b = ends.second[i] - second.positions(a.sphere.vertices);
    const SrnfPath path(first, second, inversion, q);
    squares[k] = path.distance() * path.distance();
    for (int j = 0; j < steps; ++j) {
      const double tau = fraction(j, steps);
      if (tau == 0 || tau == 1) {
        way[std::size_t(j)][i] = tau == 0 ? ends.first[i] : ends.second[i];
        continue;
      }
      const InversionResult found = path.at(tau);
      mixed(k, j) = found.start_residual;
      left(k, j) = found.residual;
      open(k, j) = found.converged ? 0 : 1;
      way[std::size_t(j)][i] = found.surface.positions(a.sphere.vertices) + (1 - tau) * rest_a + tau * rest_b;
    }
  });
  report.figure("srnf.distance", "distance of the square-root normal fields, rms over time", std::sqrt(squares.mean()));
  report.figure("srnf.start_residual", "of the fields between, what the mixture of the ends leaves, largest",
                mixed.maxCoeff());
  report.figure("srnf.residual", "  and what the surface found leaves", left.maxCoeff());
  report.figure("srnf.not_converged", "  inversions that ran out of steps", static_cast<int>(open.sum()));
  if (left.maxCoeff() > 0.05)
    report.say("  Note: some fields between are far from those of a surface; look at them, or take --path components.");
  return way;
}

/// Where the ends stand in different poses the steps between are thinner and shorter.
std::vector<double> areas_kept(const Way& way, const Ends& ends, const Faces& faces) {
  const int steps = static_cast<int>(way.size());
  std::vector<double> kept(way.size(), std::numeric_limits<double>::infinity());
  for (std::size_t k = 0; k < ends.first.size(); ++k) {
    const double first = area({ends.first[k], faces}), last = area({ends.second[k], faces});
    for (int j = 0; j < steps; ++j) {
      double& least = kept[std::size_t(j)];
      least = std::min(least, area({way[std::size_t(j)][k], faces}) / mix(first, last, fraction(j, steps)));
    }
  }
  return kept;
}

}  // namespace

void geodesic(const Body& a, const Body& b, const GeodesicOptions& asked, const Settings& settings, Report& report) {
  ProgressLine line;
  const RegistrationOptions options = registration_options(a, settings);
  const bool registered_ends = asked.ends == GeodesicEnds::registered;
  const MovingRegistration r = registered_ends ? register_bodies(a, b, settings, std::ref(line)) : MovingRegistration{};
  const std::vector<SurfaceSamples> samples{sample(a.surface, {}, a.sphere.vertices, options),
                                            sample(b.surface, r.spatial, a.sphere.vertices, options)};
  const FunctionalPca pca = joint_pca(samples, a.sphere, options);
  const CurveGeodesic path(shape_curve(samples[0], pca), shape_curve(samples[1], pca), r.temporal.warp);
  if (registered_ends) report_registration(r, report);
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
  if (asked.out.empty() && asked.each.empty()) return say_not_written(report, "-o FILE.glb or --each FOLDER");

  const int frames = settings.frames, steps = asked.steps;
  const Ends ends = ends_at(a.sphere.vertices, a, b, r, frames);
  const Way way = asked.path == GeodesicPath::components ? component_way(path, pca, ends, steps)
                                                         : field_way(a, b, r, ends, asked, settings, report);
  report.figure(
      "area_kept", "area of each step, of what the ends' areas mix to, smallest over the frames",
      areas_kept(way, ends, a.sphere.faces.leftCols(a.sphere.faces.cols() - a.normalized.sequence.cap_faces)));
  const Mat3X colors = place_colors(a, a.sphere.vertices);
  const Mat3X way_a = relative_trajectory(a.normalized, {}, frames);
  const Mat3X way_b = r.spatial.rotation * relative_trajectory(b.normalized, r.temporal.warp, frames);
  if (!asked.each.empty()) std::filesystem::create_directories(asked.each);
  Scene all;
  for (int j = 0; j < steps; ++j) {
    const double tau = fraction(j, steps);
    MeshSequence step =
        denormalize(way[std::size_t(j)], a.sphere.faces, (1 - tau) * way_a + tau * way_b,
                    mix(a.normalized.scale, b.normalized.scale, tau),
                    mix(a.normalized.sequence.duration, b.normalized.sequence.duration, tau), "geodesic");
    if (!asked.each.empty()) {
      std::ostringstream name;
      name << "step_" << std::setw(2) << std::setfill('0') << j + 1 << ".glb";
      Scene alone;
      alone.add(step, colors);
      alone.write(asked.each / name.str());
    }
    all.add(std::move(step), colors);
  }
  if (!asked.each.empty()) report.wrote("each", asked.each);
  if (asked.out.empty()) return;
  all.write(asked.out);
  report.say(message("  ", steps, " steps side by side: the first body, the way between, the second",
                     registered_ends ? " registered to it." : " through its sphere map."));
  report.wrote("geodesic", asked.out);
}

}  // namespace dsns::program
