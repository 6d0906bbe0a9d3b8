#pragma once
/// Archives as files: what is read is whole, what is written replaces the old file at once or not at all.
#include <dsns/core/archive.hpp>
#include <dsns/io/atomic_file.hpp>
#include <dsns/io/file_bytes.hpp>

namespace dsns {

/// A process that is killed while it writes leaves the old file, and perhaps a hidden one beside it, .dsns_*.part.
/// throws   FileError; the old file is then untouched
inline void write_archive(const std::filesystem::path& path, const Archive& archive) {
  write_file_atomically(path, to_bytes(archive));
}

/// throws   FileError, one sentence that begins with the file's name
inline Archive read_archive(const std::filesystem::path& path) {
  return parse_archive(detail::read_whole_file(path), path.string());
}

}  // namespace dsns
