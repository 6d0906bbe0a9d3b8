#pragma once
/// The parameters of a PyTorch network, saved as .npz or .safetensors: docs/checkpoints.md has the script.
#include <dsns/core/archive.hpp>
#include <dsns/io/safetensors.hpp>
#include <dsns/io/source_name.hpp>

namespace dsns {

namespace detail {

inline Archive state_dict_from(const NamedArrays& arrays, const std::string& name) {
  using ByRows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Archive dict(name);
  for (const auto& [array, data] : arrays) {
    require<FileError>(data.shape.size() <= 2, name, ": '", array, "' has ", data.shape.size(),
                       " axes, wanted were layers of two");
    const Index rows = data.shape.empty() ? 1 : Index(data.shape[0]),
                cols = data.shape.size() < 2 ? 1 : Index(data.shape[1]);
    require<FileError>(!dict.contains(array), name, ": '", array, "' is there twice");
    dict.set(array, Eigen::MatrixXd(ByRows::Map(data.values.data(), rows, cols)));
  }
  return dict;
}

inline Archive parse_npz(std::string_view bytes, const std::string& name) {
  NamedArrays arrays;
  for (const ZipEntry& entry : npz_entries(bytes, name)) {
    const bool known = entry.name.size() > 4 && entry.name.substr(entry.name.size() - 4) == ".npy";
    require<FileError>(known, name, ": '", entry.name, "' is no array: save with numpy.savez");
    arrays.emplace_back(entry.name.substr(0, entry.name.size() - 4), parse_npy(entry.bytes, name + ", " + entry.name));
  }
  return state_dict_from(arrays, name);
}

}  // namespace detail

/// All arrays of the file in double precision under their names; vectors are one column.
/// throws   FileError
inline Archive read_state_dict(const std::filesystem::path& path) {
  const std::string extension = lower_extension(path), name = path.string();
  require<FileError>(extension == ".npz" || extension == ".safetensors", name,
                     ": a state dict is a .npz or a .safetensors file, save it as one");
  const std::string bytes = detail::read_whole_file(path);
  if (extension == ".npz") return detail::parse_npz(bytes, name);
  return detail::state_dict_from(detail::parse_safetensors(bytes, name), name);
}

}  // namespace dsns
