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

}  // namespace obj_test
