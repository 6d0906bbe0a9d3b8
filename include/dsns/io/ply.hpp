#pragma once
/// Meshes from PLY files (Stanford), as text or binary of either byte order.
#include <dsns/io/file_bytes.hpp>
#include <dsns/io/mesh_builder.hpp>

#include <bit>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

namespace dsns {

namespace detail {

class PlyReader {
 public:
  /// `path` is what messages call the bytes.
  PlyReader(std::string_view bytes, const std::filesystem::path& path)
      : path_(path), size_(bytes.size()), rest_(bytes) {}

  TriangleMesh read() {
    read_header();
    MeshBuilder mesh(path_);
    std::vector<int> corners;
    for (const Element& element : elements_) {
      // An entry takes a byte at least, so a count that the bytes do not allow ends the loop early.
      for (std::size_t entry = 0; entry < element.count && !element.properties.empty(); ++entry) {
        Vec3d p(0, 0, 0);
        for (const Property& property : element.properties) {
          if (!property.is_list) {
            const double x = number(property.type);
            if (property.axis >= 0) p[property.axis] = x;
            continue;
          }
          const double length = number(property.count_type);
          check(length >= 0 && length <= double(rest_.size()), "a list claims ", length, " entries in ", rest_.size(),
                " bytes: the file is damaged, export it again");
          corners.clear();
          for (double k = 0; k < length; ++k) {
            const double v = number(property.type);
            check(!property.is_corners || (v >= 0 && v < 2147483647.0), "a face names vertex ", v,
                  ": the file is damaged, export it again");
            if (property.is_corners) corners.push_back(static_cast<int>(v));
          }
          if (property.is_corners) mesh.add_polygon(corners);
        }
        if (element.is_vertex) mesh.add_vertex(p);
      }
    }
    return mesh.mesh();
  }

 private:
  enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
  struct Property {
    Type type = Type::float32, count_type = Type::uint8;
    int axis = -1;  // of a vertex's coordinate
    bool is_list = false, is_corners = false;
  };
  struct Element {
    bool is_vertex = false, is_face = false;
    std::size_t count = 0;
    std::vector<Property> properties;
  };

  template <class... What>
  void check(bool ok, const What&... what) const {
    require<FileError>(ok, path_.string(), ": ", what...);
  }

  Type type_named(std::string_view name) const {
    constexpr std::string_view names[8][2] = {{"char", "int8"},     {"uchar", "uint8"},   {"short", "int16"},
                                              {"ushort", "uint16"}, {"int", "int32"},     {"uint", "uint32"},
                                              {"float", "float32"}, {"double", "float64"}};
    for (int k = 0; k < 8; ++k)
      if (name == names[k][0] || name == names[k][1]) return static_cast<Type>(k);
    check(false, "there is no type '", name.substr(0, 20), "' in PLY: export the file again");
    return Type::int8;
  }

  void read_header() {
    check(next_word(rest_) == "ply", "this is no PLY file: it does not begin with 'ply'");
    next_line(rest_);
    bool format_known = false;
    for (;;) {
      check(!rest_.empty(), "the header has no end: export the file again");
      std::string_view line = next_line(rest_);
      const std::string_view keyword = next_word(line);
      if (keyword == "end_header") break;
      if (keyword == "format") {
        const std::string_view format = next_word(line);
        format_known = format == "ascii" || format == "binary_little_endian" || format == "binary_big_endian";
        check(format_known, "there is no format '", format.substr(0, 30), "' in PLY: export the file again");
        text_ = format == "ascii";
        order_ = format == "binary_big_endian" ? std::endian::big : std::endian::little;
      } else if (keyword == "element") {
        Element element;
        const std::string_view name = next_word(line);
        element.is_vertex = name == "vertex";
        element.is_face = name == "face";
        check(parse_number(next_word(line), element.count) && element.count <= size_, "element '", name.substr(0, 30),
              "' claims more entries than the file has bytes: it is damaged, export it again");
        elements_.push_back(std::move(element));
      } else if (keyword == "property") {
        check(!elements_.empty(), "a property before the first element: export the file again");
        read_property(line, elements_.back());
      }
    }
    check(format_known, "the header names no format: export the file again");
    for (const Element& element : elements_) {
      int axes = 0;
      for (const Property& property : element.properties) axes += property.axis >= 0 ? 1 : 0;
      check(!element.is_vertex || axes == 3, "the vertices have ", axes, " of the coordinates x, y and z");
    }
  }

  void read_property(std::string_view line, Element& element) const {
    Property property;
    std::string_view word = next_word(line);
    property.is_list = word == "list";
    if (property.is_list) {
      property.count_type = type_named(next_word(line));
      word = next_word(line);
    }
    property.type = type_named(word);
    const std::string_view name = next_word(line);
    property.is_corners = element.is_face && property.is_list && (name == "vertex_indices" || name == "vertex_index");
    if (element.is_vertex && !property.is_list && name.size() == 1 && name[0] >= 'x' && name[0] <= 'z')
      property.axis = name[0] - 'x';
    element.properties.push_back(property);
  }

  double number(Type type) {
    if (text_) {
      double x = 0;
      const std::string_view word = next_word(rest_);
      check(!word.empty(), "the file ends too early: export it again");
      check(parse_number(word, x), "'", word.substr(0, 20), "' is not a number: export the file again");
      return x;
    }
    constexpr std::size_t sizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
    const std::size_t size = sizes[static_cast<std::size_t>(type)];
    check(rest_.size() >= size, "the file ends too early: export it again");
    const std::string_view raw = rest_.substr(0, size);
    rest_.remove_prefix(size);
    switch (type) {
      case Type::int8:
        return number_at<std::int8_t>(raw, order_);
      case Type::uint8:
        return number_at<std::uint8_t>(raw, order_);
      case Type::int16:
        return number_at<std::int16_t>(raw, order_);
      case Type::uint16:
        return number_at<std::uint16_t>(raw, order_);
      case Type::int32:
        return number_at<std::int32_t>(raw, order_);
      case Type::uint32:
        return number_at<std::uint32_t>(raw, order_);
      case Type::float32:
        return static_cast<double>(number_at<float>(raw, order_));
      default:
        return number_at<double>(raw, order_);
    }
  }

  std::filesystem::path path_;
  std::size_t size_;
  std::string_view rest_;
  std::vector<Element> elements_;
  bool text_ = false;
  std::endian order_ = std::endian::little;
};

}  // namespace detail

/// Vertices and faces of a PLY file; polygons become fans of triangles, other elements and properties are passed over.
/// throws   FileError that names the file and what is wrong with it
inline TriangleMesh read_ply(const std::filesystem::path& path) {
  return detail::PlyReader(detail::read_whole_file(path), path).read();
}

}  // namespace dsns
