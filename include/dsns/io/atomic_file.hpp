#pragma once
/// Files that are either the old one or the complete new one, whatever happens in between.
#include <dsns/core/errors.hpp>

#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <string_view>
#include <system_error>

namespace dsns {

namespace detail {

inline void write_bytes(const std::filesystem::path& path, std::string_view bytes) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  require<FileError>(file.good(), path.string(), " cannot be written (", bytes.size(),
                     " bytes): check the permissions and the free space of its folder");
}

}  // namespace detail

/// Replaces the file by `bytes`: they are written under a temporary name in the same folder, which is then renamed.
/// A link keeps pointing where it did, permissions stay, and a device or pipe is simply written to.
/// throws   FileError; the old file is then untouched and no temporary is left [io/atomic_file_test]
inline void write_file_atomically(const std::filesystem::path& path, std::string_view bytes) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  require<FileError>(!path.filename().empty() && !fs::is_directory(path, ignored), "'", path.string(),
                     "' is a folder: give the name of a file to write");
  const bool replaces = fs::exists(path, ignored);
  const fs::path target = replaces ? fs::canonical(path) : path;
  if (replaces && !fs::is_regular_file(target)) return detail::write_bytes(target, bytes);
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  require<FileError>(fs::is_directory(folder, ignored), "folder '", folder.string(),
                     "' does not exist: create it, then ", path.filename().string(), " can be written there");
  const fs::path temporary = folder / message(".dsns_", std::hex, std::random_device{}(), ".part");
  try {
    detail::write_bytes(temporary, bytes);
    if (replaces) fs::permissions(temporary, fs::status(target).permissions());
    fs::rename(temporary, target);
  } catch (const fs::filesystem_error& failure) {
    fs::remove(temporary, ignored);
    throw FileError(message(path.string(), " cannot be replaced: ", failure.code().message()));
  } catch (...) {
    fs::remove(temporary, ignored);
    throw;
  }
}

}  // namespace dsns
