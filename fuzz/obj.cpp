// Any bytes as an OBJ file: read, or refused by an exception of the library.
#include <dsns/io/obj.hpp>

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try {
    dsns::detail::parse_obj(bytes, "fuzz.obj");
  } catch (const dsns::Error&) {
  }
  return 0;
}
