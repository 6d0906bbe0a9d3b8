// Any bytes as a .dsns file, as they are and with their size and checksum put right: read, and the surface evaluated, or
// refused by an exception of the library.
#include <dsns/nn/surface_archive.hpp>

#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  std::string bytes(reinterpret_cast<const char*>(data), size);
  const auto read = [&] {
    try {
      const dsns::Archive archive = dsns::parse_archive(bytes, "fuzz.dsns");
      if (dsns::parse_archive(dsns::to_bytes(archive), "again").arrays().size() != archive.arrays().size())
        std::abort();
      dsns::surface_from(archive).positions(dsns::Vec3d::UnitX(), 0.3);
    } catch (const dsns::Error&) {
    }
  };
  read();
  if (size < 40) return 0;
  std::string number;
  dsns::detail::append_little_endian(number, std::uint64_t(size));
  bytes.replace(16, 8, number);
  number.clear();
  dsns::detail::append_little_endian(number, dsns::xxh64(std::string_view(bytes).substr(0, size - 8)));
  bytes.replace(size - 8, 8, number);
  read();
  return 0;
}
