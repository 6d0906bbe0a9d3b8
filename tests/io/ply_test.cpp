#include "catch.hpp"
#include "support/temporary_folder.hpp"

#include <dsns/io/ply.hpp>

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>

namespace ply_test {

using namespace dsns;

namespace {

/// The bytes of numbers, in the wanted order.
template <class... T>
std::string raw(std::endian order, T... x) {
  std::string bytes;
  const auto add = [&](auto value) {
    std::string piece(sizeof value, '\0');
    std::memcpy(piece.data(), &value, sizeof value);
    if (order != std::endian::native) std::reverse(piece.begin(), piece.end());
    bytes += piece;
  };
  (add(x), ...);
  return bytes;
}

const std::string header_tail =
    "comment made by hand\nelement vertex 4\nproperty double x\nproperty uchar red\nproperty float y\n"
    "property int16 z\nelement face 2\nproperty list uint8 int32 vertex_index\nproperty short flags\n"
    "element edge 1\nproperty list ushort float weights\nend_header\n";

std::string binary(std::endian order) {
  using u8 = std::uint8_t;
  using i16 = std::int16_t;
  using i32 = std::int32_t;
  std::string bytes = std::string("ply\nformat binary_") + (order == std::endian::little ? "little" : "big") +
                      "_endian 1.0\n" + header_tail;
  for (int v = 0; v < 4; ++v) bytes += raw(order, double(v) / 3, u8(200), float(0.5 * v), i16(-v));
  bytes += raw(order, u8(4), i32(0), i32(1), i32(2), i32(3), i16(7));
  bytes += raw(order, u8(3), i32(0), i32(2), i32(1), i16(7));
  bytes += raw(order, std::uint16_t(2), 0.5f, 0.25f);
  return bytes;
}

std::string said_of(const std::string& bytes) {
  const test::TemporaryFolder folder;
  const auto path = folder.write("a.ply", bytes);
  const std::string said = test::complaint<FileError>([&] { read_ply(path); });
  if (!said.empty()) CHECK(test::is_one_sentence(said));
  return said;
}

bool contains(const std::string& whole, const std::string& part) {
  CAPTURE(whole);
  return whole.find(part) != std::string::npos;
}

std::string replaced(std::string where, const std::string& what, const std::string& with) {
  const auto place = where.find(what);
  REQUIRE(place != std::string::npos);
  return where.replace(place, what.size(), with);
}

}  // namespace

TEST_CASE("PLY files as text and binary hold the same mesh", "[io]") {
  const test::TemporaryFolder folder;
  const std::string text = "ply\r\nformat ascii 1.0\r\n" + header_tail +
                           "0 200 0 0\n0.333333333333333333 200 .5 -1\n6.6666666666666666e-1 200 1 -2\n1 200 1.5 -3\n"
                           "4 0 1 2 3 7\n3 0 2 1 7\n2 0.5 0.25\n";
  for (const std::string& bytes : {text, binary(std::endian::little), binary(std::endian::big)}) {
    const TriangleMesh mesh = read_ply(folder.write("a.ply", bytes));
    REQUIRE(mesh.vertices.cols() == 4);
    for (Index v = 0; v < 4; ++v)
      CHECK((mesh.vertices.col(v) - Vec3d(double(v) / 3, 0.5 * double(v), -double(v))).norm() < 1e-15);
    Faces expected(3, 3);
    expected << 0, 0, 0, 1, 2, 2, 2, 3, 1;
    CHECK(mesh.faces == expected);
  }
}

TEST_CASE("PLY files that are none, or damaged, are refused with what is wrong", "[io]") {
  const std::string good = binary(std::endian::little);
  CHECK(said_of(good).empty());
  CHECK(contains(said_of("a picture\n"), "does not begin with 'ply'"));
  CHECK(contains(said_of(replaced(good, "binary_little_endian", "binary_middle_endian")), "'binary_middle_endian'"));
  CHECK(contains(said_of(replaced(good, "format", "fermat")), "names no format"));
  CHECK(contains(said_of(replaced(good, "vertex 4", "vertex 4000000000")), "more entries than the file has bytes"));
  CHECK(contains(said_of(replaced(good, "double x", "quadruple x")), "no type 'quadruple'"));
  CHECK(contains(said_of(replaced(good, "int16 z", "int16 w")), "2 of the coordinates"));
  CHECK(contains(said_of(replaced(good, "end_header", "end_hedder")), "no end"));
  const float huge = std::numeric_limits<float>::infinity();
  CHECK(contains(said_of(replaced(good, raw(std::endian::little, 1.5f), raw(std::endian::little, huge))), "vertex 3"));
  CHECK(contains(
      said_of(replaced(good, raw(std::endian::little, std::int32_t(3)), raw(std::endian::little, std::int32_t(4)))),
      "names vertex 4"));
  CHECK(contains(
      said_of(replaced(good, raw(std::endian::little, std::int32_t(3)), raw(std::endian::little, std::int32_t(-1)))),
      "names vertex -1"));
  CHECK(contains(
      said_of("ply\nformat ascii 1.0\nelement face 1\nproperty list uint int vertex_index\nend_header\n4000000000 "),
      "a list claims 4e+09 entries"));
  CHECK(contains(said_of("ply\nformat ascii 1.0\nelement vertex 1\nend_header\n0 0 0\n"), "0 of the coordinates"));
  CHECK(contains(said_of("ply\nformat ascii 1.0\nproperty float x\nend_header\n"), "before the first element"));
  for (std::size_t n = 0; n < good.size(); ++n) CHECK_FALSE(said_of(good.substr(0, n)).empty());
}

}  // namespace ply_test
