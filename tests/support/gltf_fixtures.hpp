#pragma once
/// Small glTF files put together byte by byte, without the library under test.
#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

namespace dsns::test {

inline std::string base64(const std::string& bytes) {
  static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (i + k < bytes.size() ? static_cast<std::uint8_t>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : digits[group >> (18 - 6 * k) & 63u];
  }
  return text;
}

/// Collects numbers; the remaining JSON is given as text.
class GltfFixture {
 public:
  std::string nodes, meshes, skins, animations;  ///< contents of the arrays of these names
  std::string more;                              ///< further members, starting with a comma

  /// A buffer view of raw bytes.
  int view(const std::string& bytes, int stride = 0) {
    bytes_.resize((bytes_.size() + 3) / 4 * 4, '\0');
    views_ += separator(views_) + R"({"buffer":0,"byteOffset":)" + std::to_string(bytes_.size()) + R"(,"byteLength":)" +
              std::to_string(bytes.size()) + (stride > 0 ? R"(,"byteStride":)" + std::to_string(stride) : "") + "}";
    bytes_ += bytes;
    return view_count_++;
  }

  /// An accessor with members like "\"bufferView\":0" of the caller's own.
  int accessor(const std::string& type, int component, std::size_t count, const std::string& members) {
    accessors_ += separator(accessors_) + R"({"type":")" + type + R"(","componentType":)" + std::to_string(component) +
                  R"(,"count":)" + std::to_string(count) + (members.empty() ? "" : ",") + members + "}";
    return accessor_count_++;
  }

  template <class T>
  int numbers(const std::string& type, const std::vector<T>& values, const std::string& members = "") {
    const std::size_t components = type == "SCALAR" ? 1 : type == "MAT4" ? 16 : std::size_t(type.back() - '0');
    return accessor(type, component_type<T>(), values.size() / components,
                    R"("bufferView":)" + std::to_string(view(raw(values))) + (members.empty() ? "" : ",") + members);
  }

  template <class T>
  static std::string raw(const std::vector<T>& values) {
    std::string bytes(values.size() * sizeof(T), '\0');
    std::memcpy(bytes.data(), values.data(), bytes.size());
    return bytes;
  }

  template <class T>
  static constexpr int component_type() {
    if constexpr (std::is_same_v<T, std::int8_t>) return 5120;
    if constexpr (std::is_same_v<T, std::uint8_t>) return 5121;
    if constexpr (std::is_same_v<T, std::int16_t>) return 5122;
    if constexpr (std::is_same_v<T, std::uint16_t>) return 5123;
    if constexpr (std::is_same_v<T, std::uint32_t>) return 5125;
    return 5126;
  }

  /// The JSON text; `uri` locates the buffer, "" in a GLB.
  std::string json(const std::string& uri = "") const {
    const auto list = [](const std::string& name, const std::string& items) {
      return items.empty() ? "" : ",\"" + name + "\":[" + items + "]";
    };
    return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}])" + list("nodes", nodes) +
           list("meshes", meshes) + list("skins", skins) + list("animations", animations) +
           list("accessors", accessors_) + list("bufferViews", views_) + R"(,"buffers":[{"byteLength":)" +
           std::to_string(bytes_.size()) + (uri.empty() ? "" : R"(,"uri":")" + uri + '"') + "}]" + more + "}";
  }

  std::string glb() const { return glb_of(json()); }
  std::string gltf() const { return json("data:application/octet-stream;base64," + base64(bytes_)); }
  const std::string& bytes() const { return bytes_; }

  /// A GLB of this fixture's numbers and any JSON text.
  std::string glb_of(std::string json_text) const {
    json_text.resize((json_text.size() + 3) / 4 * 4, ' ');
    std::string binary = bytes_;
    binary.resize((binary.size() + 3) / 4 * 4, '\0');
    return "glTF" + word(2) + word(28 + json_text.size() + binary.size()) +  // the header and two chunks
           word(json_text.size()) + "JSON" + json_text + word(binary.size()) + std::string("BIN\0", 4) + binary;
  }

 private:
  static std::string separator(const std::string& list) { return list.empty() ? "" : ","; }
  static std::string word(std::size_t value) { return raw(std::vector<std::uint32_t>{std::uint32_t(value)}); }

  std::string bytes_, views_, accessors_;
  int view_count_ = 0, accessor_count_ = 0;
};

inline std::string text(int number) { return std::to_string(number); }

/// A sampler and a channel as an animation of one track.
inline std::string one_track(const std::string& name, int input, int output, const std::string& interpolation,
                             const std::string& path, int node = 0) {
  return R"({"name":")" + name + R"(","samplers":[{"input":)" + text(input) + R"(,"output":)" + text(output) +
         R"(,"interpolation":")" + interpolation + R"("}],"channels":[{"sampler":0,"target":{"node":)" + text(node) +
         R"(,"path":")" + path + R"("}}]})";
}

/// One triangle (0,0,0) (1,0,0) (0,1,0) whose node moves along x by 6 units in 2 seconds.
inline GltfFixture sliding_triangle() {
  GltfFixture file;
  const int points = file.numbers<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0});
  const int corners = file.numbers<std::uint16_t>("SCALAR", {0, 1, 2});
  const int times = file.numbers<float>("SCALAR", {0, 2});
  const int moves = file.numbers<float>("VEC3", {0, 0, 0, 6, 0, 0});
  file.nodes = R"({"mesh":0})";
  file.meshes =
      R"({"primitives":[{"attributes":{"POSITION":)" + text(points) + R"(},"indices":)" + text(corners) + "}]}";
  file.animations = one_track("Rig|slide", times, moves, "LINEAR", "translation");
  return file;
}

/// Three vertices on two joints; the second joint, one unit along x from the first, turns by 90 degrees about z from
/// t = 0.5 to 2.5 s. Vertex 0 hangs on joint 0, vertex 1 at (2, 0, 0) on joint 1, vertex 2 at (1, 1, 0) on both alike,
/// its second joint in the second set of influences, as a 16-bit fraction. The mesh node's own translation must not
/// matter; the armature is 3 units up.
inline GltfFixture two_joints() {
  GltfFixture file;
  const int points = file.numbers<float>("VEC3", {0, 0, 0, 2, 0, 0, 1, 1, 0});
  const int joints0 = file.numbers<std::uint8_t>("VEC4", {0, 0, 0, 0, 1, 0, 0, 0, 0, 9, 0, 0});
  const int weights0 =
      file.numbers<std::uint8_t>("VEC4", {255, 0, 0, 0, 255, 0, 0, 0, 255, 0, 0, 0}, R"("normalized":true)");
  const int joints1 = file.numbers<std::uint16_t>("VEC4", {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1});
  const int weights1 =
      file.numbers<std::uint16_t>("VEC4", {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 65535}, R"("normalized":true)");
  const int binds = file.numbers<float>(
      "MAT4", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1});
  const int times = file.numbers<float>("SCALAR", {0.5f, 2.5f});
  const float h = 0.70710678f;
  const int turns = file.numbers<float>("VEC4", {0, 0, 0, 1, 0, 0, h, h});
  file.nodes = R"({"children":[1,2]},{"mesh":0,"skin":0,"translation":[5,5,5]},)"
               R"({"children":[3],"translation":[0,0,3]},{"children":[4]},{"translation":[1,0,0]})";
  file.meshes = R"({"primitives":[{"attributes":{"POSITION":)" + text(points) + R"(,"JOINTS_0":)" + text(joints0) +
                R"(,"WEIGHTS_0":)" + text(weights0) + R"(,"JOINTS_1":)" + text(joints1) + R"(,"WEIGHTS_1":)" +
                text(weights1) + "}}]}";
  file.skins = R"({"joints":[3,4],"inverseBindMatrices":)" + text(binds) + "}";
  file.animations = one_track("bend", times, turns, "LINEAR", "rotation", 4);
  return file;
}

/// A triangle with two morph targets: the first, sparse and without data of its own, lifts vertex 2 by one; the second
/// moves everything along y by one. Weights (0, 0), (1, 0), (1, 2) at 0, 1 and 2 s.
inline GltfFixture two_morphs(std::uint16_t lifted = 2) {
  GltfFixture file;
  const int points = file.numbers<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0});
  const int places = file.view(GltfFixture::raw<std::uint16_t>({lifted}));
  const int lifts = file.view(GltfFixture::raw<float>({0, 0, 1}));
  const int sparse = file.accessor("VEC3", 5126, 3,
                                   R"("sparse":{"count":1,"indices":{"bufferView":)" + text(places) +
                                       R"(,"componentType":5123},"values":{"bufferView":)" + text(lifts) + "}}");
  const int dense = file.numbers<float>("VEC3", {0, 1, 0, 0, 1, 0, 0, 1, 0});
  const int times = file.numbers<float>("SCALAR", {0, 1, 2});
  const int weights = file.numbers<float>("SCALAR", {0, 0, 1, 0, 1, 2});
  file.nodes = R"({"mesh":0})";
  file.meshes = R"({"primitives":[{"attributes":{"POSITION":)" + text(points) + R"(},"targets":[{"POSITION":)" +
                text(sparse) + R"(},{"POSITION":)" + text(dense) + "}]}]}";
  file.animations = one_track("morph", times, weights, "LINEAR", "weights");
  return file;
}

}  // namespace dsns::test
