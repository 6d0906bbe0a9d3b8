// modes, sample, distances: what is said of a group of animations.
#include "commands.hpp"
#include "gnuplot.hpp"
#include "registration.hpp"
#include "scene.hpp"
#include "tables.hpp"

#include <dsns/core/parallel.hpp>
#include <dsns/io/atomic_file.hpp>
#include <dsns/stats/groups.hpp>
#include <dsns/stats/valid_samples.hpp>
#if defined(DSNS_WITH_SPECTRA)
#include <dsns/matching/shape_dna.hpp>
#endif

#include <map>
#include <optional>
#include <sstream>

namespace dsns::program {

namespace {

namespace fs = std::filesystem;

std::vector<double> numbers(const Eigen::VectorXd& v) { return {v.begin(), v.end()}; }

PrincipalModes modes_of(const BodiesMean& mean, const Study& study, Report& report) {
  require(study.part.has_value(), "modes are of motions: give --part all, start, shape or pace");
  PrincipalModes modes(mean.moving.curves, mean.moving.members, *study.part);
  report.say("Modes:");
  report.figure("variances", "variances", numbers(modes.model().variances()));
  report.figure("pace_weight", "weight of pace", modes.features().pace_weight());
  return modes;
}

/// With its pace, where pace is among what is compared.
Eigen::MatrixXd points_of(const RegisteredMotion& motion, MotionPart part) {
  return part == MotionPart::all || part == MotionPart::pace ? motion.points_at_own_pace() : motion.points();
}

/// Of values given for every source, those of the members.
template <class T>
std::vector<T> of_members(const std::vector<T>& values, const Group& group, const char* what) {
  require(values.empty() || values.size() == group.given(), values.size(), " ", what, " for ", group.given(),
          " animations: give one for each, in their order, for those left out too");
  std::vector<T> out;
  for (const auto& member : group.members())
    if (!values.empty()) out.push_back(values[member.place]);
  return out;
}

/// What each body is, whatever it does, a column each.
Eigen::MatrixXd shape_dna_of(const Group& group, const Study& study, const Settings& settings, Report& report) {
#if defined(DSNS_WITH_SPECTRA)
  std::vector<std::optional<MatchingBody>> bodies(group.size());
  parallel_for(static_cast<int>(group.size()), settings.threads, [&](int k) {
    const Body body = group.body(std::size_t(k));
    bodies[std::size_t(k)].emplace(body.normalized.sequence, body.sphere.vertices);
  });
  // The higher ones of a coarse mesh are its own, not the body's.
  constexpr Index vertices_for_each = 10;
  Index count = study.eigenvalues;
  for (const auto& body : bodies) count = std::min(count, body->vertex_count() / vertices_for_each);
  require(count >= 1, "a mesh has fewer than ", vertices_for_each, " vertices, too few for --part body");
  Eigen::MatrixXd dna(count, Index(group.size()));
  parallel_for(static_cast<int>(group.size()), settings.threads,
               [&](int k) { dna.col(k) = shape_dna(*bodies[std::size_t(k)], count); });
  report.figure("eigenvalues", "eigenvalues of each body that are compared", count);
  return dna;
#else
  static_cast<void>(group), static_cast<void>(study), static_cast<void>(settings), static_cast<void>(report);
  fail<Error>(
      "this program was built without Spectra, on which --part body rests; install it (Debian: libspectra-dev) and "
      "build again");
#endif
}

/// Curves of a model's quality by its number of modes, as a script of gnuplot.
std::string quality_script(const ModelQuality& quality) {
  const auto block = [](const char* name, const Eigen::VectorXd& values) {
    std::string text = message("$", name, " << END\n");
    for (Index k = 0; k < values.size(); ++k) text += message(k + 1, " ", values[k], "\n");
    return text + "END\n";
  };
  return block("compactness", quality.compactness) + block("generalisation", quality.generalisation) +
         block("specificity", quality.specificity) +
         "set terminal svg size 900,340 background 'white'\nset output 'quality.svg'\nset multiplot layout 1,2\n"
         "set grid\nset xlabel 'modes'\nset xtics 1\nset style data linespoints\nset yrange [0:*]\n"
         "set key right bottom\nset ylabel 'share of the variance'\nplot $compactness pt 7 title 'compactness'\n"
         "set key left bottom\nset ylabel 'distance'\nplot $generalisation pt 7 title 'generalisation: to the model "
         "of the others', $specificity pt 5 title 'specificity: to the nearest member'\n";
}

}  // namespace

void modes(const Group& group, const Study& study, const Settings& settings, Report& report) {
  const BodiesMean mean = mean_of_bodies(group, settings, report);
  const PrincipalModes modes = modes_of(mean, study, report);
  const LinearModel& model = modes.model();
  std::optional<ModelQuality> assessed;
  if (group.size() >= 3) {
    const ModelQuality& quality = assessed.emplace(model_quality(modes.features().members(), 200, settings.seed));
    report.figure("compactness", "share of the variance in the first modes", numbers(quality.compactness));
    report.figure("generalisation", "distance of each to the model of the others", numbers(quality.generalisation));
    report.figure("specificity", "distance of random members to the nearest", numbers(quality.specificity));
  }
  std::ostringstream csv;
  csv << "animation";
  for (Index k = 0; k < model.modes(); ++k) csv << ",mode_" << k + 1;
  csv << "\n";
  const auto& members = group.members();
  for (std::size_t i = 0; i < group.size(); ++i) {
    report.row("rows");
    report.note("file", members[i].file.string());
    report.figure("scores", members[i].name + ": scores", numbers(model.scores().col(Index(i))));
    csv << csv_field(members[i].name);
    for (Index k = 0; k < model.modes(); ++k) csv << "," << model.scores()(k, Index(i));
    csv << "\n";
  }
  report.section("");
  if (!study.csv.empty()) {
    write_file_atomically(study.csv, csv.str());
    report.wrote("csv", study.csv);
  }
  if (study.out.empty()) return report.say("  No animation was written: give -o FOLDER for one of each mode.");
  fs::create_directories(study.out);
  const Mat3X colors = mean.colors();
  for (Index k = 0; k < std::min<Index>(study.modes, model.modes()); ++k) {
    Scene scene;
    for (const double deviations : {-3.0, -1.5, 0.0, 1.5, 3.0})
      scene.add(
          mean.animation(points_of(modes.at(modes.deviations(k, deviations)), *study.part), message("mode ", k + 1)),
          colors);
    const fs::path path = study.out / message("mode_", k + 1, ".glb");
    scene.write(path);
    report.wrote(message("mode_", k + 1), path);
  }
  report.say("  Side by side: -3, -1.5, 0, 1.5 and 3 standard deviations from the mean.");
  if (!assessed) return;
  const fs::path script = study.out / "quality.gnuplot";
  write_file_atomically(script, quality_script(*assessed));
  if (run_gnuplot(script))
    report.wrote("quality", study.out / "quality.svg");
  else
    report.say("  No picture of the quality: gnuplot is missing, or failed on " + script.string());
}

void sample_bodies(const Group& group, const Study& study, const fs::path& out, const Settings& settings,
                   Report& report) {
  const BodiesMean mean = mean_of_bodies(group, settings, report);
  const PrincipalModes modes = modes_of(mean, study, report);
  const Index caps = mean.chosen.normalized.sequence.cap_faces;
  const MotionInspection inspect(
      [&](const Eigen::MatrixXd& points, int times) { return mean.moving.frames(points, times); },
      modes.at(Eigen::VectorXd(0)).points(), mean.faces().leftCols(mean.faces().cols() - caps));
  std::vector<MotionDefects> defects;
  for (const RegisteredMotion& motion : registered_motions(mean.moving.curves, mean.moving.members))
    defects.push_back(inspect(motion));
  ValidityBounds bounds = bounds_of_members(defects);
  if (study.folded) bounds.folded = *study.folded;
  SampleOptions options;
  options.modes = std::min<Index>(study.modes, modes.model().modes());
  options.count = study.samples;
  options.spread = study.spread;
  options.seed = settings.seed;
  const ValidSamples found = draw_valid_samples(modes, inspect, bounds, options);

  const auto all = [](const auto& list, double MotionDefects::*what, const auto& defects_of) {
    std::vector<double> values;
    for (const auto& one : list) values.push_back(defects_of(one).*what);
    return values;
  };
  const auto of_member = [](const MotionDefects& d) { return d; };
  const auto of_sample = [](const ValidSample& s) { return s.defects; };
  report.say("Samples:");
  report.figure("members_folded", "share of the area that folds, of the members",
                all(defects, &MotionDefects::folded, of_member));
  report.figure("members_collapsed", "that has collapsed, of the members",
                all(defects, &MotionDefects::collapsed, of_member));
  report.figure("mean_folded", "that folds, of the mean", inspect(modes.at(Eigen::VectorXd(0))).folded);
  report.figure("bound_folded", "that may fold in a sample", bounds.folded);
  report.figure("bound_collapsed", "that may have collapsed", bounds.collapsed);
  report.figure("members_growth", "largest |log| of the area, divided by the mean's, of the members",
                all(defects, &MotionDefects::growth, of_member));
  report.figure("bound_growth", "that may be", bounds.growth);
  report.figure("bound_min_slope", "smallest slope of the time warp that may be", bounds.min_slope);
  report.figure("sample_draws", "draws", found.draws);
  report.figure("sample_valid", "of these valid", found.samples.size());
  report.figure("rejected_slow", "in which time as good as stands", found.slow);
  report.figure("rejected_folded", "that fold too much", found.folded);
  report.figure("rejected_collapsed", "in which too much has collapsed", found.collapsed);
  report.figure("rejected_swollen", "that swell or shrink too much", found.swollen);
  report.figure("sample_min_slope", "smallest slope of the time warp of each",
                all(found.samples, &MotionDefects::min_slope, of_sample));
  report.figure("sample_folded", "share of the area that folds, of each",
                all(found.samples, &MotionDefects::folded, of_sample));
  report.figure("sample_collapsed", "that has collapsed, of each",
                all(found.samples, &MotionDefects::collapsed, of_sample));
  report.figure("sample_growth", "largest |log| of the area, divided by the mean's, of each",
                all(found.samples, &MotionDefects::growth, of_sample));
  if (out.empty()) {
    report.say("  No animation was written: give -o FILE.glb for one.");
  } else if (!found.samples.empty()) {
    const Mat3X colors = mean.colors();
    Scene scene;
    for (std::size_t i = 0; i < found.samples.size(); ++i)
      scene.add(mean.animation(points_of(found.samples[i].motion, *study.part), message("sample ", i + 1)), colors);
    scene.write(out);
    report.wrote("samples", out);
  }
  if (found.complete) return;
  report.save(settings.json);
  fail<Error>(
      "only ", found.samples.size(), " of ", study.samples, " samples are valid after ", found.draws, " draws: in ",
      found.slow, " time as good as stands, ", found.folded, " fold more than ", 100 * bounds.folded,
      " % of their area, in ", found.collapsed,
      " too much has collapsed; vary them along fewer modes (--modes), nearer to the mean (--spread) or let more "
      "fold (--folded)");
}

void distances(const Group& group, const Study& study, const Settings& settings, Report& report) {
  const std::vector<std::string> words = of_members(study.labels, group, "labels");
  const std::vector<double> covariate = of_members(study.covariate, group, "values of the covariate");
  const Eigen::MatrixXd compared =
      study.part ? modes_of(mean_of_bodies(group, settings, report), study, report).features().members()
                 : shape_dna_of(group, study, settings, report);
  const Eigen::MatrixXd d = distance_matrix(compared);
  const auto& members = group.members();
  const Clustering tree = cluster(d);
  const Eigen::VectorXd outliers = outlier_scores(d);
  report.say("Distances, in the order of a clustering by average linkage:");
  std::ostringstream csv;
  csv << "animation";
  for (const Index i : tree.order) csv << "," << csv_field(members[std::size_t(i)].name);
  csv << "\n";
  for (const Index i : tree.order) {
    std::vector<double> row;
    csv << csv_field(members[std::size_t(i)].name);
    for (const Index j : tree.order) {
      row.push_back(d(i, j));
      csv << "," << d(i, j);
    }
    csv << "\n";
    report.row("rows");
    report.note("file", members[std::size_t(i)].file.string());
    report.note("animation", members[std::size_t(i)].name);
    report.figure("distances", members[std::size_t(i)].name, row);
    report.figure("outlier", "  median distance, of the median of all", outliers[i]);
  }
  report.section("");
  if (!words.empty()) {
    std::map<std::string, int> numbers_of;
    std::vector<int> labels;
    for (const std::string& label : words)
      labels.push_back(numbers_of.emplace(label, static_cast<int>(numbers_of.size())).first->second);
    const Classification nearest = classify_leave_one_out(d, labels);
    report.figure("accuracy", "nearest neighbour has the same label, share", nearest.accuracy);
    report.figure("chance", "by chance", nearest.chance);
    if (numbers_of.size() >= 2 && numbers_of.size() < group.size()) {
      const PermutationTest test = permutation_test(d, labels, 999, settings.seed);
      report.figure("pseudo_f", "pseudo F of the labels", test.statistic);
      report.figure("p_value", "its p value, 999 permutations", test.p_value);
    }
  }
  if (!covariate.empty()) {
    const Regression r = regress(LinearModel(compared).scores(), covariate, 999, settings.seed);
    report.figure("explained", "share of the variance that the covariate explains", r.explained);
    report.figure("regression_p_value", "its p value, 999 permutations", r.test.p_value);
    report.figure("slope", "scores by unit of the covariate", numbers(r.slope));
  }
  if (study.csv.empty()) return;
  write_file_atomically(study.csv, csv.str());
  report.wrote("csv", study.csv);
}

}  // namespace dsns::program
