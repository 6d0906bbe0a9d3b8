#pragma once
/// Surfaces and unfinished fits as files.
#include "bodies.hpp"

#include <dsns/nn/surface_archive.hpp>
#include <dsns/nn/training_archive.hpp>

#include <filesystem>
#include <optional>

namespace dsns::program {

/// The file in which a fit keeps what it needs to go on, as the settings say.
class CheckpointFile {
 public:
  /// Reads the file where the fit is to go on from it and it is there. Must outlive what `options` returns.
  explicit CheckpointFile(const Settings& settings);
  CheckpointOptions options() const;

 private:
  std::filesystem::path path_;
  std::optional<Archive> stopped_;
};

template <class S>
Archive archive_of(const S& surface) {
  Archive archive;
  store_surface(archive, surface);
  return archive;
}

/// Writes a body's surface with what it takes to see it: its triangles on the sphere, size, root motion and duration.
void write_surface(const std::filesystem::path& out, Archive surface, const Body& body);
/// What a .dsns file holds.
void inspect_surface(const std::filesystem::path& path, Report& report);

}  // namespace dsns::program
