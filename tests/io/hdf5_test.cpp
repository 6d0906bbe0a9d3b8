#include "catch.hpp"
#include "support/temporary_folder.hpp"

#include <dsns/io/hdf5.hpp>
#include <dsns/mesh/repair.hpp>

#include <functional>

namespace hdf5_test {

using namespace dsns;
using Handle = detail::Hdf5Handle;

namespace {

/// Files written through the library itself.
class Writer {
 public:
  explicit Writer(const std::filesystem::path& path)
      : file_(H5Fcreate(path.string().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), &H5Fclose) {}
  hid_t root() const { return file_.get(); }
  void numbers(hid_t where, const std::string& name, const std::vector<hsize_t>& sizes, const std::vector<double>& x) {
    write(where, name, sizes, H5T_NATIVE_DOUBLE, x.data());
  }
  void references(hid_t where, const std::string& name, const std::vector<std::string>& paths) {
    std::vector<hobj_ref_t> refs(paths.size());
    for (std::size_t k = 0; k < paths.size(); ++k) H5Rcreate(&refs[k], root(), paths[k].c_str(), H5R_OBJECT, -1);
    write(where, name, {paths.size(), 1}, H5T_STD_REF_OBJ, refs.data());
  }
  Handle group(const std::string& name) {
    return {H5Gcreate2(root(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), &H5Gclose};
  }

 private:
  void write(hid_t where, const std::string& name, const std::vector<hsize_t>& sizes, hid_t type, const void* data) {
    const Handle space(H5Screate_simple(int(sizes.size()), sizes.data(), nullptr), &H5Sclose);
    const Handle set(H5Dcreate2(where, name.c_str(), type, space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                     &H5Dclose);
    H5Dwrite(set.get(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data);
  }
  Handle file_;
};

/// An ellipsoid that grows along z, as MATLAB would save rows x columns x 3: the first index fastest.
std::vector<double> grid(int rows, int columns, bool closed, bool transposed, double height) {
  std::vector<double> x(std::size_t(3 * rows * columns));
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) {
      const double u = pi * i / (rows - 1), v = 2 * pi * j / (closed ? columns - 1 : columns);
      const Vec3d p(std::sin(u) * std::cos(v), std::sin(u) * std::sin(v), height * std::cos(u));
      for (int c = 0; c < 3; ++c)
        x[std::size_t(transposed ? (c * rows + i) * columns + j : (c * columns + j) * rows + i)] = p[c];
    }
  return x;
}

bool contains(const std::string& whole, const std::string& part) {
  CAPTURE(whole);
  return whole.find(part) != std::string::npos;
}
std::string said(const std::function<void()>& wrong) {
  const std::string s = test::complaint<FileError>(wrong);
  if (!s.empty()) CHECK(test::is_one_sentence(s));
  return s;
}

}  // namespace

TEST_CASE("a DFAUST file's sequences are chosen by name", "[io]") {
  const test::TemporaryFolder folder;
  const auto path = folder / "registrations_f.hdf5";
  {
    Writer file(path);
    file.numbers(file.root(), "faces", {4, 3}, {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3});
    std::vector<double> x;  // vertices x 3 x frames
    for (int v = 0; v < 4; ++v)
      for (int c = 0; c < 3; ++c)
        for (int t = 0; t < 5; ++t) x.push_back((v == c + 1 ? 1 : 0) + 0.1 * t);
    file.numbers(file.root(), "50004_jiggle_on_toes", {4, 3, 5}, x);
    file.numbers(file.root(), "50020_knees", {4, 3, 5}, x);
    x[7] = std::nan("");
    file.numbers(file.root(), "50020_broken", {4, 3, 5}, x);
    file.numbers(file.root(), "flat", {4, 15}, x);
  }
  const auto moved = read_dfaust(path, "50004_jiggle_on_toes");
  REQUIRE(moved.frame_count() == 5);
  CHECK(moved.name == "50004_jiggle_on_toes");
  CHECK(moved.duration == Approx(4.0 / 60));
  CHECK(Vec3d(moved.frames[3].col(2)).isApprox(Vec3d(0.3, 1.3, 0.3)));
  CHECK(moved.faces.col(1) == Eigen::Vector3i(0, 1, 3));
  CHECK(dfaust_sequences(path) == std::vector<std::string>{"50004_jiggle_on_toes", "50020_broken", "50020_knees"});
  CHECK(contains(said([&] { read_dfaust(path, "50007"); }), "no sequence '50007': FILE#NAME with one of 50004_jiggle"));
  CHECK(contains(said([&] { read_dfaust(path, ""); }), "name a sequence"));
  CHECK(contains(said([&] { read_dfaust(path, "flat"); }), "no array of vertices x 3 x frames"));
  CHECK(contains(said([&] { read_dfaust(path, "50020_broken"); }), "not a finite number"));
  CHECK(contains(said([&] { read_dfaust(folder.write("a.hdf5", "text"), "x"); }), "no HDF5 file"));
  CHECK(contains(said([&] { read_dfaust(folder / "none.hdf5", "x"); }), "does not exist"));
}

TEST_CASE("MATLAB's grids become closed spheres, as cells and as structs, whichever way they lie", "[io]") {
  const test::TemporaryFolder folder;
  const int rows = 7, columns = 13;
  for (const bool closed : {true, false})
    for (const bool transposed : {true, false})
      for (const bool cells : {true, false}) {
        CAPTURE(closed, transposed, cells);
        const auto path = folder / "body.mat";
        {
          Writer file(path);
          const Handle store = file.group("#refs#");
          std::vector<std::string> places;
          for (int t = 0; t < 3; ++t) {
            std::string place = "/#refs#/" + std::string(1, char('a' + t));
            const std::vector<hsize_t> sizes{3, hsize_t(transposed ? rows : columns),
                                             hsize_t(transposed ? columns : rows)};
            if (cells) {
              const Handle cell = file.group(place);
              file.numbers(cell.get(), "Mall", sizes, grid(rows, columns, closed, transposed, 1 + t));
            } else {
              file.numbers(file.root(), place, sizes, grid(rows, columns, closed, transposed, 1 + t));
            }
            places.push_back(place);
          }
          if (cells) {
            file.references(file.root(), "Surface", places);
          } else {
            const Handle surface = file.group("Surface");
            file.references(surface.get(), "Mall", places);
          }
        }
        const MeshSequence moved = read_matlab_grids(path, 12);
        REQUIRE(moved.frame_count() == 3);
        CHECK(moved.duration == Approx(2.0 / 12));
        CHECK(moved.vertex_count() == 2 + (rows - 2) * (closed ? columns - 1 : columns));
        const RepairResult repaired = repair(moved);
        CHECK(repaired.after.closed);
        CHECK(repaired.after.vertices == moved.vertex_count());
        for (int t = 0; t < 3; ++t)
          CHECK((moved.frames[std::size_t(t)].array().colwise() / Eigen::Array3d(1, 1, 1 + t))
                    .matrix()
                    .colwise()
                    .norm()
                    .isApproxToConstant(1, 1e-12));
      }
}

TEST_CASE("MATLAB files without grids are refused with what is missing", "[io]") {
  const test::TemporaryFolder folder;
  const auto path = folder / "other.mat";
  const auto message = [&] { return said([&] { read_matlab_grids(path); }); };
  { Writer file(path); }
  CHECK(contains(message(), "there is no 'Surface'"));
  {
    Writer file(path);
    file.numbers(file.root(), "Surface", {2}, {1, 2});
  }
  CHECK(contains(message(), "neither a cell array nor a struct array"));
  {
    Writer file(path);
    const Handle surface = file.group("Surface");
    file.numbers(surface.get(), "Mall", {3, 13, 7}, grid(7, 13, true, false, 1));
  }
  CHECK(contains(message(), "an animation needs at least 2"));
  {
    Writer file(path);
    const Handle store = file.group("#refs#");
    file.numbers(file.root(), "/#refs#/a", {3, 13, 7}, grid(7, 13, true, false, 1));
    file.numbers(file.root(), "/#refs#/b", {3, 13, 8}, grid(8, 13, true, false, 1));
    file.references(file.root(), "Surface", {"/#refs#/a", "/#refs#/b"});
  }
  CHECK(contains(message(), "grid 1 is 8 x 13, the first 7 x 13"));
  {
    Writer file(path);
    const Handle store = file.group("#refs#");
    for (const char* name : {"/#refs#/a", "/#refs#/b"}) {
      std::vector<double> x = grid(7, 13, true, false, 1);
      for (std::size_t k = 0; k < x.size(); ++k) x[k] += 0.1 * double(k % 5);
      file.numbers(file.root(), name, {3, 13, 7}, x);
    }
    file.references(file.root(), "Surface", {"/#refs#/a", "/#refs#/b"});
  }
  CHECK(contains(message(), "one point, a pole"));
}

}  // namespace hdf5_test
