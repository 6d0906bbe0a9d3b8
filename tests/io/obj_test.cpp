#include "catch.hpp"
#include "support/temporary_folder.hpp"

#include <dsns/io/obj.hpp>

namespace obj_test {

using namespace dsns;

TEST_CASE("an OBJ file's polygons, negative indices and other lines", "[io]") {
  const test::TemporaryFolder folder;
  const auto mesh = read_obj(folder.write("a.obj",
                                          "# a comment\r\no thing\nv 0 0 0\nv 1 0 0 1.0\nv +1 1e0 -.5\r\nv 0 1 0\n"
                                          "vt 0 0\nvn 0 0 1\n  f 1/1/1 2//1 3/1\t\n"
                                          "f -4 -3 -2 -1\n"));
  CHECK(mesh.vertices.cols() == 4);
  CHECK(Vec3d(mesh.vertices.col(2)) == Vec3d(1, 1, -0.5));
  Faces expected(3, 3);
  expected << 0, 0, 0, 1, 1, 2, 2, 2, 3;
  CHECK(mesh.faces == expected);
}

TEST_CASE("frames come in the order of their numbers", "[io]") {
  const test::TemporaryFolder folder;
  for (const int frame : {10, 2, 1, 9})
    folder.write("step_" + std::to_string(frame) + ".obj",
                 "v " + std::to_string(frame) + " 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  folder.write("notes.txt", "not a frame");
  const auto moved = read_obj_sequence(folder.path());
  REQUIRE(moved.frame_count() == 4);
  CHECK(moved.frames[0](0, 0) == 1);
  CHECK(moved.frames[1](0, 0) == 2);
  CHECK(moved.frames[3](0, 0) == 10);
  CHECK(moved.duration == 0.125);
  CHECK(moved.name == folder.path().filename().string());
  CHECK(read_obj_sequence(folder / "").name == moved.name);
}

TEST_CASE("names are compared as people do", "[io]") {
  using detail::natural_less;
  CHECK(natural_less("f2", "f10"));
  CHECK_FALSE(natural_less("f10", "f2"));
  CHECK(natural_less("f002", "f10"));
  CHECK(natural_less("a1b2", "a1b10"));
  CHECK(natural_less("a", "b"));
  CHECK(natural_less("f", "f0"));
  CHECK(natural_less("f01", "f1") != natural_less("f1", "f01"));  // a strict order needs a winner
  CHECK_FALSE(natural_less("f1", "f1"));
}

TEST_CASE("the first frame that differs, and broken lines, are named", "[io]") {
  const test::TemporaryFolder folder;
  const std::string good = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  const auto said = [&] { return test::complaint<FileError>([&] { read_obj_sequence(folder.path()); }); };
  const auto contains = [](const std::string& whole, const std::string& part) {
    CAPTURE(whole);
    return test::is_one_sentence(whole) && whole.find(part) != std::string::npos;
  };
  folder.write("0.obj", good);
  CHECK(contains(said(), "holds 1 OBJ files"));
  folder.write("1.obj", good);
  CHECK(said().empty());
  folder.write("2.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 3 2\n");
  folder.write("3.obj", good + "f 1 3 2\n");
  CHECK(contains(said(), "2.obj has other faces"));
  folder.write("2.obj", "v 0 0 0\n" + good);
  CHECK(contains(said(), "2.obj has other faces or vertices (4 vertices, 1 faces)"));
  folder.write("2.obj", "v 0 0\n" + good);
  CHECK(contains(said(), "2.obj, line 1: '' is not a finite coordinate"));
  folder.write("2.obj", "v 0 0 nan\n" + good);
  CHECK(contains(said(), "2.obj, line 1: 'nan' is not a finite coordinate"));
  folder.write("2.obj", good + "f 1 2 4\n");
  CHECK(contains(said(), "2.obj, line 5: '4' is not one of the 3 vertices"));
  folder.write("2.obj", good + "f 1 2 -4\n");
  CHECK(contains(said(), "2.obj, line 5: '-4'"));
  folder.write("2.obj", good + "f 1 2\n");
  CHECK(contains(said(), "line 5: a face of 2 vertices"));
  folder.write("2.obj", "");
  CHECK(contains(said(), "2.obj has 0 vertices and 0 faces"));
  const auto missing = test::complaint<FileError>([&] { read_obj_sequence(folder / "none"); });
  CHECK(contains(missing, "cannot be read as a folder"));
}

}  // namespace obj_test
