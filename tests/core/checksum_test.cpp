#include "catch.hpp"

#include <dsns/core/checksum.hpp>

namespace checksum_test {

using namespace dsns;

TEST_CASE("checksum: XXH64 has its published values", "[core]") {
  CHECK(xxh64("") == 0xef46db3751d8e999u);
  CHECK(xxh64("", 2654435761u) == 0xac75fda2929b17efu);  // xxHash's own self test
  CHECK(xxh64("a") == 0xd24ec4f1a98c6e5bu);
  CHECK(xxh64("abc") == 0x44bc2cf5ad770999u);
  CHECK(xxh64("Nobody inspects the spammish repetition") == 0xfbcea83c8a378bf1u);  // longer than a stripe
}

TEST_CASE("checksum: numbers are little-endian", "[core]") {
  std::string bytes;
  detail::append_little_endian(bytes, std::uint32_t(0x01020304));
  CHECK(bytes == "\x04\x03\x02\x01");
  CHECK(detail::from_little_endian<std::uint32_t>(bytes.data()) == 0x01020304);
  bytes.clear();
  detail::append_little_endian(bytes, -2.0);  // 0xc000000000000000
  CHECK(bytes == std::string(7, '\0') + '\xc0');
}

}  // namespace checksum_test
