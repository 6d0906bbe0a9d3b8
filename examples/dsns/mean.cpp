// mean: the mean of a group of animations, and what it shares with the other commands about groups.
#include "commands.hpp"
#include "registration.hpp"
#include "scene.hpp"

#include <chrono>

namespace dsns::program {

namespace {

MovingMeanOptions mean_options(const Body& chosen, const Settings& settings) {
  MovingMeanOptions options;
  options.registration = registration_options(chosen, settings);
  options.registration.temporal.alignment = TemporalAlignment::whole;
  options.registration.temporal.search_grid = 0;  // which would be of no use to a mean
  options.karcher.threads = settings.threads;
  return options;
}

/// The area of the mean, of that of the bodies: what does not correspond is averaged away, and limbs shrink.
double area_kept(const MovingMean& mean, Index cap_faces, int frames) {
  const Faces faces = mean.sphere.faces.leftCols(mean.sphere.faces.cols() - cap_faces);
  double sum = 0;
  for (const Mat3X& x : mean.frames(frames)) sum += area({x, faces}) / frames;
  return sum;
}

void report_mean(const MovingMean& m, Index cap_faces, const Settings& settings, Report& report) {
  report.figure("components", "principal components", m.pca.modes());
  report.figure("components_residual", "mean squared error they leave", m.pca.residual());
  report.figure("explained", "share of the variance in the first three",
                m.pca.variances().head(std::min<Index>(3, m.pca.modes())).sum() / m.pca.total_variance());
  report.figure("variance", "variance of the poses", m.pca.total_variance());
  report.figure("area_kept", "area of the mean, of that of the bodies", area_kept(m, cap_faces, settings.frames));
}

Mat3X way_of_mean(const Group& group, const MovingMean& m, int frames) {
  Mat3X way = Mat3X::Zero(3, frames);
  for (std::size_t i = 0; i < group.size(); ++i) {
    const Group::Member& member = group.members()[i];
    const NormalizedSequence place{{}, member.trajectory, member.scale};
    way += m.group.members[i].spatial.rotation * relative_trajectory(place, m.curves.warps[i], frames) /
           double(group.size());
  }
  return way;
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// All bodies as they are, and last the mean that they have where equal points of their spheres and equal times correspond.
void write_before(const std::filesystem::path& path, const Group& group, const BodiesMean& mean,
                  const Settings& settings, Report& report) {
  MovingMeanOptions options = mean_options(mean.chosen, settings);
  options.karcher.iterations = 0;
  const auto load = [&](std::size_t i) { return group.surface(i); };
  const GroupRegistration none{mean.moving.group.chosen, std::vector<MovingRegistration>(group.size()), {}};
  ProgressLine line;
  const MovingMean m = mean_of_registered(load, none, mean.chosen.sphere, options, std::ref(line));
  report.say("Without registration:");
  report.section("before");
  report.figure("energy", "energy of the motions", m.curves.summary.energy.front());
  report_mean(m, mean.chosen.normalized.sequence.cap_faces, settings, report);
  report.section("");
  Scene scene;
  for (std::size_t i = 0; i < group.size(); ++i) scene.add(as_represented(group.body(i), settings.frames));
  scene.add(denormalize(m.frames(settings.frames), m.sphere.faces, way_of_mean(group, m, settings.frames), mean.scale,
                        mean.duration, "mean without registration"));
  scene.write(path);
  report.wrote("before", path);
}

/// Fits a surface that is a function of point and time to the mean, whose error is said.
void write_fitted(const std::filesystem::path& path, const BodiesMean& mean, const Settings& settings, Report& report) {
  Body body = mean.chosen;
  body.normalized.sequence.frames = mean.moving.frames(settings.frames);
  body.normalized.sequence.name = "mean";
  body.normalized.sequence.duration = mean.duration;
  body.normalized.scale = mean.scale;
  body.normalized.trajectory = mean.scale * mean.way;
  body.surface = mean.surface();
  Settings fast = settings;
  fast.preset = Preset::fast;
  report.say("A surface fitted to the mean:");
  report.section("fitted");
  fit(body, path, fast, report);
  report.section("");
}

}  // namespace

const SphereDiffeomorphism& BodiesMean::of_chosen() const {
  return moving.group.members[moving.group.chosen.member].spatial.gamma;
}

AnyAnimatedSurface BodiesMean::surface() const {
  MeshSequence sequence;
  sequence.faces = faces();
  sequence.frames = moving.frames(static_cast<int>(way.cols()));
  return AnyAnimatedSurface(SampledSurface(sequence, chosen.sphere.vertices));
}

Mat3X BodiesMean::colors() const { return place_colors(chosen, of_chosen()(moving.sphere.vertices)); }

MeshSequence BodiesMean::animation(const Eigen::MatrixXd& points, const std::string& name) const {
  return denormalize(moving.frames(points, static_cast<int>(way.cols())), faces(), way, scale, duration, name);
}

MeshSequence BodiesMean::animation(const std::string& name) const {
  return animation(integrate_srvf(moving.curves.start, moving.curves.q, time_grid()), name);
}

BodiesMean mean_of_bodies(const Group& group, const Settings& settings, Report& report) {
  ProgressLine line;
  const auto start = std::chrono::steady_clock::now();
  const auto load = [&](std::size_t i) { return group.surface(i); };
  const GroupTemplate chosen = choose_template(load, group.size(), settings.threads);
  Body body = group.body(chosen.member);
  const MovingMeanOptions options = mean_options(body, settings);
  const std::string what = message("1|", int(settings.search), "|", settings.frames);
  MovingMean moving =
      mean_of_group(load, chosen, body.sphere, options, group.store(chosen.member, what), std::ref(line));
  BodiesMean mean{std::move(moving), std::move(body), {}};
  const MovingMean& m = mean.moving;
  const std::string section = report.section();
  const auto& members = group.members();
  report.figure("template", "the template is", members[chosen.member].name);
  for (std::size_t i = 0; i < group.size(); ++i) {
    if (i == chosen.member) continue;
    report.say(members[i].name + " registered to it:");
    report.section(message(section, section.empty() ? "" : ".", "registrations.", i + 1));
    report_registration(m.group.members[i], report);
  }
  report.section(section);
  report.say("Mean:");
  const GroupSummary& space = m.group.summary;
  const KarcherSummary& time = m.curves.summary;
  report.figure("spatial_energy_unregistered", "energy of the shapes as they are", space.energy_unregistered);
  report.figure("spatial_energy", "registered to the template, by iteration", space.energy);
  report.figure("spatial_norm", "squared norm of all shapes", space.norm);
  report.figure("spatial_converged", "converged", space.converged);
  report.figure("gauge_deg", "mean of the maps of the sphere, degrees rms", space.gauge * 180 / pi);
  report.figure("min_jacobian", "smallest Jacobian of the sphere maps", space.min_jacobian);
  report_mean(m, mean.chosen.normalized.sequence.cap_faces, settings, report);
  report.figure("energy", "energy before any warp and by iteration", time.energy);
  report.figure("min_slope", "smallest slope of the time warps", time.min_slope);
  report.figure("converged", "converged", time.converged);
  report.figure("seconds", "seconds from the mapped bodies on", seconds_since(start));
  say_units(report);
  mean.way = way_of_mean(group, m, settings.frames);
  for (const auto& member : members) {
    mean.scale += member.scale / double(group.size());
    mean.duration += member.duration / double(group.size());
  }
  return mean;
}

void mean(const Group& group, const MeanOutputs& out, const Settings& settings, Report& report) {
  const BodiesMean mean = mean_of_bodies(group, settings, report);
  if (!out.before.empty()) write_before(out.before, group, mean, settings, report);
  if (out.mean.empty() && out.overview.empty() && out.own.empty())
    say_not_written(report, "-o FILE.glb or --overview FILE.glb");
  const MeshSequence result = mean.animation("mean");
  if (!out.mean.empty()) {
    Scene alone;
    alone.add(result);
    alone.write(out.mean);
    report.wrote("mean", out.mean);
  }
  if (!out.own.empty()) {
    // On the first one's triangles, as points of its source: a body that was kept does not know its source's mesh any more.
    const Body first = read_body(group.members().front().source, settings, {}).body;
    const Mat3X places =
        mean.of_chosen()(mean.moving.group.members.front().spatial.gamma.inverse(first.sphere.vertices));
    write_on_own_mesh(out.own, first,
                      denormalize(frames_of(mean.surface(), places, settings.frames), first.sphere.faces, mean.way,
                                  mean.scale, mean.duration, "mean"),
                      settings);
    report.wrote("own_mesh", out.own);
  }
  if (!out.fitted.empty()) write_fitted(out.fitted, mean, settings, report);
  if (out.overview.empty()) return;
  Scene all;
  const Mat3X colors = mean.colors();
  for (std::size_t i = 0; i < group.size(); ++i) {
    MovingRegistration r = mean.moving.group.members[i];
    r.temporal.warp = mean.moving.curves.warps[i];
    all.add(registered(group.body(i), r, mean.moving.sphere, settings.frames), colors);
  }
  all.add(result, colors);
  all.write(out.overview);
  report.say("  Side by side: every body on the mean's triangles and clock, the mean last. Colours correspond.");
  report.wrote("overview", out.overview);
}

}  // namespace dsns::program
