// Any bytes as a NumPy array and as an archive of such: read, or refused by an exception of the library.
#include <dsns/io/npy.hpp>

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try {
    dsns::detail::parse_npy(bytes, "fuzz.npy");
  } catch (const dsns::Error&) {
  }
  try {
    for (const auto& entry : dsns::detail::npz_entries(bytes, "fuzz.npz"))
      dsns::detail::parse_npy(entry.bytes, entry.name);
  } catch (const dsns::Error&) {
  }
  return 0;
}
