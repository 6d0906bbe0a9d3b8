// Any triangles, at positions from the same bytes: repaired and mapped to the sphere, or refused by an exception of the
// library. Bytes are taken in turn for corners and coordinates.
#include <dsns/mesh/repair.hpp>
#include <dsns/mesh/spherical_parameterization.hpp>

#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  if (size < 4 || size > 600) return 0;
  const int vertices = 3 + data[0] % 40;
  const auto byte = [&](std::size_t i) { return int(data[i % size]); };
  dsns::MeshSequence sequence;
  sequence.faces.resize(3, dsns::Index(size / 3));
  for (dsns::Index c = 0; c < sequence.faces.size(); ++c) sequence.faces(c) = byte(std::size_t(c) + 1) % vertices;
  for (int frame = 0; frame < 2; ++frame) {
    dsns::Mat3X& points = sequence.frames.emplace_back(3, vertices);
    for (dsns::Index k = 0; k < points.size(); ++k) points(k) = byte(std::size_t(7 * k + frame)) / 16;
  }
  try {
    const auto repaired = dsns::repair(sequence);
    const auto map = dsns::spherical_parameterization(repaired.sequence);
    if (!map.certificate.bijective()) std::abort();
  } catch (const dsns::Error&) {
  }
  return 0;
}
