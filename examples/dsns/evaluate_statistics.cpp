// evaluate statistics: means of copies of one motion, which should be that motion.
#include "evaluations.hpp"
#include "tables.hpp"

#include <dsns/elastic/known_warp.hpp>
#include <dsns/io/atomic_file.hpp>
#include <dsns/mesh/sphere_mesh.hpp>
#include <dsns/stats/moving_mean.hpp>
#include <dsns/surface/bodies.hpp>
#include <dsns/surface/sampled.hpp>

#include <algorithm>
#include <chrono>

namespace dsns::program {

namespace {

/// A body with four limbs that swing, of area about 1.
LimbedBody moving_body() {
  LimbedBody body;
  body.axes = 0.26 * Vec3d(1, 0.8, 0.65);
  const auto limb = [&](const Vec3d& root, const Vec3d& reach, const Vec3d& swing, double phase) {
    body.limbs.push_back({root.normalized(), 8, 0.26 * reach, 0.26 * swing, phase});
  };
  limb({1, 0.4, 0.2}, {0.8, 0.2, 0.1}, {0, 0.4, 0.1}, 0);
  limb({-1, 0.5, 0.4}, {-0.6, 0.3, 0.4}, {0.1, 0.3, 0.4}, 0.3);
  limb({0.3, -1, 0.3}, {0.1, -0.9, 0.1}, {0.4, 0, 0}, 0.6);
  limb({-0.2, 0.1, -1}, {0, 0.1, -0.5}, {0.2, 0.2, 0}, 0.1);
  return body;
}

struct Copy {
  AnyAnimatedSurface surface;
  TimeWarp clock;
};

/// O F(gamma(s), clock(t)) on a mesh, with noise.
Copy noisy_copy(const LimbedBody& body, const TriangleMesh& sphere, double size, std::uint64_t seed,
                const StatisticsEvaluation& evaluation, const Settings& settings) {
  const KnownWarp warp = known_warp(seed, 3, evaluation.degrees * pi / 180);
  const TimeWarp clock = random_time_warp(seed, 0.5, 1.7);
  const RegisteredSurface moved(body, warp.rotation, warp.gamma, clock);
  MeshSequence sequence;
  sequence.faces = sphere.faces;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0, evaluation.noise * size);
  for (const double t : equidistant_times(settings.frames)) {
    Mat3X x = positions(moved, sphere.vertices, t);
    for (double& c : x.reshaped()) c += noise(random);
    sequence.frames.push_back(std::move(x));
  }
  return {AnyAnimatedSurface(SampledSurface(sequence, sphere.vertices)), clock};
}

/// Root mean square distance over vertices and frames.
double rms_distance(const std::vector<Mat3X>& a, const std::vector<Mat3X>& b) {
  double square = 0;
  for (std::size_t k = 0; k < a.size(); ++k) square += (a[k] - b[k]).colwise().squaredNorm().mean() / double(a.size());
  return std::sqrt(square);
}

struct CopiesRow {
  std::size_t copies;
  double apart, agreement, warps, order, seconds;
  GroupSummary space;
  KarcherSummary time;
};

CopiesRow evaluate(std::size_t copies, const StatisticsEvaluation& evaluation, const Settings& settings) {
  const LimbedBody body = moving_body();
  const TriangleMesh sphere = icosphere(evaluation.level);
  const int frames = settings.frames;
  std::vector<Mat3X> original;
  for (const double t : equidistant_times(frames)) original.push_back(positions(body, sphere.vertices, t));
  const double size =
      rms_distance(original, std::vector<Mat3X>(original.size(), Mat3X::Zero(3, sphere.vertices.cols())));
  std::vector<AnyAnimatedSurface> surfaces;
  std::vector<TimeWarp> clocks;
  for (std::size_t i = 0; i < copies; ++i) {
    Copy copy = noisy_copy(body, sphere, size, settings.seed + i + 1, evaluation, settings);
    surfaces.push_back(std::move(copy.surface));
    clocks.push_back(std::move(copy.clock));
  }
  MovingMeanOptions options;
  options.registration.spatial.threads = options.karcher.threads = settings.threads;
  options.registration.snapshots = frames;
  const auto start = std::chrono::steady_clock::now();
  ProgressLine line;
  const MovingMean m = mean_of_moving(surfaces, sphere, options, std::ref(line));
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;

  // The original, registered to the mean.
  const AnyAnimatedSurface mean(m.surface(frames)), truth(body);
  const MovingRegistration r = register_moving(mean, truth, m.sphere, options.registration, std::ref(line));
  const RegisteredSurface back(truth, r.spatial.rotation, r.spatial.gamma, r.temporal.warp);
  std::vector<Mat3X> expected;
  for (const double t : equidistant_times(frames)) expected.push_back(positions(back, m.sphere.vertices, t));
  CopiesRow row{
      copies,          0, rms_distance(m.frames(frames), expected) / size, 0, 0, seconds.count(), m.group.summary,
      m.curves.summary};
  for (std::size_t i = 0; i < copies; ++i) {
    row.warps = std::max(row.warps, distance(compose(clocks[i], m.curves.warps[i]), r.temporal.warp));
    row.apart = std::max(row.apart, distance(clocks[i], TimeWarp()));
  }
  if (copies > std::size_t(evaluation.reordered)) return row;
  std::vector<AnyAnimatedSurface> shuffled = surfaces;
  std::rotate(shuffled.begin(), shuffled.begin() + std::ptrdiff_t(copies / 2 + copies % 2), shuffled.end());
  row.order =
      rms_distance(mean_of_moving(shuffled, sphere, options, std::ref(line)).frames(frames), m.frames(frames)) / size;
  return row;
}

bool never_rises(const std::vector<double>& energy) { return std::is_sorted(energy.rbegin(), energy.rend()); }

}  // namespace

void evaluate_statistics(const StatisticsEvaluation& evaluation, const Settings& settings, Report& report) {
  std::string table =
      table_head({"copies", "original to mean, of its size", "warps of time, largest L2 error",
                  "other order, of the size", "energy of shapes: as they are, at the template, at the end",
                  "energy of motions before, after", "iterations", "never rises", "seconds"});
  for (const int copies : evaluation.copies) {
    const CopiesRow row = evaluate(std::size_t(copies), evaluation, settings);
    report.say(message(copies, " copies:"));
    report.row("rows");
    report.note("copies", std::int64_t(copies));
    report.figure("agreement", "original registered to the mean, of its size", row.agreement);
    report.figure("clock_before", "clocks were off by, at most, L2", row.apart);
    report.figure("warp_l2", "and are now, at most", row.warps);
    const bool reordered = copies <= evaluation.reordered;
    if (reordered) report.figure("order", "another order of the copies changes, of the size", row.order);
    report.figure("spatial_energy_unregistered", "energy of the shapes as they are", row.space.energy_unregistered);
    report.figure("spatial_energy", "registered to the template, by iteration", row.space.energy);
    report.figure("energy", "energy of the motions by iteration", row.time.energy);
    const bool falls = never_rises(row.space.energy) && never_rises(row.time.energy);
    report.figure("never_rises", "energies never rise", falls);
    report.figure("converged", "converged", row.space.converged && row.time.converged);
    report.figure("iterations", "iterations in space and in time",
                  message(row.space.energy.size() - 1, ", ", row.time.energy.size() - 1));
    report.figure("seconds", "seconds", row.seconds);
    table += table_line({message(copies), scientific(row.agreement), scientific(row.warps),
                         reordered ? scientific(row.order) : "",
                         scientific(row.space.energy_unregistered) + ", " + scientific(row.space.energy.front()) +
                             ", " + scientific(row.space.energy.back()),
                         scientific(row.time.energy.front()) + ", " + scientific(row.time.energy.back()),
                         message(row.space.energy.size() - 1, " + ", row.time.energy.size() - 1), falls ? "yes" : "no",
                         fixed(row.seconds, 0)});
  }
  report.section("");
  if (!evaluation.markdown.empty()) write_file_atomically(evaluation.markdown, table);
}

}  // namespace dsns::program
