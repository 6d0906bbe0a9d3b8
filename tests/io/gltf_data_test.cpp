#include "catch.hpp"

#include <dsns/io/frames.hpp>
#include <dsns/io/gltf_reader.hpp>
#include <dsns/mesh/repair.hpp>

#include <filesystem>

namespace gltf_data_test {

using namespace dsns;
namespace fs = std::filesystem;

namespace {

#ifdef DSNS_TEST_DATA_DIR
const fs::path data_folder = DSNS_TEST_DATA_DIR;
#else
const fs::path data_folder;
#endif

struct Expected {
  const char* file;
  Index vertices, faces, caps;
  const char* action;  ///< the last of what repair has to do
};

/// The counts that the data's own description gives for the cleaned main component; caps come on top.
const Expected animals_and_people[] = {
    {"humans/mh_man.glb", 13380, 26756, 0, nullptr},
    {"humans/mh_woman.glb", 13380, 26756, 0, nullptr},
    {"humans/mh_heavyman.glb", 13380, 26756, 0, nullptr},
    {"faces/ict_face_11.glb", 14062 + 1, 28068, 54, "closed 1 hole with 54 rim edges"},
    {"faces/ict_face_12.glb", 14062 + 1, 28068, 54, "closed 1 hole with 54 rim edges"},
    {"faces/ict_face_13.glb", 14062 + 1, 28068, 54, "closed 1 hole with 54 rim edges"},
    {"quadrupeds/Horse.glb", 1093, 2182, 0, "welded 4400 vertices to 1093"},
    {"quadrupeds/Donkey.glb", 0, 0, 0, "welded 4044 vertices to 1002"},
    {"quadrupeds/Cow.glb", 0, 0, 0, "dropped 2 loose pieces with 1.8 % of the area"},
    {"quadrupeds/Deer.glb", 0, 0, 2, "closed 2 holes with 6 rim edges"},
    {"quadrupeds/Fox.glb", 926, 1848, 0, "welded 3752 vertices to 926"},
    {"quadrupeds/Wolf.glb", 0, 0, 0, "welded 3994 vertices to 983"},
    {"swimmers/Dolphin.glb", 222, 440, 0, "welded 865 vertices to 222"},
    {"swimmers/Shark.glb", 324, 644, 0, "welded 1256 vertices to 324"},
    {"swimmers/Whale.glb", 0, 0, 0, "dropped 3 degenerate or duplicate faces"},
    {"toons/KhronosFox.glb", 290, 576, 0, "welded 1728 vertices to 290"},
};

}  // namespace

TEST_CASE("real animations become closed surfaces of genus 0", "[io][data]") {
  if (!fs::exists(data_folder / "humans")) DSNS_SKIP("DSNS_TEST_DATA_DIR has no animations");
  for (const Expected& expected : animals_and_people) {
    CAPTURE(expected.file);
    const auto animation = read_gltf(data_folder / expected.file, {"", 3});
    CHECK(animation.clip_chosen_by_default);
    const auto result = repair(animation.sequence);
    CHECK(result.after.genus == 0);
    CHECK(result.sequence.cap_faces == expected.caps);
    if (expected.vertices > 0) {
      CHECK(result.after.vertices == expected.vertices);
      CHECK(result.after.faces - result.sequence.cap_faces == expected.faces);
    }
    REQUIRE(result.actions.empty() == (expected.action == nullptr));
    if (expected.action != nullptr) CHECK(result.actions.back() == expected.action);
    CHECK(result.after.faces == 2 * result.after.vertices - 4);
    for (int k = 0; k < 3; ++k) CHECK(volume(result.sequence.frame(k)) > 0);
  }
}

TEST_CASE("baked gallops agree with those baked by other hands", "[io][data]") {
  if (!fs::exists(data_folder / "obj_sequences")) DSNS_SKIP("DSNS_TEST_DATA_DIR has no OBJ sequences");
  for (const std::string animal : {"Cow", "Fox", "Horse", "Wolf"}) {
    CAPTURE(animal);
    const auto theirs = read_frames(data_folder / "obj_sequences" / (animal + "_Gallop"));
    // Their frames divide the cycle: the 25th would be the first one again, ours ends with it.
    const auto raw = read_gltf(data_folder / "quadrupeds" / (animal + ".glb"), {"Gallop", 25}).sequence;
    const auto ours = repair(raw).sequence;
    REQUIRE(ours.vertex_count() == theirs.vertex_count());
    REQUIRE(theirs.frame_count() == 24);
    CHECK(ours.faces.cols() == theirs.faces.cols());
    std::vector<Index> partner;  // in the first frame; the same vertices must stay partners in all others
    for (Index v = 0; v < ours.vertex_count(); ++v)
      (theirs.frames[0].colwise() - ours.frames[0].col(v)).colwise().norm().minCoeff(&partner.emplace_back());
    const double size = detail::diagonal(theirs.frames[0]);
    for (std::size_t k = 0; k < 24; ++k)
      CHECK((theirs.frames[k](Eigen::all, partner) - ours.frames[k]).colwise().norm().maxCoeff() < 1e-6 * size);
  }
}

TEST_CASE("every clip of every real file can be read", "[io][data]") {
  if (!fs::exists(data_folder / "quadrupeds")) DSNS_SKIP("DSNS_TEST_DATA_DIR has no animations");
  int clips = 0;
  for (const char* file : {"humans/mh_man.glb", "quadrupeds/Fox.glb", "quadrupeds/Deer.glb", "toons/KhronosFox.glb"})
    for (const auto& clip : gltf_clips(data_folder / file)) {
      CAPTURE(file, clip.name);
      const auto animation = read_gltf(data_folder / file, {clip.name, 2});
      CHECK(animation.clip == clip.name);
      CHECK(animation.sequence.duration == clip.duration);
      ++clips;
    }
  CHECK(clips >= 34);  // 6 + 12 or 13 + 13 + 3
}

}  // namespace gltf_data_test
