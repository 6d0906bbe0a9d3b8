#pragma once
/// A moving mesh as a folder of files, one a frame: OBJ, OFF or PLY.
#include <dsns/core/natural_order.hpp>
#include <dsns/io/obj.hpp>
#include <dsns/io/off.hpp>
#include <dsns/io/ply.hpp>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace dsns {

/// The extension of a file name with its dot, in small letters.
inline std::string lower_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

/// The files of a folder that have one of these extensions, in the order of their names (frame_2 before frame_10); hidden
/// ones are left out.
/// throws   FileError where the folder cannot be read or holds files of two kinds
inline std::vector<std::filesystem::path> frame_files(const std::filesystem::path& folder,
                                                      const std::vector<std::string>& extensions) {
  namespace fs = std::filesystem;
  std::error_code failure;
  std::vector<fs::path> files;
  for (fs::directory_iterator entry(folder, failure), end; !failure && entry != end; entry.increment(failure)) {
    const fs::path& path = entry->path();
    if (path.filename().string().rfind('.', 0) == 0) continue;
    if (std::find(extensions.begin(), extensions.end(), lower_extension(path)) != extensions.end())
      files.push_back(path);
  }
  require<FileError>(!failure, folder.string(), " cannot be read as a folder: ", failure.message());
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return detail::natural_less(a.filename().string(), b.filename().string());
  });
  for (const fs::path& path : files)
    require<FileError>(lower_extension(path) == lower_extension(files.front()), folder.string(), " holds ",
                       files.front().filename().string(), " and ", path.filename().string(),
                       ": give a folder with frames of one kind");
  return files;
}

/// A mesh by its file's extension: .obj, .off or .ply.
/// throws   FileError
inline TriangleMesh read_mesh(const std::filesystem::path& path) {
  const std::string extension = lower_extension(path);
  if (extension == ".obj") return read_obj(path);
  if (extension == ".off") return read_off(path);
  require<FileError>(extension == ".ply", path.string(), ": '", extension,
                     "' is not a kind of mesh that can be read: give .obj, .off or .ply");
  return read_ply(path);
}

/// All OBJ, OFF or PLY files of a folder, in the order of their names, as one sequence.
/// rate     frames a second
/// throws   FileError where there are fewer than two frames or a frame's faces differ from the first one's
inline MeshSequence read_frames(const std::filesystem::path& folder, double rate = 24) {
  require(rate > 0, "read_frames: ", rate, " frames a second, give a positive rate");
  const auto files = frame_files(folder, {".obj", ".off", ".ply"});
  require<FileError>(files.size() >= 2, folder.string(), " holds ", files.size(),
                     " OBJ, OFF or PLY files, an animation needs at least 2");
  MeshSequence sequence;
  for (const auto& path : files) {
    TriangleMesh mesh = read_mesh(path);
    if (sequence.frames.empty()) sequence.faces = mesh.faces;
    require<FileError>(mesh.faces.cols() == sequence.faces.cols() && mesh.faces == sequence.faces &&
                           (sequence.frames.empty() || mesh.vertices.cols() == sequence.vertex_count()),
                       path.string(), " has other faces or vertices (", mesh.vertices.cols(), " vertices, ",
                       mesh.faces.cols(), " faces) than ", files.front().filename().string(),
                       ": frames with triangles of their own become one sequence by `dsns track ", folder.string(),
                       " -o FILE.glb`, or by register_frames");
    sequence.frames.push_back(std::move(mesh.vertices));
  }
  sequence.duration = (sequence.frame_count() - 1) / rate;
  const std::filesystem::path normal = (folder / "").lexically_normal();
  sequence.name = normal.parent_path().filename().string();
  return sequence;
}

}  // namespace dsns
