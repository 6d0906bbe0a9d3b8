// track: frames that do not share their triangles, such as scans, as one moving mesh.
#include "commands.hpp"
#include "registration.hpp"
#include "scene.hpp"

#include <dsns/io/frames.hpp>
#include <dsns/stats/frame_registration.hpp>

namespace dsns::program {

namespace {

/// Of the squared norm, left from one frame to the next, above which the result is doubtful.
constexpr double doubtful = 0.1;

struct FrameFiles {
  std::vector<std::filesystem::path> files;
  double duration;  ///< seconds
};

FrameFiles files_of(const std::filesystem::path& folder, const std::filesystem::path& out, const Settings& settings) {
  namespace fs = std::filesystem;
  require<FileError>(fs::is_directory(folder), folder.string(),
                     fs::exists(folder) ? " is no folder" : " does not exist",
                     ": give a folder of OBJ, OFF or PLY frames");
  if (!out.empty())
    for (fs::path above = fs::weakly_canonical(out).parent_path(); above != above.parent_path();
         above = above.parent_path())
      require<FileError>(above != fs::canonical(folder), "cannot write ", out.string(), ": it lies in ",
                         folder.string(), ", the folder that is read; name a file outside of it");
  const std::vector<fs::path> all = frame_files(folder, {".obj", ".off", ".ply"});
  require<FileError>(all.size() >= 2, folder.string(), " holds ", all.size(),
                     " OBJ, OFF or PLY files, a moving mesh needs at least 2");
  const auto wanted = static_cast<std::size_t>(settings.frames);
  const double duration = double(all.size() - 1) / (settings.rate > 0 ? settings.rate : 24);
  if (wanted == 0 || all.size() <= wanted) return {all, duration};
  std::vector<fs::path> kept;
  for (std::size_t k = 0; k < wanted; ++k) kept.push_back(all[k * (all.size() - 1) / (wanted - 1)]);
  return {kept, duration};
}

/// A frame as one closed surface; what was done to it is told.
MeshSequence read_frame(const std::filesystem::path& file, const Settings& settings, Report& report) {
  TriangleMesh mesh = read_mesh(file);
  MeshSequence still;
  still.name = file.string();
  still.faces = std::move(mesh.faces);
  still.frames = {std::move(mesh.vertices)};
  RepairResult repaired = repaired_surface(still, settings);
  std::string done;
  for (const std::string& action : repaired.actions) done += (done.empty() ? "" : "; ") + action;
  if (!done.empty()) report.say("  " + file.filename().string() + ": " + done);
  return std::move(repaired.sequence);
}

}  // namespace

void track(const std::filesystem::path& folder, const std::filesystem::path& out, const Settings& settings,
           Report& report) {
  const FrameFiles given = files_of(folder, out, settings);
  const std::vector<std::filesystem::path>& files = given.files;
  report.say(message(folder.string(), ": ", files.size(), " frames"));
  std::vector<MeshSequence> frames;
  for (const auto& file : files) frames.push_back(read_frame(file, settings, report));
  const Faces& faces = frames.front().faces;
  if (std::all_of(frames.begin(), frames.end(), [&](const MeshSequence& frame) {
        return frame.vertex_count() == frames.front().vertex_count() && frame.faces.cols() == faces.cols() &&
               frame.faces == faces;
      }))
    report.say("  Note: all frames have the same triangles; every other command reads the folder as it is.");

  FrameRegistrationOptions options;
  options.spatial.threads = settings.threads;
  options.views = settings.views;
  FrameRegistration tracked = [&] {
    ProgressLine line;
    return register_frames(frames, given.duration, options, std::ref(line));
  }();
  tracked.sequence.name = (folder / "").lexically_normal().parent_path().filename().string();

  double most = 0, least_jacobian = 1;
  std::string doubted;
  report.say("  frame: energy left from the one before, of its squared norm; smallest Jacobian of the sphere map");
  for (std::size_t k = 0; k < tracked.frames.size(); ++k) {
    const SpatialSummary& s = tracked.frames[k];
    const std::string name = files[k + 1].filename().string();
    const double left = s.energy_after / s.norm;
    report.row("rows");
    report.note("file", name);
    report.note("energy_left", left);
    report.note("min_jacobian", s.min_jacobian);
    report.say(message("  ", name, ": ", left, "; ", s.min_jacobian));
    most = std::max(most, left);
    least_jacobian = std::min(least_jacobian, s.min_jacobian);
    if (left > doubtful) doubted += (doubted.empty() ? "" : ", ") + name;
  }
  report.section("");
  report.figure("frames", "frames", tracked.sequence.frame_count());
  report.figure("vertices", "vertices, of the first frame", tracked.sequence.vertex_count());
  report.figure("duration", "duration, seconds", tracked.sequence.duration);
  report.figure("most_energy_left", "most energy left, of the squared norm", most);
  report.figure("min_jacobian", "smallest Jacobian", least_jacobian);
  if (!doubted.empty())
    report.say("  Note: frames that hardly match the one before: " + doubted +
               "; look at the colours there, or give frames that follow each other more closely.");
  if (out.empty()) return say_not_written(report);
  Scene scene;
  const Mat3X colors = position_colors(tracked.sequence.frames.front());
  scene.add(std::move(tracked.sequence), colors);
  scene.write(out);
  report.wrote("tracked", out);
}

}  // namespace dsns::program
