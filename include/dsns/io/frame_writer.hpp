#pragma once
/// Moving vertices as a folder of Wavefront OBJ files, one a frame, or as one NumPy array.
#include <dsns/core/errors.hpp>
#include <dsns/core/types.hpp>
#include <dsns/io/atomic_file.hpp>

#include <algorithm>
#include <bit>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace dsns {

namespace detail {

inline void check_frames(const char* function, const std::vector<Mat3X>& frames) {
  require(!frames.empty(), function, ": no frames, give at least one");
  for (const Mat3X& frame : frames)
    require(frame.cols() == frames.front().cols() && frame.allFinite(), function, ": a frame has ", frame.cols(),
            " vertices (the first ", frames.front().cols(), ") or a position that is not finite");
}

/// The lines of an OBJ file, with those of vertices left empty in `text` and their numbers in `vertex_lines`.
struct ObjTemplate {
  std::vector<std::string> lines;
  std::vector<std::size_t> vertex_lines;
};
inline ObjTemplate read_obj_template(const std::filesystem::path& path) {
  std::ifstream file(path);
  require<FileError>(file.good(), path.string(), " cannot be read: check that it exists and is an OBJ file");
  ObjTemplate result;
  for (std::string line; std::getline(file, line);) {
    const auto start = line.find_first_not_of(" \t");
    if (start != std::string::npos && line[start] == 'v' && start + 1 < line.size() &&
        (line[start + 1] == ' ' || line[start + 1] == '\t'))
      result.vertex_lines.push_back(result.lines.size());
    result.lines.push_back(std::move(line));
  }
  return result;
}

inline std::string obj_vertex(const Vec3d& p) {
  std::ostringstream line;
  line.precision(9);
  line << "v " << p.x() << ' ' << p.y() << ' ' << p.z();
  return line.str();
}

inline void write_obj_frames(const std::filesystem::path& folder, const std::string& name,
                             const std::vector<Mat3X>& frames, const ObjTemplate& form) {
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  require<FileError>(std::filesystem::is_directory(folder), "folder '", folder.string(),
                     "' cannot be made: ", failure.message());
  for (std::size_t k = 0; k < frames.size(); ++k) {
    std::string text;
    std::size_t vertex = 0;
    for (std::size_t i = 0; i < form.lines.size(); ++i) {
      const bool is_vertex = vertex < form.vertex_lines.size() && form.vertex_lines[vertex] == i;
      text += is_vertex ? obj_vertex(frames[k].col(static_cast<Index>(vertex++))) : form.lines[i];
      text += '\n';
    }
    std::string number = std::to_string(k + 1);
    number.insert(0, 6 - std::min<std::size_t>(6, number.size()), '0');
    write_file_atomically(folder / (name + "." + number + ".obj"), text);
  }
}

}  // namespace detail

/// Writes folder/NAME.000001.obj and so on: each the file `like` with other vertices; its faces, texture coordinates and
/// materials stay.
/// throws   InvalidArgument for frames of another number of vertices than `like` has, FileError
inline void write_obj_frames(const std::filesystem::path& folder, const std::string& name,
                             const std::vector<Mat3X>& frames, const std::filesystem::path& like) {
  detail::check_frames("write_obj_frames", frames);
  const detail::ObjTemplate form = detail::read_obj_template(like);
  require(static_cast<Index>(form.vertex_lines.size()) == frames.front().cols(),
          "write_obj_frames: ", frames.front().cols(), " vertices, ", like.string(), " has ", form.vertex_lines.size());
  detail::write_obj_frames(folder, name, frames, form);
}

/// The same with nothing but faces.
inline void write_obj_frames(const std::filesystem::path& folder, const std::string& name,
                             const std::vector<Mat3X>& frames, const Faces& faces) {
  detail::check_frames("write_obj_frames", frames);
  detail::ObjTemplate form;
  for (Index v = 0; v < frames.front().cols(); ++v) form.vertex_lines.push_back(std::size_t(v));
  form.lines.resize(form.vertex_lines.size());
  for (Index f = 0; f < faces.cols(); ++f)
    form.lines.push_back(message("f ", faces(0, f) + 1, " ", faces(1, f) + 1, " ", faces(2, f) + 1));
  detail::write_obj_frames(folder, name, frames, form);
}

/// Writes a float32 array of shape (frames, vertices, 3) that numpy.load reads.
/// throws   InvalidArgument for frames of different sizes, FileError
inline void write_npy(const std::filesystem::path& path, const std::vector<Mat3X>& frames) {
  static_assert(std::endian::native == std::endian::little, "the array is little-endian");
  detail::check_frames("write_npy", frames);
  std::string header = message("{'descr': '<f4', 'fortran_order': False, 'shape': (", frames.size(), ", ",
                               frames.front().cols(), ", 3), }");
  header.append(63 - (10 + header.size()) % 64, ' ');  // the array starts at a multiple of 64 bytes
  header += '\n';
  std::string bytes("\x93NUMPY\x01\x00", 8);
  bytes += static_cast<char>(header.size() % 256);
  bytes += static_cast<char>(header.size() / 256);
  bytes += header;
  for (const Mat3X& frame : frames) {
    const Eigen::Matrix<float, 3, Eigen::Dynamic> numbers = frame.cast<float>();
    const std::size_t start = bytes.size(), size = sizeof(float) * static_cast<std::size_t>(numbers.size());
    bytes.resize(start + size);
    std::memcpy(bytes.data() + start, numbers.data(), size);
  }
  write_file_atomically(path, bytes);
}

}  // namespace dsns
