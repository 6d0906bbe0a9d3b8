#include "bodies.hpp"
#include "checkpoint.hpp"

#include <dsns/core/spline.hpp>
#include <dsns/io/frame_writer.hpp>
#include <dsns/io/gltf.hpp>
#if defined(DSNS_WITH_HDF5)
#include <dsns/io/hdf5.hpp>
#endif
#include <dsns/io/npy.hpp>
#include <dsns/io/source_name.hpp>
#include <dsns/mesh/join_pieces.hpp>
#include <dsns/mesh/spherical_parameterization.hpp>
#include <dsns/surface/sampled.hpp>

namespace dsns::program {

namespace {

/// At most so many equidistant frames, if positive.
void thin_out(Source& source, int frames) {
  if (frames == 0) return;
  std::vector<Mat3X>& all = source.sequence.frames;
  const auto found = all.size(), wanted = static_cast<std::size_t>(frames);
  if (found <= wanted) return;
  std::vector<Mat3X> kept;
  for (std::size_t k = 0; k < wanted; ++k) kept.push_back(std::move(all[k * (found - 1) / (wanted - 1)]));
  all = std::move(kept);
  source.notes.push_back(message("took ", wanted, " of them, see --frames"));
}

TriangleMesh mesh_with_faces(const std::string& name, const Settings& settings) {
  require(!settings.faces.empty(), name, " holds vertices alone: name a mesh with their faces, --faces FILE.obj");
  return read_mesh(settings.faces);
}

/// DFAUST's sequences by name, or MATLAB's grids.
MeshSequence read_hdf5([[maybe_unused]] const SourceName& source, [[maybe_unused]] const Settings& settings) {
#if defined(DSNS_WITH_HDF5)
  if (lower_extension(source.file) == ".mat")
    return read_matlab_grids(source.file, settings.rate > 0 ? settings.rate : 24);
  return read_dfaust(source.file, source.clip, settings.rate > 0 ? settings.rate : 60);
#else
  throw FileError(message(source.file.string(),
                          ": this program was built without HDF5; install it (Debian: libhdf5-dev) and "
                          "build again"));
#endif
}

}  // namespace

Source read_source(const std::string& name, const Settings& settings, Still still) {
  const SourceName parsed = parse_source(name);
  Source source;
  source.file = parsed.file;
  const double rate = settings.rate > 0 ? settings.rate : 24;
  const std::string extension = lower_extension(parsed.file);
  if (std::filesystem::is_directory(parsed.file)) {
    source.sequence = frame_files(parsed.file, {".npz"}).empty()
                          ? read_frames(parsed.file, rate)
                          : read_npz_frames(parsed.file, mesh_with_faces(name, settings), rate);
    source.notes.push_back(message("read ", source.sequence.frame_count(), " frames"));
    thin_out(source, settings.frames);
  } else if (extension == ".npy") {
    source.sequence = read_npy(parsed.file, mesh_with_faces(name, settings), rate);
    source.notes.push_back(message("read ", source.sequence.frame_count(), " frames"));
    thin_out(source, settings.frames);
  } else if (extension == ".hdf5" || extension == ".h5" || extension == ".mat") {
    source.sequence = read_hdf5(parsed, settings);
    source.notes.push_back(message("read ", source.sequence.frame_count(), " frames"));
    thin_out(source, settings.frames);
  } else if (still == Still::allowed && (extension == ".obj" || extension == ".off" || extension == ".ply")) {
    TriangleMesh mesh = read_mesh(parsed.file);
    source.sequence.faces = std::move(mesh.faces);
    source.sequence.frames = {std::move(mesh.vertices)};
    source.sequence.name = parsed.file.stem().string();
  } else {
    GltfReadOptions options;
    options.clip = parsed.clip;
    options.frames = settings.frames;
    options.rate = settings.rate > 0 || settings.frames > 0 ? settings.rate : 60;
    options.node = settings.node;
    options.allow_still = still == Still::allowed;
    GltfAnimation animation = read_gltf(parsed.file, options);
    source.sequence = std::move(animation.sequence);
    source.clip = animation.clip;
    const int frames = source.sequence.frame_count();
    source.notes.push_back(frames == 1 ? std::string("no animation, one frame")
                                       : message("clip '", animation.clip, "'",
                                                 animation.clip_chosen_by_default ? " (the first)" : "", ", ", frames,
                                                 " frames over ", source.sequence.duration, " s"));
  }
  return source;
}

RepairResult repaired_surface(const MeshSequence& sequence, const Settings& settings) {
  return settings.join ? repair_joined(sequence, settings.repair) : repair(sequence, settings.repair);
}

LoadedBody read_body(const std::string& name, const Settings& settings, const Progress& progress) {
  const Source source = read_source(name, settings);
  const RepairResult repaired = repaired_surface(source.sequence, settings);
  NormalizedSequence normalized = normalize(repaired.sequence);
  ParameterizationResult map = spherical_parameterization(normalized.sequence, {}, progress);
  std::vector<std::string> done = source.notes;
  done.insert(done.end(), repaired.actions.begin(), repaired.actions.end());
  done.push_back(message("mapped to the sphere: ", normalized.sequence.vertex_count(), " vertices, ",
                         map.certificate.flips, " flipped triangles, smallest area ratio ",
                         map.certificate.min_area_ratio));
  const TriangleMesh sphere{map.sphere, normalized.sequence.faces};
  AnyAnimatedSurface surface(SampledSurface(normalized.sequence, map.sphere));
  return {{std::move(normalized), sphere, map.certificate, std::move(surface), source.file,
           OwnMesh(source.sequence, repaired), source.sequence.faces},
          std::move(done)};
}

Body load_body(const std::string& name, const Settings& settings, Report& report, const Progress& progress) {
  LoadedBody loaded = read_body(name, settings, progress);
  report.say(name + ":");
  for (const auto& sentence : loaded.done) report.say("  " + sentence);
  return std::move(loaded.body);
}

void write_on_own_mesh(const std::filesystem::path& out, const Body& body, const MeshSequence& result,
                       const Settings& settings) {
  std::vector<Mat3X> frames;
  for (const Mat3X& frame : result.frames) frames.push_back(body.own.moved(frame));
  const std::string extension = lower_extension(out);
  if (extension == ".npy") return write_npy(out, frames);
  if (extension == ".glb")
    return write_gltf_own_mesh(out, body.file, frames, {result.duration, "motion", settings.node});
  const auto own_frames = std::filesystem::is_directory(body.file) ? frame_files(body.file, {".obj"})
                                                                   : std::vector<std::filesystem::path>();
  if (own_frames.empty())
    write_obj_frames(out, result.name, frames, body.own_faces);
  else
    write_obj_frames(out, result.name, frames, own_frames.front());
}

std::vector<Mat3X> frames_of(const AnyAnimatedSurface& surface, const Mat3X& sphere, int frames) {
  std::vector<Mat3X> out;
  for (int k = 0; k < frames; ++k) out.push_back(surface.positions(sphere, double(k) / (frames - 1)));
  return out;
}

MeshSequence denormalize(const std::vector<Mat3X>& frames, const Faces& faces, const Mat3X& trajectory, double scale,
                         double duration, const std::string& name) {
  MeshSequence out;
  out.faces = faces;
  out.duration = duration;
  out.name = name;
  for (std::size_t k = 0; k < frames.size(); ++k)
    out.frames.push_back(scale * (frames[k].colwise() + Vec3d(trajectory.col(Index(k)))));
  return out;
}

Mat3X relative_trajectory(const NormalizedSequence& body, const TimeWarp& warp, int frames) {
  const CubicSpline spline(body.trajectory.cols());
  Mat3X out(3, frames);
  for (int k = 0; k < frames; ++k) {
    const Vec3d place = body.trajectory * spline.weights(warp(double(k) / (frames - 1)));
    out.col(k) = (place - body.trajectory.col(0)) / body.scale;
  }
  return out;
}

}  // namespace dsns::program
