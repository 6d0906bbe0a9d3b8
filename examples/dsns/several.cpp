// mean: what animations have in common.
#include "commands.hpp"
#include "registration.hpp"
#include "scene.hpp"

#include <dsns/stats/moving_mean.hpp>

namespace dsns::program {

MeshSequence BodiesMean::animation(const Eigen::MatrixXd& points, const Faces& faces, const std::string& name) const {
  return denormalize(moving.frames(points, static_cast<int>(way.cols())), faces, way, scale, duration, name);
}

BodiesMean mean_of_bodies(const std::vector<Body>& bodies, const Settings& settings, Report& report) {
  ProgressLine line;
  MovingMeanOptions options;
  options.registration = registration_options(bodies.front(), settings);
  options.karcher.threads = settings.threads;
  std::vector<AnyAnimatedSurface> surfaces;
  for (const auto& body : bodies) surfaces.push_back(body.surface);
  BodiesMean mean{mean_of_moving(surfaces, bodies.front().sphere, options, std::ref(line)),
                  Mat3X::Zero(3, settings.frames)};
  const MovingMean& m = mean.moving;
  const std::string section = report.section();
  for (std::size_t i = 1; i < bodies.size(); ++i) {
    report.say(bodies[i].normalized.sequence.name + " registered to " + bodies[0].normalized.sequence.name + ":");
    report.section(message(section, section.empty() ? "" : ".", "registrations.", i));
    report_registration(m.registrations[i], report);
  }
  report.section(section);
  report.say("Mean:");
  const KarcherSummary& summary = m.curves.summary;
  report.figure("components", "principal components", m.pca.modes());
  report.figure("components_residual", "mean squared error they leave", m.pca.residual());
  report.figure("energy", "energy before any warp and by iteration", summary.energy);
  report.figure("min_slope", "smallest slope of the time warps", summary.min_slope);
  report.figure("converged", "converged", summary.converged);
  say_units(report);
  const double share = 1 / double(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    mean.way += share * m.registrations[i].spatial.rotation *
                relative_trajectory(bodies[i].normalized, m.curves.warps[i], settings.frames);
    mean.scale += share * bodies[i].normalized.scale;
    mean.duration += share * bodies[i].normalized.sequence.duration;
  }
  return mean;
}

void mean(const std::vector<Body>& bodies, const std::filesystem::path& out, const std::filesystem::path& overview,
          const std::filesystem::path& own, const Settings& settings, Report& report) {
  const BodiesMean mean = mean_of_bodies(bodies, settings, report);
  if (out.empty() && overview.empty() && own.empty())
    return say_not_written(report, "-o FILE.glb or --overview FILE.glb");

  const TriangleMesh& sphere = bodies.front().sphere;
  const KarcherMean& curves = mean.moving.curves;
  const MeshSequence result = mean.animation(integrate_srvf(curves.start, curves.q, time_grid()), sphere.faces, "mean");
  if (!out.empty()) {
    Scene alone;
    alone.add(result);
    alone.write(out);
    report.wrote("mean", out);
  }
  if (!own.empty()) {
    write_on_own_mesh(own, bodies.front(), result, settings);
    report.wrote("own_mesh", own);
  }
  if (overview.empty()) return;
  Scene all;
  const Mat3X colors = place_colors(bodies.front(), sphere.vertices);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    MovingRegistration r = mean.moving.registrations[i];
    r.temporal.warp = curves.warps[i];
    all.add(registered(bodies[i], r, sphere, settings.frames), colors);
  }
  all.add(result, colors);
  all.write(overview);
  report.say(
      "  Side by side: every body on the first's triangles and the mean's clock, the mean last. Colours correspond.");
  report.wrote("overview", overview);
}

}  // namespace dsns::program
