#pragma once
/// Moving surfaces from HDF5 files: the registrations of DFAUST, and MATLAB's grids of version 7.3. Needs the HDF5 library:
/// link dsns::hdf5.
#include <dsns/core/errors.hpp>
#include <dsns/io/mesh_builder.hpp>
#include <dsns/mesh/sphere_mesh.hpp>

#include <hdf5.h>

#include <cmath>
#include <filesystem>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

namespace dsns {

namespace detail {

/// An identifier of the library, closed with the object.
class Hdf5Handle {
 public:
  Hdf5Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  Hdf5Handle(Hdf5Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Hdf5Handle(const Hdf5Handle&) = delete;
  Hdf5Handle& operator=(const Hdf5Handle&) = delete;
  ~Hdf5Handle() {
    if (id_ >= 0) close_(id_);
  }
  hid_t get() const { return id_; }
  bool good() const { return id_ >= 0; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// While it lives, the library does not print what goes wrong.
class QuietHdf5 {
 public:
  QuietHdf5() {
    H5Eget_auto2(H5E_DEFAULT, &print_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  QuietHdf5(const QuietHdf5&) = delete;
  QuietHdf5& operator=(const QuietHdf5&) = delete;
  ~QuietHdf5() { H5Eset_auto2(H5E_DEFAULT, print_, data_); }

 private:
  H5E_auto2_t print_ = nullptr;
  void* data_ = nullptr;
};

/// Numbers with their sizes, the last index running fastest.
struct Hdf5Array {
  std::vector<Index> sizes;
  std::vector<double> values;
};

class Hdf5File {
 public:
  /// throws   FileError
  explicit Hdf5File(const std::filesystem::path& path) : name_(path.string()), file_(open(path)) {}

  hid_t root() const { return file_.get(); }
  template <class... What>
  void check(bool ok, const What&... what) const {
    require<FileError>(ok, name_, ": ", what...);
  }
  const std::string& name() const { return name_; }

  bool has(hid_t where, const std::string& key) const { return H5Lexists(where, key.c_str(), H5P_DEFAULT) > 0; }
  Hdf5Handle object(hid_t where, const std::string& key) const {
    Hdf5Handle object(H5Oopen(where, key.c_str(), H5P_DEFAULT), &H5Oclose);
    check(object.good(), "there is no '", key, "': is this the right file?");
    return object;
  }
  static bool is_dataset(const Hdf5Handle& object) { return H5Iget_type(object.get()) == H5I_DATASET; }
  static bool is_group(const Hdf5Handle& object) { return H5Iget_type(object.get()) == H5I_GROUP; }

  std::vector<Index> sizes(const Hdf5Handle& dataset) const {
    const Hdf5Handle space(H5Dget_space(dataset.get()), &H5Sclose);
    const int rank = space.good() ? H5Sget_simple_extent_ndims(space.get()) : -1;
    check(rank >= 0 && rank <= 8, "an array without a shape: the file is damaged");
    std::vector<hsize_t> sizes(std::size_t(rank) + 1);
    H5Sget_simple_extent_dims(space.get(), sizes.data(), nullptr);
    std::vector<Index> result;
    double entries = 1;
    for (int k = 0; k < rank; ++k) {
      entries *= double(sizes[std::size_t(k)]);
      check(entries < 5e8, "an array claims ", entries, " entries: the file is damaged, or too large for this reader");
      result.push_back(static_cast<Index>(sizes[std::size_t(k)]));
    }
    return result;
  }
  bool holds(const Hdf5Handle& dataset, H5T_class_t a, H5T_class_t b) const {
    const Hdf5Handle type(H5Dget_type(dataset.get()), &H5Tclose);
    const H5T_class_t found = H5Tget_class(type.get());
    return found == a || found == b;
  }
  Hdf5Array numbers(const Hdf5Handle& dataset, const std::string& what) const {
    check(is_dataset(dataset) && holds(dataset, H5T_FLOAT, H5T_INTEGER), what, " is no array of numbers");
    Hdf5Array array{sizes(dataset), {}};
    array.values.resize(std::accumulate(array.sizes.begin(), array.sizes.end(), std::size_t(1),
                                        [](std::size_t n, Index size) { return n * std::size_t(size); }));
    check(H5Dread(dataset.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, array.values.data()) >= 0, what,
          " cannot be read: the file is damaged, download it again");
    return array;
  }
  /// The objects that an array of references names.
  std::vector<Hdf5Handle> referenced(const Hdf5Handle& dataset) const {
    const std::vector<Index> shape = sizes(dataset);
    std::size_t count = 1;
    for (const Index n : shape) count *= std::size_t(n);
    std::vector<hobj_ref_t> references(count);
    check(H5Dread(dataset.get(), H5T_STD_REF_OBJ, H5S_ALL, H5S_ALL, H5P_DEFAULT, references.data()) >= 0,
          "its references cannot be read: save it with -v7.3 again");
    std::vector<Hdf5Handle> objects;
    for (const hobj_ref_t& reference : references) {
      objects.emplace_back(H5Rdereference2(dataset.get(), H5P_DEFAULT, H5R_OBJECT, &reference), &H5Oclose);
      check(objects.back().good(), "a cell refers to nothing: save it with -v7.3 again");
    }
    return objects;
  }

 private:
  static Hdf5Handle open(const std::filesystem::path& path) {
    require<FileError>(std::filesystem::exists(path), path.string(), " does not exist: check the name");
    Hdf5Handle file(H5Fopen(path.string().c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), &H5Fclose);
    require<FileError>(file.good(), path.string(),
                       " is no HDF5 file: MATLAB files must be saved with -v7.3, others as .hdf5");
    return file;
  }
  std::string name_;
  Hdf5Handle file_;
};

/// The arrays of three indices at the top of a file.
inline std::vector<std::string> cubes(const Hdf5File& file) {
  struct Names {
    const Hdf5File& file;
    std::vector<std::string> found;
  } names{file, {}};
  const auto visit = [](hid_t group, const char* key, const H5L_info_t*, void* data) -> herr_t {
    auto& n = *static_cast<Names*>(data);
    const Hdf5Handle object(H5Oopen(group, key, H5P_DEFAULT), &H5Oclose);
    if (object.good() && Hdf5File::is_dataset(object)) {
      const Hdf5Handle space(H5Dget_space(object.get()), &H5Sclose);
      if (H5Sget_simple_extent_ndims(space.get()) == 3) n.found.emplace_back(key);
    }
    return 0;
  };
  H5Literate(file.root(), H5_INDEX_NAME, H5_ITER_INC, nullptr, visit, &names);
  return names.found;
}

/// A grid of places, rows x columns, from an array that MATLAB saved as rows x columns x 3.
struct PlaceGrid {
  Index rows, columns;
  std::vector<Vec3d> places;  // row by row
  const Vec3d& at(Index i, Index j) const { return places[std::size_t(i * columns + j)]; }
};

inline PlaceGrid place_grid(const Hdf5File& file, const Hdf5Handle& dataset) {
  const Hdf5Array a = file.numbers(dataset, "Mall");
  file.check(a.sizes.size() == 3 && a.sizes[0] == 3 && a.sizes[1] >= 4 && a.sizes[2] >= 3,
             "Mall is no grid of places, rows x columns x 3");
  const Index columns = a.sizes[1], rows = a.sizes[2];
  PlaceGrid grid{rows, columns, std::vector<Vec3d>(std::size_t(rows * columns))};
  for (Index i = 0; i < rows; ++i)
    for (Index j = 0; j < columns; ++j)
      for (Index c = 0; c < 3; ++c) {
        const double x = a.values[std::size_t((c * columns + j) * rows + i)];
        file.check(std::isfinite(x), "Mall has a coordinate that is not a finite number");
        grid.places[std::size_t(i * columns + j)][c] = x;
      }
  return grid;
}

/// The grid with colatitude along its rows: the first row is one point, the north pole.
inline PlaceGrid with_poles_in_rows(const Hdf5File& file, PlaceGrid grid) {
  double size = 0;
  for (const Vec3d& p : grid.places) size = std::max(size, (p - grid.places[0]).norm());
  const auto spread = [&](bool of_row) {
    double widest = 0;
    for (Index k = 0; k < (of_row ? grid.columns : grid.rows); ++k)
      widest = std::max(widest, ((of_row ? grid.at(0, k) : grid.at(k, 0)) - grid.at(0, 0)).norm());
    return widest;
  };
  if (spread(true) <= 1e-3 * size) return grid;
  file.check(spread(false) <= 1e-3 * size, "neither the first row nor the first column of Mall is one point, a pole");
  PlaceGrid turned{grid.columns, grid.rows, std::vector<Vec3d>(grid.places.size())};
  for (Index i = 0; i < turned.rows; ++i)
    for (Index j = 0; j < turned.columns; ++j) turned.places[std::size_t(i * turned.columns + j)] = grid.at(j, i);
  return turned;
}

}  // namespace detail

/// The names of the sequences in a DFAUST file.
/// throws   FileError
inline std::vector<std::string> dfaust_sequences(const std::filesystem::path& path) {
  const detail::QuietHdf5 quiet;
  return detail::cubes(detail::Hdf5File(path));
}

/// A sequence of a DFAUST file (registrations_f.hdf5, registrations_m.hdf5): an array vertices x 3 x frames of its name,
/// and the array `faces`.
/// rate     frames a second; DFAUST has 60
/// throws   FileError
inline MeshSequence read_dfaust(const std::filesystem::path& path, const std::string& sequence, double rate = 60) {
  require(rate > 0, "read_dfaust: ", rate, " frames a second, give a positive rate");
  const detail::QuietHdf5 quiet;
  const detail::Hdf5File file(path);
  if (sequence.empty() || !file.has(file.root(), sequence)) {
    std::string names;
    for (const auto& name : detail::cubes(file)) names += (names.empty() ? "" : ", ") + name;
    file.check(false, sequence.empty() ? "name a sequence" : "there is no sequence '" + sequence + "'",
               ": FILE#NAME with one of ", names);
  }
  const detail::Hdf5Array a = file.numbers(file.object(file.root(), sequence), sequence);
  file.check(a.sizes.size() == 3 && a.sizes[1] == 3 && a.sizes[2] >= 2, sequence,
             " is no array of vertices x 3 x frames");
  const detail::Hdf5Array f = file.numbers(file.object(file.root(), "faces"), "faces");
  file.check(f.sizes.size() == 2 && f.sizes[1] == 3 && f.sizes[0] >= 1, "faces is no array of faces x 3");
  MeshSequence out;
  out.name = sequence;
  out.duration = double(a.sizes[2] - 1) / rate;
  out.faces.resize(3, f.sizes[0]);
  for (Index k = 0; k < out.faces.size(); ++k) {
    const double v = f.values[std::size_t(k)];
    file.check(v >= 0 && v < double(a.sizes[0]) && v == std::floor(v), "a face names vertex ", v, " of ", a.sizes[0]);
    out.faces(k) = static_cast<int>(v);
  }
  for (Index t = 0; t < a.sizes[2]; ++t) {
    Mat3X& frame = out.frames.emplace_back(3, a.sizes[0]);
    for (Index k = 0; k < frame.size(); ++k) frame(k) = a.values[std::size_t(k * a.sizes[2] + t)];
    file.check(frame.allFinite(), sequence, ", frame ", t, ": a coordinate is not a finite number");
  }
  return out;
}

/// A sequence of grids from MATLAB (-v7.3): Surface{t}.Mall or Surface(t).Mall, rows x columns x 3, colatitude from pole to
/// pole along one index and longitude along the other, its last value the first again or not. Becomes a closed mesh.
/// rate     frames a second
/// throws   FileError
inline MeshSequence read_matlab_grids(const std::filesystem::path& path, double rate = 24) {
  require(rate > 0, "read_matlab_grids: ", rate, " frames a second, give a positive rate");
  const detail::QuietHdf5 quiet;
  const detail::Hdf5File file(path);
  const detail::Hdf5Handle surface = file.object(file.root(), "Surface");
  std::vector<detail::Hdf5Handle> grids;
  const auto add = [&](detail::Hdf5Handle object) {
    if (file.is_group(object))
      grids.push_back(file.object(object.get(), "Mall"));
    else
      grids.push_back(std::move(object));
  };
  if (file.is_group(surface)) {  // Surface(t).Mall
    detail::Hdf5Handle field = file.object(surface.get(), "Mall");
    if (file.is_dataset(field) && file.holds(field, H5T_REFERENCE, H5T_REFERENCE))
      for (auto& object : file.referenced(field)) add(std::move(object));
    else
      grids.push_back(std::move(field));
  } else {  // Surface{t}.Mall
    file.check(file.is_dataset(surface) && file.holds(surface, H5T_REFERENCE, H5T_REFERENCE),
               "Surface is neither a cell array nor a struct array with the field Mall");
    for (auto& object : file.referenced(surface)) add(std::move(object));
  }
  file.check(grids.size() >= 2, "Surface holds ", grids.size(), " grids, an animation needs at least 2");
  MeshSequence out;
  out.name = path.stem().string();
  out.duration = double(grids.size() - 1) / rate;
  Index rows = 0, columns = 0, sectors = 0;
  for (const auto& dataset : grids) {
    const detail::PlaceGrid grid = detail::with_poles_in_rows(file, detail::place_grid(file, dataset));
    if (out.frames.empty()) {
      rows = grid.rows;
      columns = grid.columns;
      const double step = (grid.at(rows / 2, 1) - grid.at(rows / 2, 0)).norm();
      sectors = (grid.at(rows / 2, columns - 1) - grid.at(rows / 2, 0)).norm() < 1e-3 * step ? columns - 1 : columns;
      out.faces = latitude_longitude_sphere(int(rows) - 2, int(sectors)).faces;
    }
    file.check(grid.rows == rows && grid.columns == columns, "grid ", out.frames.size(), " is ", grid.rows, " x ",
               grid.columns, ", the first ", rows, " x ", columns, ": all must be alike");
    Mat3X& frame = out.frames.emplace_back(Mat3X::Zero(3, 2 + (rows - 2) * sectors));
    for (Index i = 1; i + 1 < rows; ++i)
      for (Index j = 0; j < sectors; ++j) frame.col(1 + (i - 1) * sectors + j) = grid.at(i, j);
    for (Index j = 0; j < sectors; ++j) {
      frame.col(0) += grid.at(0, j) / double(sectors);
      frame.rightCols<1>() += grid.at(rows - 1, j) / double(sectors);
    }
  }
  return out;
}

}  // namespace dsns
