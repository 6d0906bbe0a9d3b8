// modes, sample, distances: what is said of a group of animations.
#include "commands.hpp"
#include "gnuplot.hpp"
#include "registration.hpp"
#include "scene.hpp"
#include "tables.hpp"

#include <dsns/io/atomic_file.hpp>
#include <dsns/stats/groups.hpp>

#include <map>
#include <optional>
#include <sstream>

namespace dsns::program {

namespace {

namespace fs = std::filesystem;

std::vector<double> numbers(const Eigen::VectorXd& v) { return {v.begin(), v.end()}; }

PrincipalModes modes_of(const BodiesMean& mean, const Study& study, Report& report) {
  PrincipalModes modes(mean.moving.curves, mean.moving.members, study.part);
  report.say("Modes:");
  report.figure("variances", "variances", numbers(modes.model().variances()));
  report.figure("pace_weight", "weight of pace", modes.features().pace_weight());
  return modes;
}

/// With its pace, where pace is among what is compared.
Eigen::MatrixXd points_of(const RegisteredMotion& motion, MotionPart part) {
  return part == MotionPart::all || part == MotionPart::pace ? motion.points_at_own_pace() : motion.points();
}

/// The largest share of the triangles, over the frames, whose side turned over against the mean's at the same time on its
/// clock.
double turned_over(const BodiesMean& mean, const RegisteredMotion& motion, int frames) {
  const Faces& faces = mean.faces();
  const std::vector<Mat3X> normal = mean.moving.frames(frames), other = mean.moving.frames(motion.points(), frames);
  double most = 0;
  for (std::size_t k = 0; k < normal.size(); ++k) {
    int turned = 0;
    const auto side = [&](const Mat3X& x, Index f) -> Vec3d {
      return (x.col(faces(1, f)) - x.col(faces(0, f))).cross(x.col(faces(2, f)) - x.col(faces(0, f)));
    };
    for (Index f = 0; f < faces.cols(); ++f) turned += side(normal[k], f).dot(side(other[k], f)) <= 0;
    most = std::max(most, turned / double(faces.cols()));
  }
  return most;
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
         "set key right top\nset ylabel 'distance'\nplot $generalisation pt 7 title 'generalisation: a member to the "
         "model of the others', $specificity pt 5 title 'specificity: a sample to the nearest member'\n";
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
          mean.animation(points_of(modes.at(modes.deviations(k, deviations)), study.part), message("mode ", k + 1)),
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
  const Index count = std::min<Index>(study.modes, modes.model().modes());
  const Eigen::MatrixXd scores = random_scores(modes.model(), count, study.samples, settings.seed);
  const Mat3X colors = mean.colors();
  Scene scene;
  std::vector<double> slopes, folds;
  for (Index i = 0; i < scores.cols(); ++i) {
    const RegisteredMotion motion = modes.at(scores.col(i));
    slopes.push_back(motion.warp.min_slope());
    folds.push_back(turned_over(mean, motion, settings.frames));
    if (!out.empty()) scene.add(mean.animation(points_of(motion, study.part), message("sample ", i + 1)), colors);
  }
  report.say("Samples:");
  report.figure("sample_min_slope", "smallest slope of the time warp of each", slopes);
  report.figure("sample_turned_over", "largest share of triangles turned over against the mean", folds);
  if (out.empty()) return report.say("  No animation was written: give -o FILE.glb for one.");
  scene.write(out);
  report.wrote("samples", out);
}

void distances(const Group& group, const Study& study, const Settings& settings, Report& report) {
  const std::vector<std::string> words = of_members(study.labels, group, "labels");
  const std::vector<double> covariate = of_members(study.covariate, group, "values of the covariate");
  const BodiesMean mean = mean_of_bodies(group, settings, report);
  const PrincipalModes modes = modes_of(mean, study, report);
  const Eigen::MatrixXd d = distance_matrix(modes.features().members());
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
    const Regression r = regress(modes.model().scores(), covariate, 999, settings.seed);
    report.figure("explained", "share of the variance that the covariate explains", r.explained);
    report.figure("regression_p_value", "its p value, 999 permutations", r.test.p_value);
    report.figure("slope", "scores by unit of the covariate", numbers(r.slope));
  }
  if (study.csv.empty()) return;
  write_file_atomically(study.csv, csv.str());
  report.wrote("csv", study.csv);
}

}  // namespace dsns::program
