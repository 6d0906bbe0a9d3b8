// evaluate temporal: known warps of real sequences recovered, and pairs of sequences brought to one pace.
#include "temporal_curves.hpp"
#include "temporal_experiments.hpp"

#include <dsns/elastic/temporal_registration.hpp>
#include <dsns/io/atomic_file.hpp>
#include <dsns/nn/warp_network.hpp>

#include <iostream>

namespace dsns::program {

namespace {

template <class W>
RecoveryRow row_of(const std::string& file, const MotionCurve& source, const std::string& method, int number,
                   const Moving& moving, const W& warp, const TimeWarp& truth, double seconds) {
  return {file, source.surface, method, source.samples, number, moving.miss(warp, truth), seconds};
}

/// All methods on one warp of a function.
void recover(const std::string& file, const MotionCurve& source, int number, const Moving& moving,
             const TimeWarp& truth, const TemporalEvaluation& evaluation, std::vector<RecoveryRow>& rows) {
  const Curve second = warped(source.curve, truth);
  const auto add = [&](const std::string& method, const auto& warp, double seconds) {
    rows.push_back(row_of(file, source, method, number, moving, warp, truth, seconds));
  };
  add("before", TimeWarp(), 0);
  const Stopwatch dp;
  const auto path =
      dynamic_programming_warp(source.curve, second, {.samples = source.samples == 0 ? 200 : source.samples});
  add("dp", path, dp.seconds());
  if (number < evaluation.networks && source.samples == 0) {
    const Stopwatch network;
    const WarpFit fit = fit_warp_network([&](double t) { return srvf_rate(source.curve, t).value; },
                                         [&](double t) { return srvf_rate(second, t); });
    add("network", fit.warp, network.seconds());
  }
  const Stopwatch ours;
  const TimeWarp found = register_temporally(source.curve, second).warp;
  add("ours", found, ours.seconds());
}

/// The same where only samples of both curves are known: as 4D Atlas takes them, and through their splines.
void recover_raw(const std::string& file, const Curve& curve, int samples, int number, const Moving& moving,
                 const TimeWarp& truth, std::vector<RecoveryRow>& rows) {
  const std::vector<double> times = equidistant_times(samples);
  Eigen::MatrixXd first(curve.dimension(), samples), second(curve.dimension(), samples);
  for (int k = 0; k < samples; ++k) {
    first.col(k) = curve(times[std::size_t(k)]);
    second.col(k) = curve(truth(times[std::size_t(k)]));
  }
  const MotionCurve source{"raw", samples, samples, curve_through(first, times)};
  const Stopwatch dp;
  const auto path = dynamic_programming_warp(first, second);
  rows.push_back(row_of(file, source, "dp", number, moving, path, truth, dp.seconds()));
  const Stopwatch ours;
  const TimeWarp found = register_temporally(source.curve, curve_through(second, times)).warp;
  rows.push_back(row_of(file, source, "ours", number, moving, found, truth, ours.seconds()));
}

std::vector<RecoveryRow> recover_all(const std::string& file, const Settings& settings,
                                     const TemporalEvaluation& evaluation, Report& report) {
  ProgressLine line;
  const Body body = load_body(file, settings, report, std::ref(line));
  const std::vector<MotionCurve> sources = curves_of(body, {0, 50, 25}, settings, report);
  std::vector<RecoveryRow> rows;
  for (const MotionCurve& source : sources) {
    const Moving moving(source.curve);
    if (source.samples == 0) {
      report.say(message("  ", source.curve.dimension(), " principal components; the curve stands still for ",
                         100 * moving.rests, " % of the time, which is left out"));
    }
    for (int k = 0; k < evaluation.warps; ++k) {
      const TimeWarp truth = random_pace(evaluation, k, settings);
      recover(file, source, k, moving, truth, evaluation, rows);
      if (source.samples == 0)
        for (const int samples : {50, 25}) recover_raw(file, source.curve, samples, k, moving, truth, rows);
      line("warps", double(k + 1) / evaluation.warps);
    }
  }
  for (const RecoveryRow& row : rows) {
    report.row("rows");
    report.note("file", row.file);
    report.note("surface", row.surface);
    report.note("method", row.method);
    report.note("samples", std::int64_t(row.samples == 0 ? body.normalized.sequence.frame_count() : row.samples));
    report.note("all_frames", row.samples == 0);
    report.note("warp", std::int64_t(row.warp));
    report.note("warp_l2", row.warp_l2);
    report.note("seconds", row.seconds);
  }
  report.row("sequences");
  report.note("file", file);
  report.note("frames", std::int64_t(body.normalized.sequence.frame_count()));
  report.note("components", std::int64_t(sources.front().curve.dimension()));
  report.note("rests", Moving(sources.front().curve).rests);
  return rows;
}

template <class Rows>
void write_tables(const Rows& rows, const TemporalEvaluation& evaluation, Report& report) {
  report.section("");
  const std::string table = markdown(rows);
  report.say("\n" + table);
  if (!evaluation.csv.empty()) write_file_atomically(evaluation.csv, csv(rows));
  if (!evaluation.markdown.empty()) write_file_atomically(evaluation.markdown, table);
}

}  // namespace

int evaluate_temporal(const std::vector<std::string>& sources, const Settings& settings,
                      const TemporalEvaluation& evaluation, Report& report) {
  if (!evaluation.out.empty()) {
    std::error_code failure;
    std::filesystem::create_directories(evaluation.out, failure);
    require<FileError>(!failure, "folder '", evaluation.out.string(), "' cannot be created: ", failure.message());
  }
  const std::vector<std::string> names = sequences_of(sources);
  if (evaluation.experiment == TemporalExperiment::pairs) {
    const PairComparison comparison = compare_pairs(names, settings, evaluation, report);
    report.say(
        "Distances: root of the elastic energy of the curves of joint principal components; every body has a mean area "
        "of 1.\nTiming: RMS error of the warp, in shares of the clip, where both perform one clip and the second was "
        "warped.\nEvents: mean error of the warp at foot strikes, or at the opening and closing of jaws, where the "
        "clips differ.");
    write_tables(comparison.rows, evaluation, report);
    return comparison.failures;
  }
  int failures = 0;
  std::vector<RecoveryRow> rows;
  std::vector<StretchRow> stretches;
  for (const std::string& name : names) {
    try {
      if (evaluation.experiment == TemporalExperiment::stretches) {
        const std::vector<StretchRow> more = compare_stretches(name, settings, evaluation, report);
        stretches.insert(stretches.end(), more.begin(), more.end());
      } else {
        const std::vector<RecoveryRow> more = recover_all(name, settings, evaluation, report);
        rows.insert(rows.end(), more.begin(), more.end());
      }
    } catch (const Error& error) {
      ++failures;
      std::cout << std::flush;
      std::cerr << "dsns: " << error.what() << '\n';
      report.row("failures");
      report.note("file", name);
      report.note("reason", std::string(error.what()));
    }
  }
  report.say(message("Slopes of the warps from ", evaluation.strong ? "0.03 to 4" : "0.2 to 2.3",
                     "; errors are RMS, in shares of the clip."));
  if (evaluation.experiment == TemporalExperiment::stretches) {
    write_tables(stretches, evaluation, report);
    return failures;
  }
  write_tables(rows, evaluation, report);
  if (evaluation.out.empty() || rows.empty()) return failures;
  if (draw_boxes(rows, evaluation.out) && draw_paces(evaluation, settings)) {
    report.wrote("picture", evaluation.out / "temporal_warps.svg");
    report.wrote("paces", evaluation.out / "temporal_paces.svg");
  } else {
    report.say("No picture was drawn: gnuplot is not there (Debian: gnuplot-nox); its scripts are in " +
               evaluation.out.string() + ".");
  }
  return failures;
}

}  // namespace dsns::program
