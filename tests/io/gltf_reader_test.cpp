#include "catch.hpp"
#include "support/gltf_fixtures.hpp"
#include "support/temporary_folder.hpp"

#include <dsns/io/gltf_reader.hpp>

#include <cmath>
#include <limits>

namespace gltf_reader_test {

using namespace dsns;
using test::GltfFixture;
using test::text;

namespace {

MeshSequence read(const GltfFixture& file, int frames, const std::string& clip = "") {
  const test::TemporaryFolder folder;
  return read_gltf(folder.write("fixture.glb", file.glb()), {clip, frames}).sequence;
}

/// What reading says about a file; "" where it is read.
std::string complaint_about(const std::string& bytes, const std::string& clip = "") {
  const test::TemporaryFolder folder;
  const auto path = folder.write("broken.glb", bytes);
  const std::string said = test::complaint<Error>([&] { read_gltf(path, {clip, 4}); });
  if (!said.empty()) {
    CHECK(test::is_one_sentence(said));
    CHECK(said.find("broken.glb") != std::string::npos);
  }
  return said;
}

bool contains(const std::string& whole, const std::string& part) { return whole.find(part) != std::string::npos; }

std::string replaced(std::string where, const std::string& what, const std::string& with) {
  const auto place = where.find(what);
  REQUIRE(place != std::string::npos);
  return where.replace(place, what.size(), with);
}

double distance(const Mat3X& frame, Index vertex, const Vec3d& expected) {
  return (frame.col(vertex) - expected).norm();
}

}  // namespace

TEST_CASE("a skinned arm bends on a circle", "[io]") {
  const auto arm = read(test::two_joints(), 9);
  REQUIRE(arm.frame_count() == 9);
  CHECK(arm.duration == 2.0);
  for (int k = 0; k < 9; ++k) {
    const double angle = pi / 2 * k / 8;
    const Vec3d elbow(1, 0, 3), x(std::cos(angle), std::sin(angle), 0), y(-std::sin(angle), std::cos(angle), 0);
    const Mat3X& frame = arm.frames[std::size_t(k)];
    CHECK(distance(frame, 0, Vec3d(0, 0, 3)) < 1e-6);
    CHECK(distance(frame, 1, elbow + x) < 1e-6);
    CHECK(distance(frame, 2, 0.5 * (elbow + y) + 0.5 * Vec3d(1, 1, 3)) < 1e-6);
  }
}

TEST_CASE("morph targets add up, sparse ones too", "[io]") {
  const auto moved = read(test::two_morphs(), 5);
  const double lift[] = {0, 0.5, 1, 1, 1}, shift[] = {0, 0, 0, 1, 2};
  for (std::size_t k = 0; k < 5; ++k) {
    CHECK(distance(moved.frames[k], 0, Vec3d(0, shift[k], 0)) < 1e-12);
    CHECK(distance(moved.frames[k], 1, Vec3d(1, shift[k], 0)) < 1e-12);
    CHECK(distance(moved.frames[k], 2, Vec3d(0, 1 + shift[k], lift[k])) < 1e-12);
  }
}

TEST_CASE("a cubic spline through unequal gaps is the cubic it was sampled from", "[io]") {
  auto file = test::sliding_triangle();
  const auto place = [](float t) { return std::array{t * t * t - 2 * t, t * t, 1 - t}; };
  const auto slope = [](float t) { return std::array{3 * t * t - 2, 2 * t, -1.0f}; };
  std::vector<float> keys;
  for (const float t : {0.0f, 1.0f, 3.0f})
    for (const auto& column : {slope(t), place(t), slope(t)}) keys.insert(keys.end(), column.begin(), column.end());
  const int times = file.numbers<float>("SCALAR", {0, 1, 3});
  file.animations = test::one_track("cubic", times, file.numbers("VEC3", keys), "CUBICSPLINE", "translation");
  const auto moved = read(file, 13);
  for (int k = 0; k < 13; ++k) {
    const double t = k / 4.0;
    CHECK(distance(moved.frames[std::size_t(k)], 0, Vec3d(t * t * t - 2 * t, t * t, 1 - t)) < 1e-5);
  }
}

TEST_CASE("weights follow cubic splines, all targets of a key side by side", "[io]") {
  auto file = test::two_morphs();
  const int times = file.numbers<float>("SCALAR", {0, 1});
  // Weights t^2 and t^3, whose end tangents are 0, 2 and 0, 3.
  const int keys = file.numbers<float>("SCALAR", {0, 0, 0, 0, 0, 0, 2, 3, 1, 1, 2, 3});
  file.animations = test::one_track("cubic", times, keys, "CUBICSPLINE", "weights");
  const auto moved = read(file, 5);
  for (int k = 0; k < 5; ++k) {
    const double t = k / 4.0;
    CHECK(distance(moved.frames[std::size_t(k)], 2, Vec3d(0, 1 + t * t * t, t * t)) < 1e-6);
  }
}

TEST_CASE("a step holds its value until the next key", "[io]") {
  auto file = test::sliding_triangle();
  file.animations = replaced(file.animations, "LINEAR", "STEP");
  const auto moved = read(file, 5);
  for (std::size_t k = 0; k < 4; ++k) CHECK(moved.frames[k](0, 0) == 0);
  CHECK(moved.frames[4](0, 0) == 6);
}

TEST_CASE("matrices, rotations and scales multiply down the tree", "[io]") {
  auto file = test::sliding_triangle();  // the animated node is the child of a quarter turn about z, twice as large
  file.nodes = R"({"children":[1],"matrix":[0,2,0,0,-2,0,0,0,0,0,2,0,7,0,0,1]},{"mesh":0,"scale":[1,3,1]})";
  file.animations = replaced(file.animations, R"("node":0)", R"("node":1)");
  const auto moved = read(file, 3);
  for (std::size_t k = 0; k < 3; ++k) {
    const double x = 3.0 * double(k);
    CHECK(distance(moved.frames[k], 1, Vec3d(7, 2 * (1 + x), 0)) < 1e-12);
    CHECK(distance(moved.frames[k], 2, Vec3d(7 - 6, 2 * x, 0)) < 1e-12);
  }
}

TEST_CASE("rotations take the short way round", "[io]") {
  auto file = test::sliding_triangle();
  const int times = file.numbers<float>("SCALAR", {0, 1});
  const float h = -0.70710678f;  // a quarter turn about z, written as its negative
  file.animations =
      test::one_track("turn", times, file.numbers<float>("VEC4", {0, 0, 0, 1, 0, 0, h, h}), "LINEAR", "rotation");
  CHECK(distance(read(file, 3).frames[1], 1, Vec3d(std::sqrt(0.5), std::sqrt(0.5), 0)) < 1e-6);
}

TEST_CASE("interleaved and normalised numbers are found between their neighbours", "[io]") {
  auto file = test::sliding_triangle();
  const int mixed = file.view(GltfFixture::raw<std::int16_t>({0, 0, 0, 77, 32767, 0, 0, 77, 0, -32768, 0, 77}), 8);
  const int points = file.accessor("VEC3", 5122, 3, R"("normalized":true,"bufferView":)" + text(mixed));
  const int keys = file.view(GltfFixture::raw<float>({0, 1, 2, 3, 4, 5, 6, 7}), 16);  // time, translation
  const int times = file.accessor("SCALAR", 5126, 2, R"("bufferView":)" + text(keys));
  const int moves = file.accessor("VEC3", 5126, 2, R"("byteOffset":4,"bufferView":)" + text(keys));
  file.meshes = R"({"primitives":[{"attributes":{"POSITION":)" + text(points) + "}}]}";
  file.animations = test::one_track("slide", times, moves, "LINEAR", "translation");
  const auto moved = read(file, 2);
  CHECK(moved.duration == 4);
  CHECK(distance(moved.frames[0], 1, Vec3d(2, 2, 3)) < 1e-12);
  CHECK(distance(moved.frames[0], 2, Vec3d(1, 1, 3)) < 1e-12);  // -32768 is as far as -32767
  CHECK(distance(moved.frames[1], 0, Vec3d(5, 6, 7)) < 1e-12);
}

TEST_CASE("strips and fans are wound like their first triangle", "[io]") {
  auto file = test::sliding_triangle();
  const int points = file.numbers<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0});
  const int mode = GENERATE(5, 6);
  const auto primitive = [&](int m) {
    return R"({"mode":)" + text(m) + R"(,"attributes":{"POSITION":)" + text(points) + "}}";
  };
  file.meshes = R"({"primitives":[)" + primitive(mode) + "," + primitive(1) + "]}";  // lines are passed over
  Faces expected(3, 3);
  if (mode == 5)
    expected << 0, 1, 2, 1, 3, 3, 2, 2, 4;
  else
    expected << 0, 0, 0, 1, 2, 3, 2, 3, 4;
  CHECK(read(file, 2).faces == expected);
}

TEST_CASE("all meshes of the scene are merged, others left out", "[io]") {
  auto file = test::sliding_triangle();
  file.nodes = R"({"mesh":0,"children":[1]},{"mesh":0,"translation":[0,0,1]},{"mesh":0})";
  const auto moved = read(file, 2);
  REQUIRE(moved.vertex_count() == 6);
  CHECK(moved.faces.col(1) == Eigen::Vector3i(3, 4, 5));
  CHECK(distance(moved.frames[1], 3, Vec3d(6, 0, 1)) < 1e-12);
}

TEST_CASE("one node's meshes can be chosen, with what is below it", "[io]") {
  const test::TemporaryFolder folder;
  auto file = test::sliding_triangle();
  file.nodes = R"({"name":"all","children":[1,3]},{"name":"arm","mesh":0,"children":[2]},)"
               R"({"name":"hand","mesh":0,"translation":[0,0,1]},{"name":"hat","mesh":0,"translation":[0,0,5]})";
  const auto path = folder.write("figure.glb", file.glb());
  const auto chosen = [&](const std::string& node) {
    GltfReadOptions options;
    options.frames = 2;
    options.node = node;
    return read_gltf(path, options).sequence;
  };
  CHECK(chosen("").vertex_count() == 9);
  CHECK(chosen("all").vertex_count() == 9);
  CHECK(chosen("arm").vertex_count() == 6);
  REQUIRE(chosen("hat").vertex_count() == 3);
  CHECK(chosen("hat").frames[1](2, 0) == 5);
  const auto said = test::complaint<FileError>([&] { chosen("wig"); });
  CHECK(contains(said, "no node 'wig': nodes with a mesh are arm, hat, hand"));
}

TEST_CASE("frames can be counted by the second", "[io]") {
  const test::TemporaryFolder folder;
  const auto path = folder.write("slide.glb", test::sliding_triangle().glb());  // two seconds
  GltfReadOptions options;
  options.rate = 12;
  CHECK(read_gltf(path, options).sequence.frame_count() == 25);
  options.rate = 0.01;
  CHECK(read_gltf(path, options).sequence.frame_count() == 2);
  options.rate = 1e9;
  CHECK(contains(test::complaint<FileError>([&] { read_gltf(path, options); }), "give a lower rate"));
  options.rate = -1;
  CHECK_THROWS_AS(read_gltf(path, options), InvalidArgument);
}

TEST_CASE("a file without animation is one frame where that is allowed", "[io]") {
  const test::TemporaryFolder folder;
  auto file = test::sliding_triangle();
  file.animations = "";
  const auto path = folder.write("rock.glb", file.glb());
  CHECK(contains(test::complaint<UnusableMesh>([&] { read_gltf(path); }), "has no animation"));
  GltfReadOptions options;
  options.allow_still = true;
  const auto rock = read_gltf(path, options);
  CHECK(rock.sequence.frame_count() == 1);
  CHECK(rock.sequence.name == "rock");
  CHECK_FALSE(rock.clip_chosen_by_default);
  options.clip = "roll";
  CHECK(contains(test::complaint<UnusableMesh>([&] { read_gltf(path, options); }), "has no animation"));
}

TEST_CASE("extensions that a file requires are read, ignored or refused by name", "[io]") {
  const auto requiring = [](const std::string& extension) {
    auto file = test::sliding_triangle();
    const int points = file.numbers<std::int8_t>("VEC3", {0, 0, 0, 127, 0, 0, 0, -128, 0}, R"("normalized":true)");
    if (extension == "KHR_mesh_quantization")
      file.meshes = R"({"primitives":[{"attributes":{"POSITION":)" + text(points) + "}}]}";
    file.more = R"(,"extensionsUsed":[")" + extension + R"("],"extensionsRequired":[")" + extension + "\"]";
    return file;
  };
  const auto quantized = read(requiring("KHR_mesh_quantization"), 2);
  CHECK(distance(quantized.frames[0], 1, quantized.frames[0].col(0) + Vec3d(1, 0, 0)) < 1e-12);
  CHECK(distance(quantized.frames[0], 2, quantized.frames[0].col(0) - Vec3d(0, 1, 0)) < 1e-12);
  CHECK(complaint_about(requiring("KHR_materials_unlit").glb()).empty());
  for (const char* name :
       {"KHR_draco_mesh_compression", "EXT_meshopt_compression", "EXT_mesh_gpu_instancing", "FB_ngon"})
    CHECK(contains(complaint_about(requiring(name).glb()), std::string("needs the extension ") + name));
}

TEST_CASE("JSON with embedded, external and missing buffers", "[io]") {
  const test::TemporaryFolder folder;
  auto file = test::sliding_triangle();
  file.more = R"(,"images":[{"uri":"not_there.png"},{"bufferView":0,"mimeType":"image/png"}])";  // never looked at
  CHECK(read_gltf(folder.write("a.gltf", file.gltf()), {"", 2}).sequence.frames[1](0, 0) == 6);
  const auto path = folder.write("b.gltf", file.json("numbers%20of%20b.bin"));
  CHECK(contains(test::complaint<FileError>([&] { read_gltf(path); }), "b.gltf: damaged glTF"));
  folder.write("numbers of b.bin", file.bytes());
  CHECK(read_gltf(path, {"", 2}).sequence.frames[1](0, 0) == 6);
}

TEST_CASE("clips are chosen by their full name or its last part", "[io]") {
  const test::TemporaryFolder folder;
  auto file = test::sliding_triangle();
  const std::string slide = file.animations;
  for (const char* name : {"Rig|run", "Cam|run"}) file.animations += "," + replaced(slide, "Rig|slide", name);
  file.animations += "," + replaced(slide, R"("name":"Rig|slide",)", "");
  const auto path = folder.write("horse.glb", file.glb());
  const auto clips = gltf_clips(path);
  REQUIRE(clips.size() == 4);
  CHECK(clips[1].name == "Rig|run");
  CHECK(clips[1].duration == 2);
  CHECK(clips[3].name == "animation_3");

  const auto first = read_gltf(path, {"", 2});
  CHECK(first.clip == "Rig|slide");
  CHECK(first.clip_chosen_by_default);
  CHECK(first.sequence.name == "horse_slide");
  CHECK_FALSE(read_gltf(path, {"slide", 2}).clip_chosen_by_default);
  CHECK(read_gltf(path, {"Cam|run", 2}).clip == "Cam|run");
  CHECK(read_gltf(path, {"animation_3", 2}).clip == "animation_3");
  CHECK(contains(test::complaint<FileError>([&] { read_gltf(path, {"run", 2}); }), "several clips"));
  const auto unknown = test::complaint<FileError>([&] { read_gltf(path, {"fly", 2}); });
  CHECK(contains(unknown, "'fly': choose one of Rig|slide, Rig|run, Cam|run, animation_3"));
  CHECK_THROWS_AS(read_gltf(path, {"", 1}), InvalidArgument);
}

TEST_CASE("unusable files are named with what is wrong and what to do", "[io]") {
  const auto good = test::sliding_triangle();
  REQUIRE(complaint_about(good.glb()).empty());
  const auto edited = [&](const std::string& what, const std::string& with) {
    return complaint_about(good.glb_of(replaced(good.json(), what, with)));
  };
  CHECK(contains(test::complaint<FileError>([] { read_gltf("no/such/file.glb"); }), "file.glb does not exist"));
  CHECK(contains(test::complaint<FileError>([] { read_gltf("."); }), "is a folder"));
  CHECK(contains(complaint_about(""), "is empty"));
  CHECK(contains(complaint_about("a picture of a horse\n"), "neither a GLB file nor glTF JSON"));
  CHECK(contains(complaint_about("{\"name\": 1}"), "damaged glTF"));
  CHECK(contains(complaint_about(std::string(100000, '[') + std::string(100000, ']')), "neither"));
  CHECK(contains(complaint_about("{\"a\":" + std::string(100000, '[') + std::string(100000, ']') + "}"), "nested"));
  CHECK(contains(edited("\"animations\"", "\"animation_\""), "has no animation"));
  CHECK(contains(edited("\"meshes\"", "\"_meshes\""), "there is no mesh 0"));
  CHECK(contains(edited("\"primitives\"", "\"_primitives\""), "has no triangles"));
  CHECK(contains(edited("\"POSITION\"", "\"_POSITION\""), "no positions"));
  CHECK(contains(edited("LINEAR", "BEZIER"), "'BEZIER'"));
  CHECK(contains(edited("{\"mesh\":0}", "{\"mesh\":0,\"children\":[0]}"), "ancestors"));
  CHECK(contains(edited("{\"mesh\":0}", "{\"mesh\":0,\"children\":[8]}"), "there is no node 8"));
  CHECK(contains(edited("\"count\":3", "\"count\":4000000000"), "claims 4000000000 elements"));
  CHECK(contains(edited("\"byteLength\":36", "\"byteLength\":3600"), "ends behind its buffer"));
  CHECK(contains(edited("\"byteOffset\":36", "\"byteOffset\":18446744073709551612"), "ends behind its buffer"));
  CHECK(contains(edited(",\"count\":2", ",\"count\":1"), "values for 1 keys"));
  const std::string compressed = R"("extensionsRequired":["KHR_draco_mesh_compression"],"asset")";
  CHECK(contains(edited(R"("asset")", compressed), "export it without compression"));
}

TEST_CASE("numbers that make no mesh are refused", "[io]") {
  auto file = test::sliding_triangle();
  const auto with_points = [&](const std::vector<float>& points, const std::vector<std::uint16_t>& corners) {
    file.meshes = R"({"primitives":[{"attributes":{"POSITION":)" + text(file.numbers("VEC3", points)) +
                  R"(},"indices":)" + text(file.numbers("SCALAR", corners)) + "}]}";
    return complaint_about(file.glb());
  };
  CHECK(contains(with_points({0, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 1, 3}), "names vertex 3 of 3"));
  CHECK(contains(with_points({0, 0, 0, 1, 0, 0, 0, std::nanf(""), 0}, {0, 1, 2}), "not a finite number"));
  const float huge = std::numeric_limits<float>::infinity();
  CHECK(contains(with_points({0, 0, 0, 1, 0, 0, 0, huge, 0}, {0, 1, 2}), "not a finite number"));

  auto still = test::sliding_triangle();
  const int key = still.numbers<float>("SCALAR", {1});
  still.animations = test::one_track("pose", key, still.numbers<float>("VEC3", {1, 1, 1}), "LINEAR", "translation");
  CHECK(contains(complaint_about(still.glb()), "clip 'pose' holds a single pose"));
  const int back = still.numbers<float>("SCALAR", {1, 0});
  still.animations =
      test::one_track("back", back, still.numbers<float>("VEC3", {1, 1, 1, 2, 2, 2}), "LINEAR", "translation");
  CHECK(contains(complaint_about(still.glb()), "back in time"));

  const auto arm = test::two_joints();
  CHECK(contains(complaint_about(arm.glb_of(replaced(arm.json(), "[3,4]", "[3]"))), "hangs on joint 1 of 1"));
  CHECK(contains(complaint_about(arm.glb_of(replaced(arm.json(), "[3,4]", "[3,9]"))), "there is no node 9"));
  CHECK(contains(complaint_about(test::two_morphs(3).glb()), "replaces element 3 of 3"));
}

TEST_CASE("no damage to a file is worse than an error", "[io]") {
  int read_count = 0, refused = 0;
  const auto survive = [&](const std::string& bytes) {
    try {
      detail::gltf::bake(detail::gltf::parse_gltf(bytes, "damaged.glb"), {"", 2});
      ++read_count;
    } catch (const Error&) {
      ++refused;
    }
  };
  for (const auto& file : {test::two_joints(), test::two_morphs()}) {
    const std::string whole = file.glb();
    for (std::size_t size = 0; size < whole.size(); size += 31) survive(whole.substr(0, size));
    for (std::size_t place = 0; place < whole.size(); ++place) {
      std::string changed = whole;
      changed[place] = "9-\"\xFF"[place % 4];
      survive(changed);
    }
  }
  CHECK(refused > 500);
  CHECK(read_count > 500);  // names, positions and weights may change without harm
}

}  // namespace gltf_reader_test
