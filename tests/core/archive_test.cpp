#include "catch.hpp"
#include "support/temporary_folder.hpp"

#include <dsns/core/archive.hpp>

#include <cmath>

namespace archive_test {

using namespace dsns;

namespace {

/// One of each kind, with the numbers that text formats lose.
Archive example() {
  Archive archive;
  Eigen::MatrixXf single(2, 3);
  single << 1, 2, 3, -0.0f, std::numeric_limits<float>::denorm_min(), std::numeric_limits<float>::infinity();
  Eigen::MatrixXd twofold(3, 1);
  twofold << 0.1, std::nextafter(1.0, 2.0), std::nan("");
  archive.set("single", single);
  archive.set("twofold", twofold);
  archive.set("integers",
              Archive::Integers(Archive::Integers::Constant(1, 2, std::numeric_limits<std::int64_t>::min())));
  archive.set("text", std::string("a\0b\n\xc3\xa4", 6));
  archive.set("nothing", Eigen::MatrixXd(0, 6));
  archive.set("count", 7);
  archive.set("length", 2.5);
  return archive;
}

std::string said(const std::string& bytes) {
  const std::string s = test::complaint<FileError>([&] { parse_archive(bytes, "walk.dsns"); });
  if (!s.empty()) {
    CHECK(test::is_one_sentence(s));
    CHECK(s.rfind("walk.dsns", 0) == 0);
  }
  return s;
}

bool contains(const std::string& whole, const std::string& part) {
  CAPTURE(whole);
  return whole.find(part) != std::string::npos;
}

/// A file with any body and a right checksum.
std::string sealed(const std::string& body, std::uint64_t count, std::uint32_t major = 1, std::uint32_t minor = 0) {
  std::string bytes(
      "\x89"
      "DSNS\r\n\x1a",
      8);
  detail::append_little_endian(bytes, major);
  detail::append_little_endian(bytes, minor);
  detail::append_little_endian(bytes, std::uint64_t(40 + body.size()));
  detail::append_little_endian(bytes, count);
  bytes += body;
  detail::append_little_endian(bytes, xxh64(bytes));
  return bytes;
}

std::string array(const std::string& name, std::uint32_t type, std::uint64_t rows, std::uint64_t cols,
                  const std::string& entries) {
  std::string bytes;
  detail::append_little_endian(bytes, std::uint32_t(name.size()));
  detail::append_little_endian(bytes, type);
  detail::append_little_endian(bytes, rows);
  detail::append_little_endian(bytes, cols);
  return bytes + name + entries;
}

}  // namespace

TEST_CASE("archive: what is read is what was written, to the bit", "[core]") {
  const std::string bytes = to_bytes(example());
  const Archive read = parse_archive(bytes, "walk.dsns");
  CHECK(read.name() == "walk.dsns");
  CHECK(read.arrays().size() == 7);
  CHECK(to_bytes(read) == bytes);
  CHECK(read.get<Eigen::MatrixXf>("single")(0, 1) == 2);
  CHECK(std::signbit(read.get<Eigen::MatrixXf>("single")(1, 0)));
  CHECK(read.get<Eigen::MatrixXd>("twofold")(1) == std::nextafter(1.0, 2.0));
  CHECK(std::isnan(read.get<Eigen::MatrixXd>("twofold")(2)));
  CHECK(read.text("text") == example().text("text"));
  CHECK(read.get<Eigen::MatrixXd>("nothing").cols() == 6);
  CHECK(read.integer("count", 7, 7) == 7);
  CHECK(read.number("length") == 2.5);
  CHECK(parse_archive(to_bytes(Archive()), "a").arrays().empty());
}

TEST_CASE("archive: the bytes are those of the documented layout", "[core]") {
  Archive archive;
  archive.set("x", 1.0);
  CHECK(to_bytes(archive) == sealed(array("x", 2, 1, 1, std::string("\0\0\0\0\0\0\xf0\x3f", 8)), 1));
}

TEST_CASE("archive: every truncation and every changed byte is refused", "[core]") {
  const std::string good = to_bytes(example());
  CHECK(said(good).empty());
  for (std::size_t n = 0; n < good.size(); ++n) CHECK_FALSE(said(good.substr(0, n)).empty());
  CHECK_FALSE(said(good + '\0').empty());
  for (std::size_t n = 0; n < good.size(); ++n)
    for (int flip = 1; flip < 256; ++flip) {
      std::string damaged = good;
      damaged[n] = static_cast<char>(damaged[n] ^ flip);
      if (said(damaged).empty()) FAIL("byte " << n << " changed by " << flip << " is read");
    }
  CHECK(contains(said("glTF"), "no .dsns file"));
  CHECK(contains(said(good.substr(0, 100)), "100 bytes of"));
  std::string damaged = good;
  damaged[100] = static_cast<char>(damaged[100] ^ 1);
  CHECK(contains(said(damaged), "checksum"));
}

TEST_CASE("archive: sizes that cannot be are refused before memory is taken", "[core]") {
  const std::uint64_t huge = ~std::uint64_t(0);
  CHECK(said(sealed(array("x", 2, 1, 1, std::string(8, '\0')), 1)).empty());
  CHECK(contains(said(sealed(array("x", 2, huge, huge, ""), 1)), "claims an array"));
  CHECK(contains(said(sealed(array("x", 2, std::uint64_t(1) << 61, 8, ""), 1)), "claims an array"));  // product is 0
  CHECK(contains(said(sealed(array("x", 1, 2147483647, 2147483647, ""), 1)), "bytes where 0 are left"));
  CHECK(contains(said(sealed(array("x", 2, 1, 2, std::string(8, '\0')), 1)), "claims 16 bytes where 8"));
  CHECK(contains(said(sealed(array("x", 4, huge, 1, ""), 1)), "claims"));
  CHECK(contains(said(sealed(array("x", 4, 0, 2, ""), 1)), "2 columns"));
  CHECK(contains(said(sealed(array("x", 5, 0, 0, ""), 1)), "unknown type 5"));
  CHECK(contains(said(sealed("", huge)), "claims 4 bytes"));
  CHECK(contains(said(sealed(array("x", 4, 0, 1, ""), 0)), "behind its arrays"));
  CHECK(contains(said(sealed(array("x", 4, 0, 1, "") + array("x", 4, 0, 1, ""), 2)), "twice"));
}

TEST_CASE("archive: a newer major version is refused, a newer minor one read with what it adds", "[core]") {
  const std::string body = array("added later", 4, 2, 1, "hi");
  CHECK(contains(said(sealed(body, 1, 2)), "version 2"));
  CHECK(parse_archive(sealed(body, 1, 1, 9), "a").text("added later") == "hi");
}

TEST_CASE("archive: arrays that are missing or of another kind are named", "[core]") {
  const Archive archive = parse_archive(to_bytes(example()), "walk.dsns");
  const auto refused = [&](const auto& action) { return test::complaint<FileError>(action); };
  CHECK(contains(refused([&] { archive.text("tune"); }), "walk.dsns holds no 'tune'"));
  CHECK(contains(refused([&] { archive.text("single"); }), "'single' holds numbers in single precision"));
  CHECK(contains(refused([&] { archive.get<Eigen::MatrixXd>("single"); }), "wanted were numbers in double"));
  CHECK(contains(refused([&] { archive.number("twofold"); }), "is 3 x 1, wanted was 1 x 1"));
  CHECK(contains(refused([&] { archive.integer("count", 0, 6); }), "'count' is 7, outside of 0 to 6"));
}

}  // namespace archive_test
