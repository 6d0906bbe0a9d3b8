#include "checkpoint.hpp"

#include <dsns/io/archive_file.hpp>

namespace dsns::program {

CheckpointFile::CheckpointFile(const Settings& settings) : path_(settings.checkpoint) {
  if (settings.resume && std::filesystem::exists(path_)) stopped_ = read_archive(path_);
}

CheckpointOptions CheckpointFile::options() const {
  CheckpointOptions options;
  if (path_.empty()) return options;
  options.every = 1;
  options.write = [path = path_](const Archive& archive) { write_archive(path, archive); };
  options.resume = stopped_ ? &*stopped_ : nullptr;
  return options;
}

void write_surface(const std::filesystem::path& out, Archive surface, const Body& body) {
  const MeshSequence& sequence = body.normalized.sequence;
  surface.set("motion.source", body.file.filename().string());
  surface.set("motion.name", sequence.name);
  surface.set("motion.duration", sequence.duration);
  surface.set("motion.unit", body.normalized.scale);
  surface.set("motion.trajectory", Eigen::MatrixXd(body.normalized.trajectory));
  surface.set("sphere.vertices", Eigen::MatrixXd(body.sphere.vertices));
  surface.set("sphere.cap_faces", sequence.cap_faces);  // the last ones
  surface.set("sphere.faces", Archive::Integers(body.sphere.faces.cast<std::int64_t>()));
  write_archive(out, surface);
}

void inspect_surface(const std::filesystem::path& path, Report& report) {
  const Archive archive = read_archive(path);
  surface_from(archive);  // throws where it cannot be used
  report.say(path.string() + ":");
  report.figure("surface", "surface", archive.text("surface"));
  const auto entries = [&](const char* name) {
    const auto found = archive.arrays().find(name);
    return found == archive.arrays().end() ? Index(0)
                                           : std::visit([](const auto& v) { return Index(v.size()); }, found->second);
  };
  report.figure(
      "parameters", "parameters",
      entries("network.parameters") + entries("harmonics") + entries("modes") + entries("radial.coefficients"));
  report.figure("scale", "radius of the ball that holds it", archive.number("scale"));
  if (archive.contains("motion.duration"))
    report.figure("duration", "duration, seconds", archive.number("motion.duration"));
  if (archive.contains("sphere.faces")) report.figure("faces", "faces of its mesh", entries("sphere.faces") / 3);
  if (archive.contains("training.steps"))
    report.figure("training_steps", "steps that its training has taken", archive.integer("training.steps"));
  std::vector<std::string> arrays;
  for (const auto& [name, value] : archive.arrays()) arrays.push_back(name);
  report.figure("arrays", "arrays", arrays);
}

}  // namespace dsns::program
