#pragma once
/// Meshes from Wavefront OBJ files.
#include <dsns/io/file_bytes.hpp>
#include <dsns/io/mesh_builder.hpp>

#include <cmath>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace dsns {

namespace detail {

/// `path` is what messages call the text.
inline TriangleMesh parse_obj(std::string_view text, const std::filesystem::path& path) {
  MeshBuilder mesh(path);
  std::vector<int> corners;
  for (int number = 1; !text.empty(); ++number) {
    std::string_view line = next_line(text);
    const auto kind = next_word(line);
    const auto check = [&](bool ok, const auto&... what) {
      require<FileError>(ok, path.string(), ", line ", number, ": ", what...);
    };
    if (kind == "v") {
      Vec3d p;
      for (double& x : p) {
        const auto word = next_word(line);
        check(parse_number(word, x) && std::isfinite(x), "'", word.substr(0, 20), "' is not a finite coordinate");
      }
      mesh.add_vertex(p);
    } else if (kind == "f") {
      corners.clear();
      for (auto word = next_word(line); !word.empty(); word = next_word(line)) {
        long i = 0;
        const bool parsed = parse_number(word.substr(0, word.find('/')), i);
        if (i < 0) i += mesh.vertex_count() + 1;
        check(parsed && i >= 1 && i <= mesh.vertex_count(), "'", word.substr(0, 20), "' is not one of the ",
              mesh.vertex_count(), " vertices defined so far");
        corners.push_back(static_cast<int>(i - 1));
      }
      check(corners.size() >= 3, "a face of ", corners.size(), " vertices, give at least 3");
      mesh.add_polygon(corners);
    }
  }
  return mesh.mesh();
}

}  // namespace detail

/// Vertices and faces of an OBJ file; polygons become fans of triangles, everything else is ignored.
/// throws   FileError that names the file and the line
inline TriangleMesh read_obj(const std::filesystem::path& path) {
  return detail::parse_obj(detail::read_whole_file(path), path);
}

}  // namespace dsns
