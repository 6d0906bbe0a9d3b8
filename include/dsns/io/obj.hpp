#pragma once
/// A moving mesh as a folder of Wavefront OBJ files, one a frame.
#include <dsns/core/errors.hpp>
#include <dsns/mesh/triangle_mesh.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

namespace dsns {

namespace detail {

inline std::string_view next_word(std::string_view& line) {
  constexpr std::string_view blanks = " \t\r";
  line.remove_prefix(std::min(line.find_first_not_of(blanks), line.size()));
  const auto word = line.substr(0, line.find_first_of(blanks));
  line.remove_prefix(word.size());
  return word;
}

template <class T>
bool parse_number(std::string_view word, T& value) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  const auto [end, failure] = std::from_chars(word.data(), word.data() + word.size(), value);
  return failure == std::errc{} && end == word.data() + word.size();
}

/// Names in the order of their numbers: frame_2 before frame_10.
inline bool natural_less(std::string_view a, std::string_view b) {
  const auto is_digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
  const auto number = [&](std::string_view& s) {
    const auto end = std::find_if_not(s.begin(), s.end(), is_digit);
    auto digits = s.substr(0, static_cast<std::size_t>(end - s.begin()));
    s.remove_prefix(digits.size());
    digits.remove_prefix(std::min(digits.find_first_not_of('0'), digits.size()));
    return digits;
  };
  const std::string_view whole_a = a, whole_b = b;
  while (!a.empty() && !b.empty()) {
    if (is_digit(a.front()) && is_digit(b.front())) {
      const auto x = number(a), y = number(b);
      if (x != y) return x.size() != y.size() ? x.size() < y.size() : x < y;
    } else {
      if (a.front() != b.front()) return a.front() < b.front();
      a.remove_prefix(1);
      b.remove_prefix(1);
    }
  }
  return a.empty() != b.empty() ? a.empty() : whole_a < whole_b;
}

}  // namespace detail

/// Vertices and faces of an OBJ file; polygons become fans of triangles, everything else is ignored.
/// throws   FileError that names the file and the line
inline TriangleMesh read_obj(const std::filesystem::path& path) {
  std::ifstream file(path);
  require<FileError>(file.good() && !std::filesystem::is_directory(path), path.string(),
                     " cannot be read: check that it exists and is an OBJ file");
  std::vector<Vec3d> points;
  std::vector<std::array<int, 3>> triangles;
  std::string text;
  for (int number = 1; std::getline(file, text); ++number) {
    std::string_view line = text;
    const auto kind = detail::next_word(line);
    const auto check = [&](bool ok, const auto&... what) {
      require<FileError>(ok, path.string(), ", line ", number, ": ", what...);
    };
    if (kind == "v") {
      Vec3d p;
      for (double& x : p) {
        const auto word = detail::next_word(line);
        check(detail::parse_number(word, x) && std::isfinite(x), "'", word, "' is not a finite coordinate");
      }
      points.push_back(p);
    } else if (kind == "f") {
      std::vector<int> corners;
      for (auto word = detail::next_word(line); !word.empty(); word = detail::next_word(line)) {
        int i = 0;
        const bool parsed = detail::parse_number(word.substr(0, word.find('/')), i);
        if (i < 0) i += static_cast<int>(points.size()) + 1;
        check(parsed && i >= 1 && i <= static_cast<int>(points.size()), "'", word, "' is not one of the ",
              points.size(), " vertices defined so far");
        corners.push_back(i - 1);
      }
      check(corners.size() >= 3, "a face of ", corners.size(), " vertices, give at least 3");
      for (std::size_t k = 2; k < corners.size(); ++k) triangles.push_back({corners[0], corners[k - 1], corners[k]});
    }
  }
  require<FileError>(!points.empty() && !triangles.empty(), path.string(), " has ", points.size(), " vertices and ",
                     triangles.size(), " faces: give an OBJ file with a mesh");
  TriangleMesh mesh{Mat3X(3, static_cast<Index>(points.size())), Faces(3, static_cast<Index>(triangles.size()))};
  for (std::size_t v = 0; v < points.size(); ++v) mesh.vertices.col(static_cast<Index>(v)) = points[v];
  for (std::size_t f = 0; f < triangles.size(); ++f)
    mesh.faces.col(static_cast<Index>(f)) = Eigen::Map<const Eigen::Vector3i>(triangles[f].data());
  return mesh;
}

/// All *.obj files of a folder in the order of their names (frame_2 before frame_10) as one sequence at 24 frames a
/// second.
/// throws   FileError where there are fewer than two frames or a frame's faces differ from the first one's
inline MeshSequence read_obj_sequence(const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  std::error_code failure;
  std::vector<fs::path> files;
  for (fs::directory_iterator entry(folder, failure), end; !failure && entry != end; entry.increment(failure))
    if (entry->path().extension() == ".obj") files.push_back(entry->path());
  require<FileError>(!failure, folder.string(), " cannot be read as a folder: ", failure.message());
  require<FileError>(files.size() >= 2, folder.string(), " holds ", files.size(),
                     " OBJ files, an animation needs at least 2");
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return detail::natural_less(a.filename().string(), b.filename().string());
  });
  MeshSequence sequence;
  for (const auto& path : files) {
    TriangleMesh mesh = read_obj(path);
    if (sequence.frames.empty()) sequence.faces = mesh.faces;
    require<FileError>(mesh.faces.cols() == sequence.faces.cols() && mesh.faces == sequence.faces &&
                           (sequence.frames.empty() || mesh.vertices.cols() == sequence.vertex_count()),
                       path.string(), " has other faces or vertices (", mesh.vertices.cols(), " vertices, ",
                       mesh.faces.cols(), " faces) than ", files.front().filename().string(),
                       ": all frames of a sequence share one connectivity");
    sequence.frames.push_back(std::move(mesh.vertices));
  }
  sequence.duration = (sequence.frame_count() - 1) / 24.0;
  const fs::path normal = (folder / "").lexically_normal();
  sequence.name = normal.parent_path().filename().string();
  return sequence;
}

}  // namespace dsns
