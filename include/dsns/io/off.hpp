#pragma once
/// Meshes from OFF files (Geomview): OFF, and its kinds with normals, colours or texture coordinates, as text.
#include <dsns/io/file_bytes.hpp>
#include <dsns/io/mesh_builder.hpp>

#include <string>
#include <string_view>
#include <vector>

namespace dsns {

namespace detail {

/// `path` is what messages call the text.
inline TriangleMesh parse_off(std::string_view text, const std::filesystem::path& path) {
  const std::size_t size = text.size();
  int number = 0;
  const auto check = [&](bool ok, const auto&... what) {
    require<FileError>(ok, path.string(), ", line ", number, ": ", what...);
  };
  // The next line that says something.
  const auto next = [&]() -> std::string_view {
    while (!text.empty()) {
      ++number;
      std::string_view line = next_line(text);
      line = line.substr(0, line.find('#'));
      if (line.find_first_not_of(" \t\r") != std::string_view::npos) return line;
    }
    check(false, "the file ends too early: export it again");
    return {};
  };
  std::string_view line = next();
  const std::string_view kind = next_word(line);
  const auto off = kind.find("OFF");
  check(off != std::string_view::npos && off + 3 == kind.size() && off <= 4, "'", kind.substr(0, 20),
        "' is no OFF header: give an OFF file");
  check(kind.find('4') == std::string_view::npos && kind.find('n') == std::string_view::npos,
        "vertices have other than three coordinates (", kind, "): export the mesh in three dimensions");
  std::string_view rest = line;
  check(next_word(rest) != "BINARY", "the file is binary: export it as text");
  if (next_word(rest = line).empty()) line = next();
  long vertices = 0, faces = 0;
  check(parse_number(next_word(line), vertices) && parse_number(next_word(line), faces) && vertices >= 0 && faces >= 0,
        "expected the numbers of vertices and faces");
  check(std::size_t(vertices) <= size && std::size_t(faces) <= size, "claims ", vertices, " vertices and ", faces,
        " faces in ", size, " bytes: the file is damaged, export it again");
  MeshBuilder mesh(path);
  for (long v = 0; v < vertices; ++v) {
    line = next();
    Vec3d p;
    for (double& x : p) {
      const auto word = next_word(line);
      check(parse_number(word, x) && std::isfinite(x), "'", word.substr(0, 20), "' is not a finite coordinate");
    }
    mesh.add_vertex(p);
  }
  std::vector<int> corners;
  for (long f = 0; f < faces; ++f) {
    line = next();
    int count = 0;
    check(parse_number(next_word(line), count) && count >= 0 && std::size_t(count) <= line.size(),
          "expected the number of a face's vertices, and them");
    corners.assign(std::size_t(count), 0);
    for (int& v : corners) {
      const auto word = next_word(line);
      check(parse_number(word, v) && v >= 0 && v < vertices, "'", word.substr(0, 20), "' is not one of the ", vertices,
            " vertices, counted from 0");
    }
    if (count >= 3) mesh.add_polygon(corners);  // others are points and edges
  }
  return mesh.mesh();
}

}  // namespace detail

/// Vertices and faces of an OFF file; polygons become fans of triangles, normals and colours are ignored.
/// throws   FileError that names the file and the line
inline TriangleMesh read_off(const std::filesystem::path& path) {
  return detail::parse_off(detail::read_whole_file(path), path);
}

}  // namespace dsns
