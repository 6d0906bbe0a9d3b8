// evaluate temporal --stretches: motions that only partly overlap.
#include "temporal_curves.hpp"
#include "temporal_experiments.hpp"

#include <dsns/elastic/temporal_registration.hpp>

#include <functional>

namespace dsns::program {

namespace {

/// Which time of the motion is seen at time t of the second one, and how fast it runs.
struct Content {
  std::string name;
  TemporalAlignment alignment;
  std::function<double(double)> unwrapped;
  double rate;
};

double wrapped(double t) { return t >= 0 && t <= 1 ? t : t - std::floor(t); }

Curve seen(const Curve& motion, const Content& content, const TimeWarp& pace) {
  constexpr Index fine = 1600;
  Eigen::MatrixXd velocities(motion.dimension(), fine + 1);
  for (Index k = 0; k <= fine; ++k) {
    const double t = double(k) / double(fine);
    velocities.col(k) = content.rate * pace.slope(t) * motion.velocity(wrapped(content.unwrapped(pace(t))));
  }
  return {motion(wrapped(content.unwrapped(0))), std::move(velocities)};
}

/// RMS distance around the circle of what stands beside each other.
double miss(const TemporalResult& r, const Content& content, const TimeWarp& pace) {
  constexpr int n = 1000;
  double sum = 0;
  for (int k = 0; k < n; ++k) {
    const double t = (k + 0.5) / n, shown = content.unwrapped(pace(r.second_time(t)));
    const double error = std::remainder(shown - r.first_time(t), 1.0);
    sum += error * error / n;
  }
  return std::sqrt(sum);
}

}  // namespace

std::vector<StretchRow> compare_stretches(const std::string& name, const Settings& settings,
                                          const TemporalEvaluation& evaluation, Report& report) {
  ProgressLine line;
  const Body body = load_body(name, settings, report, std::ref(line));
  const Curve motion = curves_of(body, {0}, settings, report).front().curve;
  const std::vector<Content> contents{
      {"two cycles against one", TemporalAlignment::cyclic, [](double t) { return 2 * t; }, 2},
      {"begun a third late", TemporalAlignment::cyclic, [](double t) { return 1.0 / 3 + t; }, 1},
      {"cut off at 70 %", TemporalAlignment::partial, [](double t) { return 0.7 * t; }, 0.7}};
  std::vector<StretchRow> rows;
  for (const Content& content : contents)
    for (int k = 0; k < evaluation.warps; ++k) {
      // The first at its own pace, the others at random ones.
      const TimeWarp pace = k == 0 ? TimeWarp() : random_pace(evaluation, k, settings);
      const Curve second = seen(motion, content, pace);
      const TemporalResult whole = register_temporally(motion, second);
      TemporalOptions options;
      options.alignment = content.alignment;
      const Stopwatch watch;
      const TemporalResult named = register_temporally(motion, second, options);
      const double seconds = watch.seconds(), norm = named.summary.norm;
      rows.push_back({name, content.name, k, miss(whole, content, pace), miss(named, content, pace),
                      whole.summary.energy_after / norm, named.summary.energy_after / norm, named.first.length,
                      named.second.begin, named.second.length, seconds, whole.summary.advice});
    }
  for (const StretchRow& row : rows) {
    report.row("rows");
    report.note("file", row.file);
    report.note("case", row.content);
    report.note("warp", std::int64_t(row.warp));
    report.note("warp_l2_whole", row.miss_whole);
    report.note("warp_l2", row.miss_named);
    report.note("energy_whole", row.energy_whole);
    report.note("energy", row.energy_named);
    report.note("first_end", row.first_end);
    report.note("second_begin", row.second_begin);
    report.note("second_passes", row.second_passes);
    report.note("seconds", row.seconds);
    report.note("advice", row.advice);
  }
  return rows;
}

}  // namespace dsns::program
