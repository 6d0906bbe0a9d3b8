// Any bytes as a PLY file: read, or refused by an exception of the library.
#include <dsns/io/ply.hpp>

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try {
    dsns::detail::PlyReader(bytes, "fuzz.ply").read();
  } catch (const dsns::Error&) {
  }
  return 0;
}
