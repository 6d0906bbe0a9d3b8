#pragma once
/// Parsed glTF files and their numbers. tinygltf parses; every range is checked here before memory is touched, because
/// a file may claim anything.
#include <dsns/core/errors.hpp>
#include <dsns/core/types.hpp>
#include <dsns/io/file_bytes.hpp>

#include <tiny_gltf.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <exception>
#include <filesystem>
#include <iterator>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace dsns::detail::gltf {

static_assert(std::endian::native == std::endian::little, "glTF is little-endian: number() would have to swap bytes");

using Bytes = std::span<const unsigned char>;

struct GltfFile {
  std::string name;  ///< for messages
  tinygltf::Model model;

  template <class... What>
  void check(bool condition, const What&... what) const {
    require<FileError>(condition, name, ": ", what...);
  }
};

/// The member of a model's list that an index in the file names.
template <class T>
const T& at(const GltfFile& file, const std::vector<T>& list, int index, std::string_view what) {
  file.check(index >= 0 && static_cast<std::size_t>(index) < list.size(), "there is no ", what, " ", index, ", only ",
             list.size(), " of them: the file is damaged, export it again");
  return list[static_cast<std::size_t>(index)];
}

inline bool is_glb(std::string_view bytes) { return bytes.substr(0, 4) == "glTF"; }

/// The JSON part of a file: all of a .gltf, the first chunk of a GLB.
inline std::string_view json_text(std::string_view bytes) {
  if (!is_glb(bytes) || bytes.size() < 20) return bytes;
  std::uint32_t length;
  std::memcpy(&length, bytes.data() + 12, sizeof length);
  return bytes.substr(20, length);
}

/// Brackets open at the same time in JSON text. tinygltf descends recursively, so this bounds its stack.
inline int nesting_depth(std::string_view json) {
  int depth = 0, deepest = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (c == '"') quoted = !quoted;
    if (quoted && c == '\\') ++i;
    if (quoted) continue;
    if (c == '{' || c == '[') deepest = std::max(deepest, ++depth);
    if (c == '}' || c == ']') --depth;
  }
  return deepest;
}

/// Textures play no part here, so they are accepted unseen.
inline bool ignore_image(tinygltf::Image*, const int, std::string*, std::string*, int, int, const unsigned char*, int,
                         void*) {
  return true;
}

/// Encoded as it came, for files that are written anew. Images in buffers stay there: whoever calls has not checked that
/// their bytes lie inside.
inline bool keep_image(tinygltf::Image* image, const int, std::string*, std::string*, int, int,
                       const unsigned char* bytes, int size, void*) {
  if (image->bufferView < 0) image->image.assign(bytes, bytes + std::max(size, 0));
  return true;
}

/// The first line of a parser's complaint, without its full stop.
inline std::string first_line(std::string text) {
  text.resize(std::min(text.find('\n'), text.size()));
  while (!text.empty() && (text.back() == '.' || text.back() == ' ')) text.pop_back();
  return text.empty() ? "no reason given" : text;
}

/// What a file requires may change its geometry, unless it is known to concern its looks.
inline void refuse_unreadable_extensions(const GltfFile& file) {
  constexpr std::string_view harmless[] = {"KHR_mesh_quantization", "KHR_materials_", "KHR_texture_", "EXT_texture_",
                                           "MSFT_texture_",         "KHR_lights_",    "EXT_lights_",  "KHR_techniques_",
                                           "MSFT_packing_",         "KHR_xmp"};
  for (const std::string& extension : file.model.extensionsRequired)
    file.check(std::any_of(std::begin(harmless), std::end(harmless),
                           [&](std::string_view known) { return extension.rfind(known, 0) == 0; }),
               "it needs the extension ", extension,
               ", which cannot be read: export it without compression, instancing or whatever this is");
}

/// `path` is where relative names in the file start, and what messages call it.
inline GltfFile parse_gltf(std::string_view bytes, const std::filesystem::path& path,
                           tinygltf::LoadImageDataFunction load_image = &ignore_image) {
  const bool binary = is_glb(bytes);
  GltfFile file{path.string(), {}};
  const auto start = std::min(bytes.find_first_not_of(" \t\r\n\xEF\xBB\xBF"), bytes.size());
  file.check(binary || bytes.substr(start, 1) == "{",
             "this is neither a GLB file nor glTF JSON: export the animation as .glb or .gltf");
  file.check(nesting_depth(json_text(bytes)) < 500, "the JSON is nested too deeply: export the animation again");
  tinygltf::TinyGLTF parser;
  parser.SetImageLoader(load_image, nullptr);
  std::string error, warning;
  bool parsed = false;
  try {
    const std::string folder = path.parent_path().string();
    const auto size = static_cast<unsigned int>(bytes.size());
    parsed = binary ? parser.LoadBinaryFromMemory(&file.model, &error, &warning,
                                                  reinterpret_cast<const unsigned char*>(bytes.data()), size, folder)
                    : parser.LoadASCIIFromString(&file.model, &error, &warning, bytes.data(), size, folder);
  } catch (const std::exception& failure) {
    error = failure.what();
  }
  refuse_unreadable_extensions(file);  // also where the parser stumbled over it
  file.check(parsed, "damaged glTF (", first_line(error), "): export the animation again");
  return file;
}

inline GltfFile load_gltf(const std::filesystem::path& path,
                          tinygltf::LoadImageDataFunction load_image = &ignore_image) {
  const std::string bytes = read_whole_file(path);
  require<FileError>(bytes.size() < std::numeric_limits<std::uint32_t>::max(), path.string(), " has ", bytes.size(),
                     " bytes, glTF allows 4 GB");
  return parse_gltf(bytes, path, load_image);
}

/// The bytes of a buffer view from `offset` on.
inline Bytes view_bytes(const GltfFile& file, int index, std::size_t offset) {
  const auto& view = at(file, file.model.bufferViews, index, "buffer view");
  const auto& buffer = at(file, file.model.buffers, view.buffer, "buffer");
  const std::size_t size = buffer.data.size();
  file.check(view.byteOffset <= size && view.byteLength <= size - view.byteOffset && offset <= view.byteLength,
             "buffer view ", index, " ends behind its buffer of ", size,
             " bytes: the file is damaged, export it again");
  return Bytes(buffer.data).subspan(view.byteOffset + offset, view.byteLength - offset);
}

/// What an accessor's elements look like in memory.
struct Layout {
  Index components;
  int type;
  bool normalized;
  std::size_t component_size() const { return std::size_t(tinygltf::GetComponentSizeInBytes(std::uint32_t(type))); }
  std::size_t element_size() const { return component_size() * std::size_t(components); }
};

template <class T>
double number(const unsigned char* bytes, const Layout& layout) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  if constexpr (std::numeric_limits<T>::is_integer)
    if (layout.normalized) return std::max(double(value) / double(std::numeric_limits<T>::max()), -1.0);
  return double(value);
}

/// One component. source: glTF 2.0, sections 3.6.2.2 and 3.11 (normalised integers)
inline double component(const unsigned char* bytes, const Layout& layout) {
  switch (layout.type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return number<std::int8_t>(bytes, layout);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return number<std::uint8_t>(bytes, layout);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return number<std::int16_t>(bytes, layout);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return number<std::uint16_t>(bytes, layout);
    case TINYGLTF_COMPONENT_TYPE_INT:
      return number<std::int32_t>(bytes, layout);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return number<std::uint32_t>(bytes, layout);
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return number<float>(bytes, layout);
    default:
      return number<double>(bytes, layout);
  }
}

/// `count` elements, `stride` bytes apart (0: without gaps), as the columns of components x count.
inline Eigen::MatrixXd decode(const GltfFile& file, Bytes bytes, const Layout& layout, std::size_t count,
                              std::size_t stride, std::string_view what) {
  const std::size_t element = layout.element_size();
  if (stride == 0) stride = element;
  file.check(count >= 1 && element >= 1 && bytes.size() >= element && count - 1 <= (bytes.size() - element) / stride,
             what, " claims ", count, " elements in ", bytes.size(), " bytes: the file is damaged, export it again");
  Eigen::MatrixXd values(layout.components, Index(count));
  for (Index i = 0; i < values.cols(); ++i)
    for (Index k = 0; k < layout.components; ++k)
      values(k, i) =
          component(bytes.data() + std::size_t(i) * stride + std::size_t(k) * layout.component_size(), layout);
  return values;
}

/// The elements of an accessor as columns, components x count, sparse replacements done. Without `expected` elements a
/// count may be anything that its bytes allow.
/// throws   FileError where the type is not the one asked for, data are missing or a value is not finite
inline Eigen::MatrixXd read_accessor(const GltfFile& file, int index, int type, std::string_view what,
                                     Index expected = -1) {
  const auto& accessor = at(file, file.model.accessors, index, "accessor");
  file.check(accessor.type == type, what, " (accessor ", index, ") has an unexpected type: export the file again");
  file.check(expected < 0 || accessor.count == std::size_t(expected), what, " has ", accessor.count,
             " elements, expected ", expected, ": the file is damaged, export it again");
  const Layout layout{tinygltf::GetNumComponentsInType(std::uint32_t(type)), accessor.componentType,
                      accessor.normalized};
  Eigen::MatrixXd values;
  if (accessor.bufferView >= 0) {
    const Bytes bytes = view_bytes(file, accessor.bufferView, accessor.byteOffset);
    const auto& view = file.model.bufferViews[std::size_t(accessor.bufferView)];
    values = decode(file, bytes, layout, accessor.count, view.byteStride, what);
  } else {
    file.check(expected >= 0, what, " has no data: export the file again");
    values = Eigen::MatrixXd::Zero(layout.components, expected);
  }
  if (accessor.sparse.isSparse && accessor.sparse.count > 0) {
    const auto& sparse = accessor.sparse;
    const auto count = static_cast<std::size_t>(sparse.count);
    const Bytes place_bytes = view_bytes(file, sparse.indices.bufferView, std::size_t(sparse.indices.byteOffset));
    const Bytes value_bytes = view_bytes(file, sparse.values.bufferView, std::size_t(sparse.values.byteOffset));
    const auto places = decode(file, place_bytes, {1, sparse.indices.componentType, false}, count, 0, what);
    const auto replacements = decode(file, value_bytes, layout, count, 0, what);
    for (Index i = 0; i < places.cols(); ++i) {
      const double place = places(0, i);
      file.check(place >= 0 && place < double(values.cols()), what, " replaces element ", place, " of ", values.cols(),
                 ": the file is damaged, export it again");
      values.col(Index(place)) = replacements.col(i);
    }
  }
  file.check(values.allFinite(), what, " holds a value that is not a finite number: export the file again");
  return values;
}

}  // namespace dsns::detail::gltf
