#include "catch.hpp"
#include "support/temporary_folder.hpp"

#include <dsns/io/off.hpp>

namespace off_test {

using namespace dsns;

namespace {

std::string said_of(const std::string& text) {
  const test::TemporaryFolder folder;
  const auto path = folder.write("a.off", text);
  const std::string said = test::complaint<FileError>([&] { read_off(path); });
  if (!said.empty()) CHECK(test::is_one_sentence(said));
  return said;
}

bool contains(const std::string& whole, const std::string& part) { return whole.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("OFF files with comments, colours and polygons", "[io]") {
  const test::TemporaryFolder folder;
  const auto mesh = read_off(folder.write("a.off",
                                          "# first\nOFF # a kind\n\n4 2 0\r\n0 0 0\n1 0 0 # x\n1 1 -5e-1\n0 1 0\n"
                                          "4 0 1 2 3  255 0 0\n3 0 2 1\n2 0 1\n"));
  CHECK(mesh.vertices.cols() == 4);
  CHECK(Vec3d(mesh.vertices.col(2)) == Vec3d(1, 1, -0.5));
  Faces expected(3, 3);
  expected << 0, 0, 0, 1, 2, 2, 2, 3, 1;
  CHECK(mesh.faces == expected);
  // Counts beside the keyword; colours and normals at the vertices.
  CHECK(read_off(folder.write("b.off", "OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")).faces.cols() == 1);
  const std::string colored = "COFF\n3 1 3\n0 0 0 1 0 0 1\n1 0 0 1 0 0 1\n0 1 0 1 0 0 1\n3 0 1 2\n";
  CHECK(read_off(folder.write("c.off", colored)).vertices(1, 2) == 1);
  CHECK(read_off(folder.write("d.off", "ST" + colored)).vertices(1, 2) == 1);
}

TEST_CASE("OFF files that are none, or damaged, are refused by line", "[io]") {
  const std::string good = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  CHECK(said_of(good).empty());
  CHECK(contains(said_of("a picture\n"), "line 1: 'a' is no OFF header"));
  CHECK(contains(said_of("OFF BINARY\n3 1 0\n"), "export it as text"));
  CHECK(contains(said_of("4OFF\n3 1 0\n"), "three dimensions"));
  CHECK(contains(said_of("OFF\n3 one 0\n"), "numbers of vertices and faces"));
  CHECK(contains(said_of("OFF\n3000000000 1 0\n0 0 0\n"), "claims 3000000000 vertices"));
  CHECK(contains(said_of("OFF\n-3 1 0\n0 0 0\n"), "numbers of vertices"));
  CHECK(contains(said_of("OFF\n3 1 0\n0 0 0\n1 0 inf\n0 1 0\n3 0 1 2\n"), "line 4: 'inf'"));
  CHECK(contains(said_of("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"), "line 6: '3' is not one of the 3"));
  CHECK(contains(said_of("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n900000000 0 1 2\n"), "line 6"));
  for (std::size_t n = 0; n + 2 < good.size(); ++n) CHECK_FALSE(said_of(good.substr(0, n)).empty());
}

}  // namespace off_test
