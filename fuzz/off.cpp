// Any bytes as an OFF file: read, or refused by an exception of the library.
#include <dsns/io/off.hpp>

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try {
    dsns::detail::parse_off(bytes, "fuzz.off");
  } catch (const dsns::Error&) {
  }
  return 0;
}
