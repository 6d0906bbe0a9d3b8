// evaluate spatial: warps and turns that are known, found again by registration.
#include "commands.hpp"
#include "evaluate_tables.hpp"
#include "evaluations.hpp"
#include "gnuplot.hpp"

#include <dsns/elastic/known_warp.hpp>
#include <dsns/io/atomic_file.hpp>
#include <dsns/mesh/piecewise_linear_diffeomorphism.hpp>
#include <dsns/mesh/sphere_mask.hpp>
#include <dsns/mesh/spherical_parameterization.hpp>
#include <dsns/stats/co_registration.hpp>
#include <dsns/surface/sampled.hpp>

#include <chrono>
#include <ctime>
#include <iostream>

namespace dsns::program {

namespace {

constexpr double degree = pi / 180;

/// The same moving surface once more, and where its sphere has what the first one's has.
struct Again {
  Body body;
  PiecewiseLinearDiffeomorphism between;  ///< from the first sphere to this one, exact at the vertices
};

/// With its vertices in another order, from which another sphere map comes.
Again mapped_again(const Body& first, std::uint64_t seed) {
  const MeshSequence& given = first.normalized.sequence;
  std::vector<int> place(static_cast<std::size_t>(given.vertex_count()));
  for (std::size_t v = 0; v < place.size(); ++v) place[v] = static_cast<int>(v);
  std::mt19937_64 random(seed);
  std::shuffle(place.begin(), place.end(), random);
  Body body = first;
  MeshSequence& shuffled = body.normalized.sequence;
  for (std::size_t k = 0; k < given.frames.size(); ++k) shuffled.frames[k](Eigen::all, place) = given.frames[k];
  for (Index c = 0; c < given.faces.size(); ++c) shuffled.faces(c) = place[static_cast<std::size_t>(given.faces(c))];
  body.sphere = {spherical_parameterization(shuffled).sphere, shuffled.faces};
  body.surface = AnyAnimatedSurface(SampledSurface(shuffled, body.sphere.vertices));
  return {body, PiecewiseLinearDiffeomorphism(first.sphere, body.sphere.vertices(Eigen::all, place))};
}

SpatialOptions spatial_options(const Body& first, const KnownWarp& truth, const SpatialEvaluation& evaluation,
                               const Settings& settings) {
  SpatialOptions options;
  options.threads = settings.threads;
  if (first.normalized.sequence.cap_faces > 0)  // the body that is found again is seen through the warp
    options.mask = [mask = SphereMask(first.normalized.sequence, first.sphere.vertices), truth](const Mat3X& s) {
      return mask(truth.gamma(s));
    };
  for (const std::string& part : evaluation.without) {
    if (part == "jacobian") options.action = FieldAction::as_published;
    if (part == "refinement") options.refinement = {};
    for (std::vector<SpatialLevel>* levels : {&options.levels, &options.refinement})
      for (SpatialLevel& level : *levels) {
        if (part == "smoothing") level = {level.field_degree, levels->back().surface_degree, 0, level.position_weight};
        if (part == "positions") level.position_weight = 0;
      }
    if (part == "positions") options.finest.position_weight = 0;
  }
  return options;
}

void report_row(const SpatialRow& row, Report& report) {
  report.row("rows");
  report.note("file", row.file);
  report.note("seed", static_cast<std::int64_t>(row.seed));
  report.figure("warp_rms_deg_before", "known warp, degrees rms", row.before);
  report.figure("warp_rms_deg_after", "what is left of it", row.after);
  report.figure("warp_max_deg_after", "  at most", row.largest);
  report.figure("rotation_deg_after", "what is left of the body's turn, degrees", row.rotation);
  report.figure("energy_ratio", "energy after over before", row.energy_ratio);
  report.figure("min_jacobian", "smallest Jacobian, on points not used", row.min_jacobian);
  report.figure("seconds", "seconds", row.seconds);
  report.figure("cpu_seconds", "CPU-seconds", row.cpu_seconds);
}

SpatialRow evaluate_warp(const std::string& name, const Body& first, const Again& second, double size,
                         std::uint64_t seed, const SpatialEvaluation& evaluation, const Settings& settings) {
  const KnownWarp truth = known_warp(seed, evaluation.warp_degree, size * degree);
  const RegisteredSurface moved(first.surface, truth.rotation, truth.gamma);
  RegistrationOptions options;
  options.spatial = spatial_options(first, truth, evaluation, settings);
  const auto begin = std::chrono::steady_clock::now();
  const std::clock_t cpu = std::clock();
  const SpatialResult r = register_in_space(moved, second.body.surface, options);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
  const double cpu_seconds = double(std::clock() - cpu) / CLOCKS_PER_SEC;
  const SphereQuadrature q = fibonacci_sphere(4000);
  const AngularDistance miss = angular_distance(r.gamma(q.points), second.between(truth.gamma(q.points)), q.weights);
  return {name,
          seed,
          size,
          miss.rms / degree,
          miss.largest / degree,
          rotation_angle(r.rotation * truth.rotation.transpose()) / degree,
          r.summary.energy_after / r.summary.energy_before,
          min_jacobian(r.gamma, fibonacci_sphere(20000).points),
          seconds.count(),
          cpu_seconds};
}

/// What is left of the warps of each sequence, in boxes.
void plot(const std::vector<SpatialRow>& rows, const std::filesystem::path& picture, Report& report) {
  std::vector<Box> boxes;
  for (const SpatialRow& row : rows) {
    const std::string label = std::filesystem::path(row.file).stem().string();
    if (boxes.empty() || boxes.back().label != label) boxes.push_back({label, {}, 2});
    boxes.back().values.push_back(row.after);
  }
  if (draw_boxes(boxes, "left of the warp, degrees rms", picture))
    report.wrote("picture", picture);
  else
    report.say("No picture was drawn: gnuplot is not there (Debian: gnuplot-nox); its script is beside it.");
}

}  // namespace

int evaluate_spatial(const std::vector<std::string>& sources, const Settings& settings,
                     const SpatialEvaluation& evaluation, Report& report) {
  std::vector<SpatialRow> rows;
  int failures = 0;
  for (const std::string& name : sources) {
    try {
      ProgressLine line;
      Body first = load_body(name, settings, report, std::ref(line));
      Again second = evaluation.map == SecondMap::again ? mapped_again(first, settings.seed + 1)
                                                        : Again{first, PiecewiseLinearDiffeomorphism(first.sphere)};
      if (settings.representation == Representation::neural) {
        Settings other = settings;
        other.seed = settings.seed + 1;
        report.section("fits");
        fit(first, {}, settings, report);
        fit(second.body, {}, other, report);
      }
      report.section("");
      if (evaluation.map == SecondMap::again) {
        const Mat3X &a = first.sphere.vertices, b = second.between(a);
        const Eigen::VectorXd areas = vertex_areas(a, first.sphere.faces);
        const Mat3 turn = nearest_rotation(b * areas.asDiagonal() * a.transpose());
        report.say(message("  the second sphere map is ", angular_distance(Mat3X(turn * a), b, areas).rms / degree,
                           " degrees rms from the first, turned"));
      }
      std::uint64_t seed = settings.seed;
      for (const double size : evaluation.degrees)
        for (int k = 0; k < evaluation.warps; ++k) {
          rows.push_back(evaluate_warp(name, first, second, size, ++seed, evaluation, settings));
          report_row(rows.back(), report);
        }
    } catch (const std::exception& error) {
      ++failures;
      std::cout << std::flush;
      std::cerr << "dsns: " << error.what() << '\n';
      report.row("failures");
      report.note("file", name);
      report.note("reason", std::string(error.what()));
    }
  }
  report.section("summary");
  if (!rows.empty()) {
    std::vector<double> after, seconds;
    for (const SpatialRow& row : rows) after.push_back(row.after), seconds.push_back(row.cpu_seconds);
    report.say(message("Summary of ", rows.size(), ":"));
    report.figure("warp_rms_deg_after.median", "left of the warp, degrees rms, median", spread(after).median);
    report.figure("warp_rms_deg_after.max", "  largest", *std::max_element(after.begin(), after.end()));
    report.figure("cpu_seconds.median", "CPU-seconds, median", spread(seconds).median);
  }
  report.section("");
  if (!evaluation.csv.empty()) write_file_atomically(evaluation.csv, csv(rows));
  if (!evaluation.markdown.empty()) write_file_atomically(evaluation.markdown, markdown(rows));
  if (!evaluation.plot.empty() && !rows.empty()) plot(rows, evaluation.plot, report);
  return failures;
}

}  // namespace dsns::program
