// Any bytes as a GLB or glTF file: read, or refused by an exception of the library.
#include <dsns/io/gltf_reader.hpp>

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  dsns::GltfReadOptions options;
  options.frames = 3;
  options.allow_still = true;
  try {
    dsns::detail::gltf::bake(dsns::detail::gltf::parse_gltf(bytes, "no folder/fuzz.glb"), options);
  } catch (const dsns::Error&) {
  }
  return 0;
}
