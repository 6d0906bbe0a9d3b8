#include "catch.hpp"
#include "support/temporary_folder.hpp"

#include <dsns/io/frames.hpp>

namespace frames_test {

using namespace dsns;

TEST_CASE("frames come in the order of their numbers", "[io]") {
  const test::TemporaryFolder folder;
  for (const int frame : {10, 2, 1, 9})
    folder.write("step_" + std::to_string(frame) + ".obj",
                 "v " + std::to_string(frame) + " 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  folder.write("notes.txt", "not a frame");
  const auto moved = read_frames(folder.path());
  REQUIRE(moved.frame_count() == 4);
  CHECK(moved.frames[0](0, 0) == 1);
  CHECK(moved.frames[1](0, 0) == 2);
  CHECK(moved.frames[3](0, 0) == 10);
  CHECK(moved.duration == 0.125);
  CHECK(moved.name == folder.path().filename().string());
  CHECK(read_frames(folder / "").name == moved.name);
}

TEST_CASE("the first frame that differs, and broken lines, are named", "[io]") {
  const test::TemporaryFolder folder;
  const std::string good = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  const auto said = [&] { return test::complaint<FileError>([&] { read_frames(folder.path()); }); };
  const auto contains = [](const std::string& whole, const std::string& part) {
    CAPTURE(whole);
    return test::is_one_sentence(whole) && whole.find(part) != std::string::npos;
  };
  folder.write("0.obj", good);
  CHECK(contains(said(), "holds 1 OBJ, OFF or PLY files"));
  folder.write("1.obj", good);
  CHECK(said().empty());
  folder.write("2.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 3 2\n");
  folder.write("3.obj", good + "f 1 3 2\n");
  CHECK(contains(said(), "2.obj has other faces"));
  CHECK(contains(said(), "dsns track"));
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
  CHECK(contains(said(), "2.obj is empty"));
  folder.write("2.obj", "# nothing\n");
  CHECK(contains(said(), "2.obj has 0 vertices and 0 faces"));
  const auto missing = test::complaint<FileError>([&] { read_frames(folder / "none"); });
  CHECK(contains(missing, "cannot be read as a folder"));
}

TEST_CASE("frames of COMA and VOCA are PLY files of one folder, others OFF", "[io]") {
  const test::TemporaryFolder folder;
  const auto ply = [](double x) {
    return "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
           "element face 1\nproperty list uchar int vertex_indices\nend_header\n" +
           std::to_string(x) + " 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  };
  for (const int frame : {1, 2, 3}) folder.write("bareteeth.00000" + std::to_string(frame) + ".ply", ply(frame));
  folder.write(".hidden.ply", "not a mesh");
  const auto moved = read_frames(folder.path(), 60);
  REQUIRE(moved.frame_count() == 3);
  CHECK(moved.duration == Approx(2.0 / 60));
  CHECK(moved.frames[2](0, 0) == 3);
  CHECK(moved.faces.col(0) == Eigen::Vector3i(0, 1, 2));
  CHECK_THROWS_AS(read_frames(folder.path(), 0), InvalidArgument);

  folder.write("extra.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  const auto said = test::complaint<FileError>([&] { read_frames(folder.path()); });
  CHECK(said.find("frames of one kind") != std::string::npos);
  CHECK(read_mesh(folder / "extra.off").vertices.cols() == 3);
  CHECK_THROWS_AS(read_mesh(folder.write("a.stl", "solid")), FileError);
}

}  // namespace frames_test
