// Any bytes as a safetensors file and as a .npz of a network: imported, or refused by an exception of the library.
#include <dsns/io/state_dict_file.hpp>
#include <dsns/nn/state_dict.hpp>

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try {
    dsns::import_state_dict(dsns::detail::state_dict_from(dsns::detail::parse_safetensors(bytes, "fuzz"), "fuzz"));
  } catch (const dsns::Error&) {
  }
  try {
    dsns::import_state_dict(dsns::detail::parse_npz(bytes, "fuzz"));
  } catch (const dsns::Error&) {
  }
  return 0;
}
