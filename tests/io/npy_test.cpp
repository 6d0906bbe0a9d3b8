#include "catch.hpp"
#include "support/temporary_folder.hpp"

#include <dsns/io/frame_writer.hpp>
#include <dsns/io/npy.hpp>

#include <algorithm>
#include <cstring>

namespace npy_test {

using namespace dsns;

namespace {

/// An array as numpy.save writes it.
template <class T>
std::string npy(const std::string& descr, const std::string& shape, const std::vector<T>& values,
                bool by_columns = false, int version = 1) {
  std::string header = "{'descr': '" + descr + "', 'fortran_order': " + (by_columns ? "True" : "False") +
                       ", 'shape': " + shape + ", }\n";
  std::string bytes("\x93NUMPY", 6);
  bytes += char(version);
  bytes += '\0';
  bytes += char(header.size() % 256);
  bytes += char(header.size() / 256);
  if (version > 1) bytes += std::string(2, '\0');
  bytes += header;
  for (T x : values) {
    std::string piece(sizeof x, '\0');
    std::memcpy(piece.data(), &x, sizeof x);
    if (descr[0] == '>') std::reverse(piece.begin(), piece.end());
    bytes += piece;
  }
  return bytes;
}

/// An archive as numpy.savez writes it; sums are not checked by anybody.
std::string zip(const std::vector<std::pair<std::string, std::string>>& files, int method = 0) {
  const auto u16 = [](std::size_t x) { return std::string{char(x % 256), char(x / 256 % 256)}; };
  const auto u32 = [&](std::size_t x) { return u16(x % 65536) + u16(x / 65536); };
  std::string body, directory;
  for (const auto& [name, bytes] : files) {
    const std::string common = u16(20) + u16(0) + u16(std::size_t(method)) + u32(0) + u32(0) + u32(bytes.size()) +
                               u32(bytes.size()) + u16(name.size());
    directory += "PK\x01\x02" + u16(20) + common + u16(0) + u16(0) + u16(0) + u16(0) + u32(0) + u32(body.size()) + name;
    body += "PK\x03\x04" + common + u16(4) + name + "more" + bytes;
  }
  return body + directory + "PK\x05\x06" + u16(0) + u16(0) + u16(files.size()) + u16(files.size()) +
         u32(directory.size()) + u32(body.size()) + u16(0);
}

TriangleMesh triangle() {
  TriangleMesh mesh{Mat3X::Zero(3, 4), Faces(3, 2)};
  mesh.faces << 0, 0, 1, 2, 2, 3;
  return mesh;
}

bool contains(const std::string& whole, const std::string& part) {
  CAPTURE(whole);
  return whole.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("arrays of both precisions, orders and byte orders are the same frames", "[io]") {
  const test::TemporaryFolder folder;
  std::vector<double> by_rows, by_columns(2 * 4 * 3);
  for (int k = 0; k < 2 * 4 * 3; ++k) by_rows.push_back(0.5 * k);
  for (std::size_t t = 0; t < 2; ++t)
    for (std::size_t v = 0; v < 4; ++v)
      for (std::size_t k = 0; k < 3; ++k) by_columns[t + 2 * (v + 4 * k)] = by_rows[(t * 4 + v) * 3 + k];
  const std::vector<float> floats(by_rows.begin(), by_rows.end());
  for (const std::string& bytes :
       {npy("<f8", "(2, 4, 3)", by_rows), npy("<f4", "(2, 4, 3)", floats), npy(">f8", "(2, 4, 3)", by_rows, false, 2),
        npy(">f4", "(2,4,3)", floats, false, 3), npy("<f8", "(2, 4, 3)", by_columns, true)}) {
    const MeshSequence moved = read_npy(folder.write("walk.npy", bytes), triangle(), 12);
    REQUIRE(moved.frame_count() == 2);
    CHECK(moved.name == "walk");
    CHECK(moved.duration == Approx(1.0 / 12));
    CHECK(moved.faces == triangle().faces);
    for (int t = 0; t < 2; ++t)
      for (int v = 0; v < 4; ++v)
        for (int k = 0; k < 3; ++k) CHECK(moved.frames[std::size_t(t)](k, v) == 0.5 * ((t * 4 + v) * 3 + k));
  }
  const std::vector<Mat3X> frames(3, Mat3X::Random(3, 4));  // what we write ourselves
  write_npy(folder / "own.npy", frames);
  CHECK((read_npy(folder / "own.npy", triangle()).frames[2] - frames[2]).norm() < 1e-6);
}

TEST_CASE("arrays that are no frames, or damaged, are refused with what is wrong", "[io]") {
  const test::TemporaryFolder folder;
  const auto said = [&](const std::string& bytes) {
    const auto path = folder.write("a.npy", bytes);
    const std::string s = test::complaint<FileError>([&] { read_npy(path, triangle()); });
    if (!s.empty()) CHECK(test::is_one_sentence(s));
    return s;
  };
  const std::vector<double> numbers(24, 1.0);
  const std::string good = npy("<f8", "(2, 4, 3)", numbers);
  CHECK(said(good).empty());
  CHECK(contains(said("a picture of a horse"), "no NumPy array"));
  CHECK(contains(said(npy("<i8", "(2, 4, 3)", numbers)), "float32 or float64"));
  CHECK(contains(said(npy("|O", "(2, 4, 3)", numbers)), "float32 or float64"));
  CHECK(contains(said(npy("<f8", "(8, 3)", numbers)), "array of 2 axes"));
  CHECK(contains(said(npy("<f8", "(1, 8, 3)", numbers)), "fewer than two frames"));
  CHECK(contains(said(npy("<f8", "(4, 2, 3)", numbers)), "the mesh with the faces 4"));
  CHECK(contains(said(npy("<f8", "(2, 4000000000, 3)", numbers)), "claims 4000000000 entries"));
  CHECK(contains(said(npy("<f8", "(99999999, 99999999999, 99999999999)", numbers)), "claims"));
  CHECK(contains(said(npy("<f8", "(2, four, 3)", numbers)), "claims four"));
  std::vector<double> bad = numbers;
  bad[17] = std::nan("");
  CHECK(contains(said(npy("<f8", "(2, 4, 3)", bad)), "frame 1 has a coordinate"));
  for (std::size_t n = 0; n < good.size(); ++n) CHECK_FALSE(said(good.substr(0, n)).empty());
}

TEST_CASE("frames of CAPE are archives of one frame each", "[io]") {
  const test::TemporaryFolder folder;
  const auto frame = [](float x) {
    const std::vector<float> posed{x, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    return std::vector<std::pair<std::string, std::string>>{
        {"transl.npy", npy<float>("<f4", "(3,)", {1, 2, 3})},
        {"v_cano.npy", npy("<f4", "(4, 3)", std::vector<float>(12, 5.0f))},
        {"v_posed.npy", npy("<f4", "(4, 3)", posed)}};
  };
  for (int k = 1; k <= 3; ++k) folder.write("shortlong_hips.00000" + std::to_string(k) + ".npz", zip(frame(float(k))));
  const MeshSequence moved = read_npz_frames(folder.path(), triangle(), 60);
  REQUIRE(moved.frame_count() == 3);
  for (int k = 0; k < 3; ++k) CHECK(moved.frames[std::size_t(k)](0, 0) == k + 1);
  CHECK(moved.duration == Approx(2.0 / 60));

  const auto said = [&](const std::string& bytes) {
    folder.write("shortlong_hips.000002.npz", bytes);
    const std::string s = test::complaint<FileError>([&] { read_npz_frames(folder.path(), triangle()); });
    if (!s.empty()) CHECK(test::is_one_sentence(s));
    return s;
  };
  CHECK(contains(said(zip(frame(2), 8)), "compressed: save the archive with numpy.savez"));
  CHECK(contains(said(zip({{"a.npy", npy("<f4", "(4, 3)", std::vector<float>(12, 5.0f))}})), ""));
  CHECK(contains(said(zip({{"a.npy", npy<float>("<f4", "(3,)", {1, 2, 3})}})), "0 arrays of shape (N, 3)"));
  CHECK(contains(said(zip({{"v_posed.npy", npy("<f4", "(2, 3)", std::vector<float>(6, 5.0f))}})), "has 2 vertices"));
  const std::string good = zip(frame(2));
  CHECK(said(good).empty());
  for (std::size_t n = 0; n < good.size(); ++n) CHECK_FALSE(said(good.substr(0, n)).empty());
  for (std::size_t n = 0; n < good.size(); ++n) {  // read or refused
    std::string damaged = good;
    damaged[n] = static_cast<char>(damaged[n] ^ 0x15);
    said(damaged);
  }
}

}  // namespace npy_test
