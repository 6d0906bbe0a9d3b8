#include "catch.hpp"
#include "support/meshes.hpp"
#include "support/temporary_folder.hpp"

#include <dsns/io/gltf.hpp>
#include <dsns/mesh/sphere_mesh.hpp>

#include <limits>

namespace gltf_writer_test {

using namespace dsns;

namespace {

/// A unit sphere that stretches along z by a factor of 1 to 3 and moves along x.
MeshSequence stretching(int frames) {
  const auto surface = [](const Vec3d& s, double t) { return Vec3d(s.x() + t, s.y(), s.z() * (1 + 2 * t)); };
  auto sequence = sequence_of(surface, icosphere(2), frames);
  sequence.duration = 1.25;
  sequence.name = "stretching";
  return sequence;
}

tinygltf::Model parsed(const std::filesystem::path& path) {
  tinygltf::Model model;
  std::string error, warning;
  const auto bytes = test::contents(path);
  REQUIRE(tinygltf::TinyGLTF().LoadBinaryFromMemory(&model, &error, &warning,
                                                    reinterpret_cast<const unsigned char*>(bytes.data()),
                                                    static_cast<unsigned int>(bytes.size())));
  CHECK(error + warning == "");
  return model;
}

/// The floats of a VEC3 accessor as they lie in the file.
Eigen::Matrix3Xf floats(const tinygltf::Model& model, int accessor) {
  const auto& a = model.accessors.at(std::size_t(accessor));
  const auto& view = model.bufferViews.at(std::size_t(a.bufferView));
  REQUIRE(view.byteLength == 12 * a.count);
  Eigen::Matrix3Xf values(3, Index(a.count));
  std::memcpy(values.data(), model.buffers.at(0).data.data() + view.byteOffset, view.byteLength);
  return values;
}

}  // namespace

TEST_CASE("what is written is read back to the precision of floats", "[io]") {
  const test::TemporaryFolder folder;
  const auto body = stretching(5);
  write_gltf(folder / "one.glb", body);
  const auto back = read_gltf(folder / "one.glb", {"motion", 5}).sequence;
  CHECK(back.duration == 1.25);
  CHECK(back.faces == body.faces);
  REQUIRE(back.frame_count() == 5);
  for (std::size_t k = 0; k < 5; ++k) CHECK((back.frames[k] - body.frames[k]).cwiseAbs().maxCoeff() < 4e-7);
  CHECK(folder.file_count() == 1);
}

TEST_CASE("between two frames the written motion is linear", "[io]") {
  const test::TemporaryFolder folder;
  const auto body = stretching(4);
  write_gltf(folder / "one.glb", body);
  const auto back = read_gltf(folder / "one.glb", {"", 13}).sequence;
  const Mat3X expected = 0.25 * body.frames[1] + 0.75 * body.frames[2];
  CHECK((back.frames[7] - expected).cwiseAbs().maxCoeff() < 4e-6);
}

TEST_CASE("bodies stand side by side, each with frames of its own", "[io]") {
  const test::TemporaryFolder folder;
  GltfWriteOptions options;
  options.duration = 2;
  options.clip = "walk";
  options.offsets = {Vec3d(0, 0, 0), Vec3d(4, 5, 6)};
  options.colors = {Vec3d(1, 0, 0), Vec3d(0, 0.5, 1)};
  options.vertex_colors = {Mat3X(), Mat3X::Constant(3, 12, 0.25)};
  const auto small = test::growing(icosphere(0), 3);
  write_gltf(folder / "two.glb", {stretching(5), small}, options);

  const auto back = read_gltf(folder / "two.glb", {"walk", 9}).sequence;
  CHECK(back.duration == 2);
  REQUIRE(back.vertex_count() == 162 + 12);
  const Mat3X placed = (1.5 * icosphere(0).vertices).colwise() + Vec3d(4, 5, 6);
  CHECK((back.frames[4].rightCols(12) - placed).cwiseAbs().maxCoeff() < 4e-6);
  CHECK((back.frames[6].leftCols(162) - stretching(5).frames[3]).cwiseAbs().maxCoeff() < 4e-7);

  const auto model = parsed(folder / "two.glb");
  CHECK(model.animations.size() == 1);
  CHECK(model.animations[0].channels.size() == 2);
  CHECK(model.nodes[0].name == "stretching");
  REQUIRE(model.materials.size() == 2);
  CHECK(model.materials[1].pbrMetallicRoughness.baseColorFactor == std::vector<double>{0, 0.5, 1, 1});
  CHECK(model.materials[1].doubleSided);
  CHECK(model.meshes[0].primitives[0].attributes.count("COLOR_0") == 0);
  const auto colors = floats(model, model.meshes[1].primitives[0].attributes.at("COLOR_0"));
  CHECK((colors.array() == 0.25f).all());
}

TEST_CASE("normals move with the shape and bounds are exact", "[io]") {
  const test::TemporaryFolder folder;
  const auto body = stretching(3);
  write_gltf(folder / "one.glb", body);
  const auto model = parsed(folder / "one.glb");
  const auto& primitive = model.meshes.at(0).primitives.at(0);
  REQUIRE(primitive.targets.size() == 2);
  const auto base = floats(model, primitive.attributes.at("NORMAL"));
  for (std::size_t k = 0; k < 3; ++k) {
    Eigen::Matrix3Xf normals = base;
    if (k > 0) normals += floats(model, primitive.targets[k - 1].at("NORMAL"));
    // The stretched sphere is an ellipsoid: its normal is its own point over the squared half-axes.
    const double z = 1 + double(k);
    const Mat3X centred = body.frames[k].colwise() - Vec3d(0.5 * double(k), 0, 0);
    const Mat3X exact = (Vec3d(1, 1, 1 / (z * z)).asDiagonal() * centred).colwise().normalized();
    CHECK((normals.cast<double>() - exact).colwise().norm().maxCoeff() < 0.15);  // flat faces, 162 vertices
    CHECK((normals.cast<double>() - vertex_normals(body.frames[k], body.faces)).cwiseAbs().maxCoeff() < 3e-7);
  }
  for (const int index : {primitive.attributes.at("POSITION"), primitive.targets[1].at("POSITION")}) {
    const auto values = floats(model, index);
    const auto& accessor = model.accessors[std::size_t(index)];
    for (Index i = 0; i < 3; ++i) {
      CHECK(accessor.minValues.at(std::size_t(i)) == double(values.row(i).minCoeff()));
      CHECK(accessor.maxValues.at(std::size_t(i)) == double(values.row(i).maxCoeff()));
    }
  }
}

TEST_CASE("what cannot be written is refused, and an old file stays", "[io]") {
  const test::TemporaryFolder folder;
  const auto path = folder.write("old.glb", "old");
  const auto body = stretching(3);
  auto broken = body;
  broken.frames[1](0, 0) = std::numeric_limits<double>::infinity();
  CHECK_THROWS_AS(write_gltf(path, broken), InvalidArgument);
  broken = body;
  broken.frames[2].conservativeResize(3, 100);
  CHECK_THROWS_AS(write_gltf(path, broken), InvalidArgument);
  broken = body;
  broken.faces(1, 1) = 162;
  CHECK_THROWS_AS(write_gltf(path, broken), InvalidArgument);
  broken = body;
  broken.name = "\xFF\xFE";
  CHECK_THROWS_AS(write_gltf(path, broken), InvalidArgument);
  broken = body;
  broken.duration = 0;
  CHECK_THROWS_AS(write_gltf(path, broken), InvalidArgument);
  broken.frames.resize(1);
  CHECK_THROWS_AS(write_gltf(path, broken), InvalidArgument);
  CHECK_THROWS_AS(write_gltf(path, std::vector<MeshSequence>{}), InvalidArgument);
  GltfWriteOptions options;
  options.offsets.resize(2, Vec3d::Zero());
  CHECK_THROWS_AS(write_gltf(path, body, options), InvalidArgument);
  options = {};
  options.vertex_colors = {Mat3X::Zero(3, 7)};
  CHECK_THROWS_AS(write_gltf(path, body, options), InvalidArgument);
  CHECK_THROWS_AS(write_gltf(folder / "no/folder/new.glb", body), FileError);
  CHECK(test::contents(path) == "old");
  CHECK(folder.file_count() == 1);
}

}  // namespace gltf_writer_test
