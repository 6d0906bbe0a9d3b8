// evaluate representation: fits of many sequences, their held-out errors, and where on the surface these are.
#include "commands.hpp"
#include "representation_tables.hpp"
#include "scene.hpp"

#include <dsns/io/atomic_file.hpp>
#include <dsns/io/frames.hpp>
#include <dsns/io/gltf_reader.hpp>
#if defined(DSNS_WITH_HDF5)
#include <dsns/io/hdf5.hpp>
#endif
#include <dsns/io/source_name.hpp>
#include <dsns/surface/sampled.hpp>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <iostream>

extern char** environ;

namespace dsns::program {

namespace {

namespace fs = std::filesystem;

/// The clips of a file by name; the file itself where it cannot be read, so that reading it says why.
std::vector<std::string> sequences_in(const fs::path& file) {
  std::vector<std::string> names;
  const std::string extension = lower_extension(file);
  try {
    if (extension == ".glb" || extension == ".gltf")
      for (const ClipInfo& clip : gltf_clips(file)) names.push_back(file.string() + "#" + clip.name);
#if defined(DSNS_WITH_HDF5)
    if (extension == ".hdf5" || extension == ".h5")
      for (const std::string& name : dfaust_sequences(file)) names.push_back(file.string() + "#" + name);
#endif
  } catch (const FileError&) {
  }
  return names.empty() ? std::vector<std::string>{file.string()} : names;
}

/// A folder of frames is one sequence; any other folder stands for all that can be read in it and in the folders below.
std::vector<std::string> expanded(const std::string& name) {
  if (!fs::is_directory(name)) return {name};
  std::vector<fs::path> entries;
  for (const auto& entry : fs::directory_iterator(name)) {
    const std::string extension = lower_extension(entry.path());
    for (const char* of_frames : {".obj", ".off", ".ply", ".npz"})
      if (extension == of_frames) return {name};
    entries.push_back(entry.path());
  }
  std::sort(entries.begin(), entries.end());
  std::vector<std::string> names;
  const std::array<std::string, 6> readable{".glb", ".gltf", ".npy", ".mat", ".hdf5", ".h5"};
  for (const fs::path& entry : entries) {
    std::vector<std::string> found;
    if (fs::is_directory(entry))
      found = expanded(entry.string());
    else if (std::find(readable.begin(), readable.end(), lower_extension(entry)) != readable.end())
      found = sequences_in(entry);
    names.insert(names.end(), found.begin(), found.end());
  }
  return names;
}

OtherFrames on_other_frames(const Body& body, int trained, const Settings& settings) {
  ProgressLine line;
  const int all = body.normalized.sequence.frame_count();
  const std::vector<int> few = spread_frames(all, trained);
  std::vector<int> others;
  for (int k = 0; k < all; ++k)
    if (!std::binary_search(few.begin(), few.end(), k)) others.push_back(k);
  const Fitted fit = fit_frames(body, few, settings, std::ref(line));
  const SampledSurface truth(body.normalized.sequence, body.sphere.vertices),
      interpolation(frames_alone(body, few), body.sphere.vertices, frame_times(body, few));
  const Mat3X s = held_out_points(body, settings);
  OtherFrames out{fit.figures};
  const double samples = 3 * double(s.cols()) * double(others.size()) * std::pow(unit_of(body), 2);
  const SampledSurface::Hits hits = truth.locate(s);
  for (const double t : frame_times(body, others)) {
    const Mat3X x = truth.positions(hits, t);
    const Mat3X y = std::visit([&](const auto& surface) { return surface.positions(s, t); }, fit.surface);
    out.msd += (y - x).squaredNorm() / samples;
    out.msd_interpolation += (interpolation.positions(hits, t) - x).squaredNorm() / samples;
  }
  return out;
}

/// From dark blue over green and yellow to red.
Vec3d heat(double share) {
  const double x = std::clamp(share, 0.0, 1.0);
  const auto bump = [&](double middle, double width) {
    return std::clamp(1.5 - std::abs(x - middle) / width, 0.0, 1.0);
  };
  return {bump(0.9, 0.28), bump(0.5, 0.28), bump(0.1, 0.28)};
}

/// Draws a file with the project's script, if that is there.
bool draw(const fs::path& file, const fs::path& picture) {
#if defined(DSNS_RENDER)
  if (!fs::exists(DSNS_RENDER)) return false;
  std::string script = DSNS_RENDER, from = file.string(), to = picture.string();
  std::array<char*, 4> arguments{script.data(), from.data(), to.data(), nullptr};
  posix_spawn_file_actions_t quiet;  // what it has to say is whether there is a picture
  posix_spawn_file_actions_init(&quiet);
  for (const int stream : {STDOUT_FILENO, STDERR_FILENO})
    posix_spawn_file_actions_addopen(&quiet, stream, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const int failed = posix_spawn(&child, script.c_str(), &quiet, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&quiet);
  int status = 0;
  return failed == 0 && waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
#else
  return false;
#endif
}

std::string file_stem(const std::string& name) {
  const SourceName source = parse_source(name);
  std::string stem = source.file.stem().string() + (source.clip.empty() ? "" : "_" + source.clip);
  for (char& c : stem)
    if (std::string_view("/\\|:*?\"<> ").find(c) != std::string_view::npos) c = '_';
  return stem;
}

/// The fitted surface, coloured by its error.
void write_heat_map(const std::string& name, const Body& body, const Fitted& fit, const fs::path& folder,
                    Report& report) {
  constexpr int most_frames = 48;
  const MeshSequence& sequence = body.normalized.sequence;
  const std::vector<int> frames = spread_frames(sequence.frame_count(), most_frames);
  const std::vector<double> times = frame_times(body, frames);
  const double unit = unit_of(body);
  std::vector<Mat3X> shown;
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(sequence.vertex_count());
  Mat3X way(3, Index(frames.size()));
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const auto at = [&](const auto& surface) { return surface.positions(body.sphere.vertices, times[k]); };
    shown.push_back(std::visit(at, fit.surface));
    squares += (shown.back() - sequence.frames[std::size_t(frames[k])]).colwise().squaredNorm().transpose();
    way.col(Index(k)) =
        (body.normalized.trajectory.col(frames[k]) - body.normalized.trajectory.col(0)) / body.normalized.scale;
  }
  const double full = 4 * fit.figures.error.rms_distance;
  Mat3X colors(3, squares.size());
  for (Index v = 0; v < squares.size(); ++v)
    colors.col(v) = heat(std::sqrt(squares[v] / double(frames.size())) / unit / full);
  Scene scene;
  scene.add(denormalize(shown, sequence.faces, way, body.normalized.scale, sequence.duration, sequence.name), colors);
  const fs::path file = folder / (file_stem(name) + "_error.glb");
  scene.write(file);
  report.note("heat_map_full", full);
  report.say(message("  Colours: RMS distance of each vertex over time, blue for 0, green for ", full / 2, ", red for ",
                     full, " and more (four times that of all points)."));
  report.wrote("heat_map", file);
  fs::path picture = file;
  picture.replace_extension(".png");
  if (draw(file, picture))
    report.wrote("picture", picture);
  else
    report.say("  No picture was drawn: scripts/render is not there or needs VTK (Debian: python3-vtk9 xvfb).");
}

RepresentationRow evaluate_one(const std::string& name, const Settings& settings,
                               const RepresentationEvaluation& evaluation, Report& report) {
  ProgressLine line;
  const Body body = load_body(name, settings, report, std::ref(line));
  const int all = body.normalized.sequence.frame_count();
  const Fitted fit = fit_frames(body, spread_frames(all, all), settings, std::ref(line));
  RepresentationRow row{name, fit.figures, std::nullopt};
  if (evaluation.frames_trained > 0 && all > evaluation.frames_trained)
    row.others = on_other_frames(body, evaluation.frames_trained, settings);
  report.row("rows");
  report.note("file", name);
  report_fit(row.fit, report);
  if (row.others) {
    report.figure("frames_trained", "trained on fewer frames", row.others->fit.frames);
    report.figure("msd_other_frames", "mean squared error on the others", row.others->msd);
    report.figure("msd_interpolation", "of cubic interpolation of each vertex", row.others->msd_interpolation);
    report.figure("ratio_to_interpolation", "ratio of these", row.others->ratio());
    report.figure("cpu_seconds_few", "CPU-seconds", row.others->fit.cpu_seconds);
  }
  if (!evaluation.out.empty()) write_heat_map(name, body, fit, evaluation.out, report);
  return row;
}

void report_summary(const RepresentationTable& table, Report& report) {
  report.section("summary");
  report.say(message("Summary of ", table.rows.size(), ":"));
  report.figure("sequences", "sequences", table.rows.size());
  const auto figures = [&](const std::string& key, const std::string& label, const auto& quantity) {
    const Spread s = spread(column(table.rows, quantity));
    report.figure(key + "mean", label + ", mean", s.mean);
    report.figure(key + "std", "  standard deviation", s.std);
    report.figure(key + "median", "  median", s.median);
  };
  figures("", "mean squared coordinate error", [](const auto& row) { return row.fit.error.msd; });
  figures("rms_distance_heldout.", "RMS distance", [](const auto& row) { return row.fit.error.rms_distance; });
  figures("max_distance_heldout.", "largest distance", [](const auto& row) { return row.fit.error.max_distance; });
  figures("normal_angle_mean_deg.", "angle to the flat faces' normals",
          [](const auto& row) { return row.fit.error.normal_angle_mean_deg; });
  figures("smooth_normal_angle_mean_deg.", "angle to interpolated normals",
          [](const auto& row) { return row.fit.error.smooth_normal_angle_mean_deg; });
  figures("wall_seconds.", "seconds of a fit", [](const auto& row) { return row.fit.wall_seconds; });
  std::vector<double> others, ratios;
  for (const RepresentationRow& row : table.rows)
    if (row.others) others.push_back(row.others->msd), ratios.push_back(row.others->ratio());
  if (others.empty()) return;
  report.figure("msd_other_frames.mean", "mean squared error on other frames, mean", spread(others).mean);
  report.figure("msd_other_frames.std", "  standard deviation", spread(others).std);
  report.figure("msd_other_frames.median", "  median", spread(others).median);
  report.figure("ratio_to_interpolation.mean", "ratio to cubic interpolation, mean", spread(ratios).mean);
}

}  // namespace

std::vector<std::string> sequences_of(const std::vector<std::string>& sources) {
  std::vector<std::string> names;
  for (const std::string& source : sources)
    for (std::string& name : expanded(source)) names.push_back(std::move(name));
  require<FileError>(!names.empty(), sources.front(),
                     " holds no animation that can be read: give GLB files or folders of OBJ frames");
  return names;
}

int evaluate_representation(const std::vector<std::string>& sources, const Settings& settings,
                            const RepresentationEvaluation& evaluation, Report& report) {
  if (!evaluation.out.empty()) {
    std::error_code failure;
    fs::create_directories(evaluation.out, failure);
    require<FileError>(!failure, "folder '", evaluation.out.string(), "' cannot be created: ", failure.message());
  }
  say_preset(settings, report);
  RepresentationTable table;
  table.frames_trained = evaluation.frames_trained;
  table.conditions = message("Preset ", word(settings.preset),
                             settings.seconds > 0 ? message(", ", settings.seconds, " seconds a fit") : std::string(),
                             ", ", settings.threads, settings.threads == 1 ? " thread." : " threads.");
  for (const std::string& name : sequences_of(sources)) {
    try {
      table.rows.push_back(evaluate_one(name, settings, evaluation, report));
    } catch (const std::exception& error) {
      table.failures.push_back({name, error.what()});
      std::cout << std::flush;
      std::cerr << "dsns: " << error.what() << '\n';
      report.row("failures");
      report.note("file", name);
      report.note("reason", std::string(error.what()));
    }
  }
  if (!table.rows.empty()) report_summary(table, report);
  say_fit_units(report);
  report.section("");
  if (!evaluation.csv.empty()) write_file_atomically(evaluation.csv, csv(table));
  if (!evaluation.markdown.empty()) write_file_atomically(evaluation.markdown, markdown(table));
  return static_cast<int>(table.failures.size());
}

}  // namespace dsns::program
