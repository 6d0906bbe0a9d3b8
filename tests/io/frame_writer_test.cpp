#include "catch.hpp"
#include "support/temporary_folder.hpp"

#include <dsns/io/frame_writer.hpp>
#include <dsns/io/obj.hpp>

#include <cstring>

namespace frame_writer_test {

using namespace dsns;

TEST_CASE("OBJ frames keep all but the vertices of the file they are like", "[io]") {
  const test::TemporaryFolder folder;
  const auto like = folder.write(
      "own.obj",
      "mtllib a.mtl\n# hello\nv 0 0 0\nv 1 0 0\nvt 0 1\nv 0 1 0\r\nvn 0 0 1\nusemtl b\nf 1/1/1 2/1/1 3/1/1\n");
  std::vector<Mat3X> frames(12, Mat3X::Random(3, 3));
  for (std::size_t k = 0; k < frames.size(); ++k) frames[k] *= double(k + 1);
  write_obj_frames(folder / "out", "body", frames, like);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const auto path =
        folder / "out" / ("body." + std::string(k < 9 ? "00000" : "0000") + std::to_string(k + 1) + ".obj");
    const TriangleMesh mesh = read_obj(path);
    CHECK((mesh.vertices - frames[k]).norm() < 1e-7);
    CHECK(mesh.faces.col(0) == Eigen::Vector3i(0, 1, 2));
    const std::string text = test::contents(path);
    for (const char* line :
         {"mtllib a.mtl\n", "# hello\n", "vt 0 1\n", "vn 0 0 1\n", "usemtl b\n", "f 1/1/1 2/1/1 3/1/1\n"})
      CHECK(text.find(line) != std::string::npos);
  }
  CHECK_THROWS_AS(write_obj_frames(folder / "out", "body", {Mat3X::Zero(3, 4)}, like), InvalidArgument);
  CHECK_THROWS_AS(write_obj_frames(folder / "out", "body", frames, folder / "none.obj"), FileError);
  CHECK_THROWS_AS(write_obj_frames(like, "body", frames, like), FileError);
  CHECK_THROWS_AS(write_obj_frames(folder / "out", "body", {}, like), InvalidArgument);
}

TEST_CASE("a NumPy array has the header and the floats that its format says", "[io]") {
  const test::TemporaryFolder folder;
  Mat3X first(3, 2), second(3, 2);
  first << 1, 4, 2, 5, 3, 6;
  second = 10 * first;
  write_npy(folder / "a.npy", {first, second});
  const std::string bytes = test::contents(folder / "a.npy");
  REQUIRE(bytes.size() > 64);
  CHECK(bytes.substr(0, 8) == std::string("\x93NUMPY\x01\x00", 8));
  const std::size_t length =
      std::size_t(static_cast<unsigned char>(bytes[8])) + 256 * std::size_t(static_cast<unsigned char>(bytes[9]));
  CHECK((10 + length) % 64 == 0);
  CHECK(bytes[9 + length] == '\n');
  CHECK(bytes.find("{'descr': '<f4', 'fortran_order': False, 'shape': (2, 2, 3), }") == 10);
  REQUIRE(bytes.size() == 10 + length + 12 * sizeof(float));
  float numbers[12];
  std::memcpy(numbers, bytes.data() + 10 + length, sizeof numbers);
  for (int k = 0; k < 6; ++k) {
    CHECK(numbers[k] == float(k + 1));
    CHECK(numbers[6 + k] == float(10 * (k + 1)));
  }
  Mat3X other = Mat3X::Zero(3, 3);
  CHECK_THROWS_AS(write_npy(folder / "b.npy", {first, other}), InvalidArgument);
}

}  // namespace frame_writer_test
