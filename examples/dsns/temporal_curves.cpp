#include "temporal_curves.hpp"

#include "fits.hpp"
#include "gnuplot.hpp"

#include <dsns/io/atomic_file.hpp>
#include <dsns/mesh/sampling.hpp>
#include <dsns/surface/sampled.hpp>

namespace dsns::program {

namespace {

constexpr int points_compared = 3000;
constexpr int intervals = 400;  // at which velocities are taken

}  // namespace

/// O F(y, t) at points of the sphere.
SurfaceSamples samples_at(const AnyAnimatedSurface& surface, const Mat3X& y, const Mat3& rotation, int snapshots) {
  SurfaceSamples out;
  for (const double t : equidistant_times(snapshots)) out.snapshots.push_back(rotation * surface.positions(y, t));
  for (const double t : equidistant_times(intervals + 1))
    out.velocities.push_back(rotation * velocities(surface, y, t));
  return out;
}

FunctionalPca basis_of(const std::vector<SurfaceSamples>& samples) {
  std::vector<Mat3X> all;
  for (const auto& s : samples) all.insert(all.end(), s.snapshots.begin(), s.snapshots.end());
  const Index n = all.front().cols();
  return {all, Eigen::VectorXd::Constant(n, 1 / double(n))};
}

Mat3X points_of(const Body& body, const Settings& settings) {
  std::mt19937_64 random(settings.seed);
  return sample_faces(body.normalized.sequence, body.sphere.vertices, points_compared, random);
}

TimeWarp random_pace(const TemporalEvaluation& evaluation, int number, const Settings& settings) {
  const std::uint64_t seed = settings.seed * 1000 + std::uint64_t(number) + 1;
  return evaluation.strong ? random_time_warp(seed, 0.03, 4) : random_time_warp(seed, 0.2, 2.3);
}

bool draw_paces(const TemporalEvaluation& evaluation, const Settings& settings) {
  const std::filesystem::path script = evaluation.out / "temporal_paces.gnuplot";
  constexpr int points = 200;
  std::string text = "$paces << END\n";
  for (int k = 0; k < evaluation.warps; ++k) {
    const TimeWarp pace = random_pace(evaluation, k, settings);
    for (int i = 0; i <= points; ++i) text += message(double(i) / points, " ", pace(double(i) / points), "\n");
    text += "\n";
  }
  text +=
      "END\nset terminal svg size 520,520 background 'white'\nset output 'temporal_paces.svg'\nset size square\n"
      "set grid\nset xlabel 'time'\nset ylabel 'time of the motion that is played'\nunset key\n"
      "plot $paces with lines lc 1, x with lines lc 0\n";
  write_file_atomically(script, text);
  return run_gnuplot(script);
}

std::vector<MotionCurve> curves_of(const Body& body, const std::vector<int>& frame_counts, const Settings& settings,
                                   Report& report) {
  const int all = body.normalized.sequence.frame_count();
  const Mat3X y = points_of(body, settings);
  const bool fitted = settings.representation == Representation::neural;
  std::vector<MotionCurve> out;
  for (const int wanted : frame_counts) {
    if (wanted >= all) {
      report.say(message("  has no more than ", all, " frames: no surface from ", wanted));
      continue;
    }
    const std::vector<int> frames = spread_frames(all, wanted == 0 ? all : wanted);
    AnyAnimatedSurface surface = body.surface;
    if (fitted) {
      ProgressLine line;
      const Fitted fit = fit_frames(body, frames, settings, std::ref(line));
      if (wanted == 0)
        report.say(message("  fitted in ", fit.figures.wall_seconds, " s to a mean squared error of ",
                           fit.figures.error.msd, " on points never seen"));
      surface = std::visit([](const auto& f) { return AnyAnimatedSurface(f); }, fit.surface);
    } else if (wanted > 0) {
      surface = AnyAnimatedSurface(
          SampledSurface(frames_alone(body, frames), body.sphere.vertices, frame_times(body, frames)));
    }
    const SurfaceSamples samples = samples_at(surface, y, Mat3::Identity(), all);
    out.push_back(
        {fitted ? "fitted" : "sampled", wanted, int(frames.size()), shape_curve(samples, basis_of({samples}))});
  }
  return out;
}

}  // namespace dsns::program
