#include "catch.hpp"
#include "support/temporary_folder.hpp"

#include <dsns/io/atomic_file.hpp>

#if __has_include(<sys/resource.h>)
#include <sys/resource.h>

#include <csignal>
#endif

namespace atomic_file_test {

using namespace dsns;
namespace fs = std::filesystem;

TEST_CASE("a file is created and replaced, with nothing left beside it", "[io]") {
  const test::TemporaryFolder folder;
  const std::string bytes("a\0b\n", 4);
  write_file_atomically(folder / "new.bin", bytes);
  CHECK(test::contents(folder / "new.bin") == bytes);
  fs::permissions(folder / "new.bin", fs::perms::owner_read | fs::perms::owner_write);
  write_file_atomically(folder / "new.bin", "second");
  CHECK(test::contents(folder / "new.bin") == "second");
  CHECK(fs::status(folder / "new.bin").permissions() == (fs::perms::owner_read | fs::perms::owner_write));
  CHECK(folder.file_count() == 1);
}

TEST_CASE("a link stays a link to the file it names", "[io]") {
  const test::TemporaryFolder folder;
  fs::create_symlink(folder.write("real.bin", "old"), folder / "link.bin");
  write_file_atomically(folder / "link.bin", "new");
  CHECK(fs::is_symlink(folder / "link.bin"));
  CHECK(test::contents(folder / "real.bin") == "new");
}

TEST_CASE("places that cannot hold the file are named", "[io]") {
  const test::TemporaryFolder folder;
  const auto said = [&](const fs::path& path) {
    return test::complaint<FileError>([&] { write_file_atomically(path, "x"); });
  };
  CHECK(said(folder / "missing/out.glb").find("missing' does not exist: create it") != std::string::npos);
  CHECK(said(folder.path()).find("is a folder") != std::string::npos);
  CHECK(said("").find("is a folder") != std::string::npos);
  CHECK(folder.file_count() == 0);
}

#if __has_include(<sys/resource.h>)
TEST_CASE("when the disk is full the old file stays and no temporary is left", "[io]") {
  const test::TemporaryFolder folder;
  const auto path = folder.write("precious.bin", "old");
  rlimit before{};
  REQUIRE(getrlimit(RLIMIT_FSIZE, &before) == 0);
  rlimit small = before;
  small.rlim_cur = 1000;
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  REQUIRE(setrlimit(RLIMIT_FSIZE, &small) == 0);
  const auto said = test::complaint<FileError>([&] { write_file_atomically(path, std::string(100000, 'x')); });
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  CHECK(said.find("cannot be written (100000 bytes)") != std::string::npos);
  CHECK(test::contents(path) == "old");
  CHECK(folder.file_count() == 1);
}
#endif

}  // namespace atomic_file_test
