#include "catch.hpp"
#include "support/gltf_fixtures.hpp"
#include "support/temporary_folder.hpp"

#include <dsns/io/gltf.hpp>

namespace gltf_own_mesh_test {

using namespace dsns;
using test::GltfFixture;
using test::text;

namespace {

const std::string png = "\x89PNG\r\n\x1a\n not really";

/// Two joints with texture coordinates, a material and an image given as text.
GltfFixture textured() {
  GltfFixture file = test::two_joints();
  const int places = file.numbers<float>("VEC2", {0, 0, 1, 0, 0, 1});
  const auto at = file.meshes.find("\"attributes\":{");
  REQUIRE(at != std::string::npos);
  file.meshes.insert(at, "\"material\":0,");
  file.meshes.insert(file.meshes.find("\"attributes\":{") + 14, "\"TEXCOORD_0\":" + text(places) + ",");
  file.more = R"(,"materials":[{"name":"skin","pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],)"
              R"("textures":[{"source":0}],"images":[{"uri":"data:image/png;base64,)" +
              test::base64(png) + R"("}])";
  return file;
}

}  // namespace

TEST_CASE("motion on the user's own mesh keeps what it looks like", "[io]") {
  const test::TemporaryFolder folder;
  const auto original = folder.write("arm.glb", textured().glb());
  const GltfAnimation before = read_gltf(original, {"", 5});
  std::vector<Mat3X> frames = before.sequence.frames;
  for (std::size_t k = 0; k < frames.size(); ++k) frames[k] = (2 * frames[k]).colwise() + Vec3d(double(k), 0, 0);
  GltfOwnMeshOptions options;
  options.duration = 3;
  options.clip = "doubled";
  const auto written = folder / "own.glb";
  write_gltf_own_mesh(written, original, frames, options);

  const GltfAnimation after = read_gltf(written, {"doubled", 5});
  CHECK(after.sequence.faces == before.sequence.faces);
  CHECK(after.sequence.duration == 3);
  for (std::size_t k = 0; k < frames.size(); ++k) CHECK((after.sequence.frames[k] - frames[k]).norm() < 1e-5);

  const std::string bytes = test::contents(written);
  const auto file = detail::gltf::parse_gltf(bytes, written);
  REQUIRE(file.model.meshes.size() == 1);
  const auto& primitive = file.model.meshes[0].primitives[0];
  CHECK(primitive.material == 0);
  CHECK(primitive.attributes.count("TEXCOORD_0") == 1);
  CHECK(primitive.attributes.count("JOINTS_0") == 0);
  CHECK(file.model.skins.empty());
  CHECK(file.model.materials.at(0).name == "skin");
  REQUIRE(file.model.images.size() == 1);
  const auto& view = file.model.bufferViews.at(std::size_t(file.model.images[0].bufferView));
  const auto& data = file.model.buffers.at(0).data;
  CHECK(std::string(data.begin() + std::ptrdiff_t(view.byteOffset),
                    data.begin() + std::ptrdiff_t(view.byteOffset + view.byteLength)) == png);
  const auto places =
      detail::gltf::read_accessor(file, primitive.attributes.at("TEXCOORD_0"), TINYGLTF_TYPE_VEC2, "uv");
  CHECK(places.cols() == 3);
  CHECK(places(1, 2) == 1);
}

TEST_CASE("another number of vertices does not fit the user's own mesh", "[io]") {
  const test::TemporaryFolder folder;
  const auto original = folder.write("arm.glb", test::two_joints().glb());
  const std::vector<Mat3X> frames(3, Mat3X::Zero(3, 7));
  const auto said =
      test::complaint<InvalidArgument>([&] { write_gltf_own_mesh(folder / "own.glb", original, frames); });
  CHECK(said.find("7 vertices") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(folder / "own.glb"));
  CHECK_THROWS_AS(write_gltf_own_mesh(folder / "own.glb", original, {frames[0]}), InvalidArgument);
}

TEST_CASE("an image that claims more bytes than its buffer has is not read", "[io]") {
  const test::TemporaryFolder folder;
  GltfFixture arm = test::two_joints();
  arm.more = R"(,"images":[{"bufferView":0,"mimeType":"image/png"}])";
  std::string json = arm.json();
  const auto place = json.find("\"byteLength\":", json.find("\"bufferViews\"")) + 13;
  json.replace(place, json.find_first_of(",}", place) - place, "900000000");
  const auto original = folder.write("arm.glb", arm.glb_of(json));
  const std::vector<Mat3X> frames(3, Mat3X::Zero(3, 3));
  CHECK_FALSE(test::complaint<Error>([&] { write_gltf_own_mesh(folder / "own.glb", original, frames); }).empty());
}

TEST_CASE("a buffer view that no mesh uses may not name a buffer that is not there", "[io]") {
  const test::TemporaryFolder folder;
  const GltfFixture arm = test::two_joints();
  const std::string json = arm.json(), views = "\"bufferViews\":[";
  const auto place = json.find(views);
  REQUIRE(place != std::string::npos);
  std::string damaged = json;
  damaged.insert(json.find(']', place), R"(,{"buffer":7,"byteLength":4})");
  const auto original = folder.write("arm.glb", arm.glb_of(damaged));
  const std::vector<Mat3X> frames = read_gltf(original, {"", 3}).sequence.frames;
  const auto said = test::complaint<FileError>([&] { write_gltf_own_mesh(folder / "own.glb", original, frames); });
  CHECK(said.find("there is no buffer 7") != std::string::npos);
}

}  // namespace gltf_own_mesh_test
