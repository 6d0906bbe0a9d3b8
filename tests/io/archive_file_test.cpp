#include "catch.hpp"
#include "support/temporary_folder.hpp"

#include <dsns/io/archive_file.hpp>

namespace archive_file_test {

using namespace dsns;

TEST_CASE("archive file: written in place of the old one, read with its name in messages", "[io]") {
  const test::TemporaryFolder folder;
  const auto path = folder.write("walk.dsns", "old");
  CHECK(test::complaint<FileError>([&] { read_archive(path); }).rfind(path.string() + " is no .dsns file", 0) == 0);
  Archive archive;
  archive.set("pi", pi);
  write_archive(path, archive);
  CHECK(read_archive(path).number("pi") == pi);
  CHECK(read_archive(path).name() == path.string());
  CHECK(folder.file_count() == 1);
  CHECK(test::contents(path) == to_bytes(archive));
  CHECK_THROWS_AS(read_archive(folder / "none.dsns"), FileError);
  CHECK_THROWS_AS(read_archive(folder.write("empty.dsns", "")), FileError);
  CHECK_THROWS_AS(write_archive(folder / "none" / "walk.dsns", archive), FileError);
}

}  // namespace archive_file_test
