#include "catch.hpp"
#include "support/temporary_folder.hpp"

#include <dsns/io/source_name.hpp>

namespace source_name_test {

using namespace dsns;

TEST_CASE("FILE#Clip names a file and a clip", "[io]") {
  CHECK(parse_source("a/Horse.glb#Gallop").file == "a/Horse.glb");
  CHECK(parse_source("a/Horse.glb#Gallop").clip == "Gallop");
  CHECK(parse_source("a/Horse.glb#Rig|Gallop").clip == "Rig|Gallop");
  CHECK(parse_source("Horse.glb").file == "Horse.glb");
  CHECK(parse_source("Horse.glb").clip.empty());
  CHECK(parse_source("Horse.glb#").clip.empty());
  CHECK_THROWS_AS(parse_source("#Gallop"), InvalidArgument);
  CHECK_THROWS_AS(parse_source(""), InvalidArgument);
}

TEST_CASE("a file whose own name has a # is found", "[io]") {
  const test::TemporaryFolder folder;
  const auto path = folder.write("take#3.glb", "x");
  CHECK(parse_source(path.string()).file == path);
  CHECK(parse_source(path.string()).clip.empty());
  CHECK(parse_source(path.string() + "#Walk").file == path);
  CHECK(parse_source(path.string() + "#Walk").clip == "Walk");
}

}  // namespace source_name_test
