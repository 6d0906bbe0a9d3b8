#pragma once
/// Vertices from NumPy arrays, .npy and (uncompressed) .npz, whose faces come from a mesh file.
#include <dsns/io/file_bytes.hpp>
#include <dsns/io/frames.hpp>

#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace dsns {

namespace detail {

/// An array of numbers with its shape, in C order.
struct NpyArray {
  std::vector<std::size_t> shape;
  std::vector<double> values;
};

/// The text behind a key of the header's dictionary.
inline std::string_view npy_field(std::string_view header, std::string_view key) {
  const auto at = header.find(key);
  if (at == std::string_view::npos) return {};
  const auto colon = header.find(':', at);
  return colon == std::string_view::npos ? std::string_view() : header.substr(colon + 1);
}

/// source   NumPy's format description, versions 1 to 3
/// throws   FileError that begins with `name`
inline NpyArray parse_npy(std::string_view bytes, const std::string& name) {
  const auto check = [&](bool ok, const auto&... what) { require<FileError>(ok, name, ": ", what...); };
  check(bytes.size() >= 12 && bytes.substr(0, 6) == "\x93NUMPY", "this is no NumPy array: save it with numpy.save");
  const int version = bytes[6];
  check(version >= 1 && version <= 3, "NumPy's format ", version, " is not known: save it with numpy.save");
  const std::size_t start = version == 1 ? 10 : 12;
  const std::size_t length = version == 1 ? number_at<std::uint16_t>(bytes.substr(8), std::endian::little)
                                          : number_at<std::uint32_t>(bytes.substr(8), std::endian::little);
  check(length <= bytes.size() - start, "the header ends behind the file: save the array again");
  const std::string_view header = bytes.substr(start, length);
  std::string_view data = bytes.substr(start + length);

  std::string_view type = npy_field(header, "'descr'");
  type.remove_prefix(std::min(type.find('\''), type.size()));
  type = type.substr(0, 5);
  check(type.size() == 5 && (type[1] == '<' || type[1] == '>') && type[2] == 'f' && (type[3] == '4' || type[3] == '8'),
        "the entries have type ", type, ": save an array of float32 or float64");
  const std::endian order = type[1] == '<' ? std::endian::little : std::endian::big;
  const bool wide = type[3] == '8';
  std::string_view fortran = npy_field(header, "'fortran_order'");
  const bool by_columns = next_word(fortran).substr(0, 4) == "True";

  NpyArray array;
  std::string_view shape = npy_field(header, "'shape'");
  shape.remove_prefix(std::min(shape.find('('), shape.size()));
  const auto close = shape.find(')');
  check(!shape.empty() && close != std::string_view::npos, "the header has no shape: save the array again");
  shape = shape.substr(1, close - 1);
  std::size_t count = 1;
  while (!shape.empty()) {
    const auto comma = std::min(shape.find(','), shape.size());
    std::string_view word = shape.substr(0, comma);
    shape.remove_prefix(std::min(comma + 1, shape.size()));
    word = next_word(word);
    if (word.empty()) continue;
    std::size_t n = 0;
    check(parse_number(word, n) && (n == 0 || count <= data.size() / n), "claims ", word, " entries along an axis, ",
          data.size(), " bytes are there: the file is damaged, save it again");
    array.shape.push_back(n);
    count *= n;
  }
  const std::size_t size = wide ? 8 : 4;
  check(data.size() / size >= count, "claims ", count, " entries, ", data.size(), " bytes are there: save it again");

  array.values.resize(count);
  std::vector<std::size_t> index(array.shape.size(), 0);
  for (std::size_t k = 0; k < count; ++k) {
    const std::string_view raw = data.substr(k * size, size);
    std::size_t place = k;
    if (by_columns) {  // the first index runs fastest
      place = 0;
      for (std::size_t d = 0; d < index.size(); ++d) place = place * array.shape[d] + index[d];
      for (std::size_t d = 0; d < index.size() && ++index[d] == array.shape[d]; ++d) index[d] = 0;
    }
    array.values[place] = wide ? number_at<double>(raw, order) : static_cast<double>(number_at<float>(raw, order));
  }
  return array;
}

/// Frame k of an array of shape (frames, vertices, 3).
inline Mat3X npy_frame(const NpyArray& array, std::size_t k, std::size_t vertices, const std::string& name) {
  const Mat3X frame = Mat3X::Map(array.values.data() + 3 * vertices * k, 3, static_cast<Index>(vertices));
  require<FileError>(frame.allFinite(), name, ": frame ", k, " has a coordinate that is not a finite number");
  return frame;
}

/// The entries of a zip archive whose names end in .npy, as they lie in it.
struct ZipEntry {
  std::string name;
  std::string_view bytes;
};
inline std::vector<ZipEntry> npz_entries(std::string_view zip, const std::string& name) {
  const auto check = [&](bool ok, const auto&... what) { require<FileError>(ok, name, ": ", what...); };
  const auto u16 = [&](std::size_t at) {
    return std::size_t(number_at<std::uint16_t>(zip.substr(at), std::endian::little));
  };
  const auto u32 = [&](std::size_t at) {
    return std::size_t(number_at<std::uint32_t>(zip.substr(at), std::endian::little));
  };
  constexpr std::string_view damaged = "this is no whole .npz archive: save it again with numpy.savez";
  const auto end = zip.rfind(std::string_view("PK\x05\x06", 4));
  check(end != std::string_view::npos && zip.size() - end >= 22, damaged);
  std::size_t at = u32(end + 16);
  std::vector<ZipEntry> entries;
  for (std::size_t k = u16(end + 10); k > 0; --k) {
    check(at <= zip.size() && zip.size() - at >= 46 && zip.substr(at, 4) == std::string_view("PK\x01\x02", 4), damaged);
    const std::size_t method = u16(at + 10), size = u32(at + 20), name_length = u16(at + 28), local = u32(at + 42);
    check(zip.size() - at - 46 >= name_length, damaged);
    const std::string entry(zip.substr(at + 46, name_length));
    check(method == 0, entry, " is compressed: save the archive with numpy.savez, not savez_compressed");
    check(local <= zip.size() && zip.size() - local >= 30, damaged);
    const std::size_t data = local + 30 + u16(local + 26) + u16(local + 28);
    check(data <= zip.size() && zip.size() - data >= size, damaged);
    entries.push_back({entry, zip.substr(data, size)});
    at += 46 + name_length + u16(at + 30) + u16(at + 32);
  }
  return entries;
}

/// The vertices in a CAPE frame: v_posed, else v_cano, else the only array of shape (N, 3).
inline Mat3X read_npz_vertices(const std::filesystem::path& path) {
  const std::string bytes = read_whole_file(path), name = path.string();
  const std::vector<ZipEntry> entries = npz_entries(bytes, name);
  const ZipEntry* chosen = nullptr;
  for (const std::string wanted : {"v_posed.npy", "v_cano.npy"})
    for (const ZipEntry& entry : entries)
      if (chosen == nullptr && entry.name == wanted) chosen = &entry;
  if (chosen == nullptr) {
    std::size_t found = 0;
    for (const ZipEntry& entry : entries) {
      const auto ends = entry.name.size() > 4 && entry.name.substr(entry.name.size() - 4) == ".npy";
      if (!ends || entry.bytes.find("'f") == std::string_view::npos) continue;
      if (entry.bytes.find(", 3)") == std::string_view::npos) continue;
      chosen = &entry;
      ++found;
    }
    require<FileError>(found == 1, name, " has ", found,
                       " arrays of shape (N, 3) and none called v_posed or v_cano: save the vertices as v_posed");
  }
  const NpyArray array = parse_npy(chosen->bytes, name + ", " + chosen->name);
  require<FileError>(array.shape.size() == 2 && array.shape[1] == 3, name, ", ", chosen->name,
                     ": vertices have shape (N, 3)");
  return npy_frame(array, 0, array.shape[0], name);
}

inline void require_same_vertices(Index found, const TriangleMesh& mesh, const std::string& name) {
  require<FileError>(found == mesh.vertices.cols(), name, " has ", found, " vertices, the mesh with the faces ",
                     mesh.vertices.cols(), ": give the mesh that belongs to it");
}

}  // namespace detail

/// A moving mesh from an array of shape (frames, vertices, 3), float32 or float64, and the faces of a mesh.
/// rate     frames a second
/// throws   FileError
inline MeshSequence read_npy(const std::filesystem::path& path, const TriangleMesh& mesh, double rate = 24) {
  require(rate > 0, "read_npy: ", rate, " frames a second, give a positive rate");
  const std::string bytes = detail::read_whole_file(path), name = path.string();
  const detail::NpyArray array = detail::parse_npy(bytes, name);
  require<FileError>(array.shape.size() == 3 && array.shape[2] == 3 && array.shape[0] >= 2, name, " is an array of ",
                     array.shape.size(), " axes or fewer than two frames: save one of shape (frames, vertices, 3)");
  detail::require_same_vertices(Index(array.shape[1]), mesh, name);
  MeshSequence sequence;
  sequence.faces = mesh.faces;
  for (std::size_t k = 0; k < array.shape[0]; ++k)
    sequence.frames.push_back(detail::npy_frame(array, k, array.shape[1], name));
  sequence.duration = (sequence.frame_count() - 1) / rate;
  sequence.name = path.stem().string();
  return sequence;
}

/// A moving mesh from a folder of .npz files, one a frame, as CAPE has them, and the faces of a mesh.
/// rate     frames a second
/// throws   FileError
inline MeshSequence read_npz_frames(const std::filesystem::path& folder, const TriangleMesh& mesh, double rate = 24) {
  require(rate > 0, "read_npz_frames: ", rate, " frames a second, give a positive rate");
  const auto files = frame_files(folder, {".npz"});
  require<FileError>(files.size() >= 2, folder.string(), " holds ", files.size(),
                     " .npz files, an animation needs at least 2");
  MeshSequence sequence;
  sequence.faces = mesh.faces;
  for (const auto& path : files) {
    sequence.frames.push_back(detail::read_npz_vertices(path));
    detail::require_same_vertices(sequence.frames.back().cols(), mesh, path.string());
  }
  sequence.duration = (sequence.frame_count() - 1) / rate;
  sequence.name = (folder / "").lexically_normal().parent_path().filename().string();
  return sequence;
}

}  // namespace dsns
