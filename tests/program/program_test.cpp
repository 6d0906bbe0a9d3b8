#include "catch.hpp"
#include "support/meshes.hpp"
#include "support/temporary_folder.hpp"

#include <dsns/io/gltf.hpp>
#include <dsns/mesh/sphere_mesh.hpp>
#include <dsns/sphere/rotations.hpp>
#include <dsns/surface/analytic.hpp>
#include <dsns/surface/bodies.hpp>

#include <sys/wait.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

namespace program_test {

#ifdef DSNS_PROGRAM

using namespace dsns;

namespace {

struct Run {
  int status;
  std::string out, err;
};

std::string read(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

Run run(const std::filesystem::path& folder, const std::string& arguments) {
  // Without programs to call: pictures take seconds.
  const std::string command = "PATH=/none \"" DSNS_PROGRAM "\" " + arguments + " >\"" + (folder / "out").string() +
                              "\" 2>\"" + (folder / "err").string() + "\" </dev/null";
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read(folder / "out"), read(folder / "err")};
}

std::string quoted(const std::filesystem::path& path) { return "\"" + path.string() + "\""; }

/// A mesh that grows, so that the clip moves.
MeshSequence growing(const TriangleMesh& mesh) {
  MeshSequence sequence;
  sequence.faces = mesh.faces;
  sequence.frames = {mesh.vertices, 1.1 * mesh.vertices};
  return sequence;
}

std::size_t count(const std::string& text, const std::string& word) {
  std::size_t found = 0;
  for (std::size_t at = 0; (at = text.find(word, at)) != std::string::npos; at += word.size()) ++found;
  return found;
}

/// The first number after a key of a JSON text.
double number_after(const std::string& json, const std::string& key) {
  const std::size_t at = json.find("\"" + key + "\": ");
  REQUIRE(at != std::string::npos);
  return std::stod(json.substr(at + key.size() + 4));
}

void check_refused(const Run& r, const std::string& reason) {
  INFO("stderr: " << r.err);
  CHECK(r.status == 1);
  CHECK(r.err.rfind("dsns: ", 0) == 0);
  CHECK(std::count(r.err.begin(), r.err.end(), '\n') == 1);
  CHECK(r.err.find(reason) != std::string::npos);
}

}  // namespace

TEST_CASE("unusable input ends with status 1 and one sentence", "[program]") {
  const test::TemporaryFolder folder;
  const auto file = [&](const std::string& name) { return folder.path() / name; };
  std::ofstream(file("empty.glb"));
  std::ofstream(file("text.glb")) << "This is a letter, not a mesh.\n";
  write_gltf(file("torus.glb"), growing(test::torus(20, 10)));
  TriangleMesh far = icosphere(2);
  far.vertices.row(0).array() += 5;
  write_gltf(file("two.glb"), growing(test::joined(icosphere(2), far)));
  write_gltf(file("ball.glb"), growing(icosphere(2)));

  check_refused(run(folder.path(), "fit " + quoted(file("nowhere.glb"))), "nowhere.glb");
  check_refused(run(folder.path(), "fit " + quoted(file("empty.glb"))), "empty");
  check_refused(run(folder.path(), "fit " + quoted(file("text.glb"))), "text.glb");
  check_refused(run(folder.path(), "fit \"" + file("ball.glb").string() + "#Gallop\""), "Gallop");
  check_refused(run(folder.path(), "fit " + quoted(file("torus.glb"))), "genus");
  check_refused(run(folder.path(), "fit " + quoted(file("two.glb"))), "pieces");
  check_refused(run(folder.path(), "mean " + quoted(file("ball.glb")) + " " + quoted(file("torus.glb"))), "genus");
  check_refused(run(folder.path(), "evaluate representation " + quoted(file("nowhere.glb"))), "nowhere.glb");
  std::filesystem::create_directory(file("empty"));
  check_refused(run(folder.path(), "evaluate representation " + quoted(file("empty"))), "empty");
  // Before the work, not after it.
  check_refused(run(folder.path(),
                    "evaluate representation " + quoted(file("ball.glb")) + " --csv " + quoted(file("none") / "t.csv")),
                "folder");
  check_refused(run(folder.path(), "fit " + quoted(file("ball.glb")) + " -o " + quoted(file("none") / "out.glb")),
                "folder");
  check_refused(run(folder.path(), "fit " + quoted(file("ball.glb")) + " -o " + quoted(file("out.obj"))), ".glb");
}

TEST_CASE("landmarks draw a registration to them, and those that cannot be used are named with their line",
          "[program]") {
  const test::TemporaryFolder folder;
  const auto file = [&](const std::string& name) { return folder.path() / name; };
  LimbedBody body;
  body.limbs = {{Vec3d(1, 0.5, 0).normalized(), 6, Vec3d(1, 0.4, 0), Vec3d(0, 0.4, 0.2)}};
  const TriangleMesh sphere = icosphere(2);
  const Index n = sphere.vertices.cols();
  write_gltf(file("a.glb"), sequence_of(body, sphere, 3));
  // The same body, with a loose ball behind its vertices.
  MeshSequence with_ball = sequence_of(body, sphere, 3);
  with_ball.faces = test::joined(sphere, icosphere(0)).faces;
  for (Mat3X& frame : with_ball.frames) {
    const Mat3X ball = (0.05 * icosphere(0).vertices).colwise() + Vec3d(0, 3, 0);
    frame.conservativeResize(3, n + ball.cols());
    frame.rightCols(ball.cols()) = ball;
  }
  write_gltf(file("b.glb"), with_ball);
  const std::string both = quoted(file("a.glb")) + " " + quoted(file("b.glb")) + " --frames 3 --landmarks ";

  // Vertices of the first, each with one of the second half a radian away: nothing but landmarks would bring them together.
  std::string used = "a, b # the names of columns\n", held_out;
  for (const Vec3d& s : {Vec3d(-1, 0, 0), Vec3d(0, 0, 1), Vec3d(0, -1, 0)}) {
    const auto nearest = [&](const Vec3d& p) {
      Index v = 0;
      (p.transpose() * sphere.vertices).maxCoeff(&v);
      return v;
    };
    const Vec3d away = std::cos(0.5) * s + std::sin(0.5) * Vec3d(s.z(), s.x(), s.y());
    const std::string pair = std::to_string(nearest(s)) + ", " + std::to_string(nearest(away));
    used += pair + "\n";
    held_out += pair + ", 0\n";
  }
  std::ofstream(file("used.csv")) << used;
  std::ofstream(file("held_out.csv")) << held_out;
  const Run drawn = run(folder.path(), "register " + both + quoted(file("used.csv")) +
                                           " --spatial-only --landmark-weight 5 --json " + quoted(file("used.json")));
  INFO(drawn.out << drawn.err);
  REQUIRE(drawn.status == 0);
  const Run free = run(folder.path(),
                       "register " + both + quoted(file("held_out.csv")) + " --json " + quoted(file("held_out.json")));
  INFO(free.out << free.err);
  REQUIRE(free.status == 0);
  const std::string with = read(file("used.json")), without = read(file("held_out.json"));
  CHECK(with.find("\"landmarks_held_out\"") == std::string::npos);
  CHECK(without.find("\"landmarks\"") == std::string::npos);
  CHECK(number_after(with, "number") == 3);
  CHECK(number_after(without, "missed_deg") > 20);  // one body seen twice stays where it is
  CHECK(number_after(with, "missed_deg") < 0.5 * number_after(without, "missed_deg"));
  CHECK(number_after(with, "missed_percent") < 0.6 * number_after(without, "missed_percent"));

  struct Wrong {
    std::string text, reason;
  };
  for (const Wrong& wrong :
       {Wrong{"0, 0\n\n162, 1\n", "line 3: there is no vertex 162 in the first mesh"},
        Wrong{"a, b\n1, -1\n", "no vertex -1"}, Wrong{"0, " + std::to_string(n) + "\n", "dropped"},
        Wrong{"1, 1.5\n", "line 1: '1.5' is not the number"}, Wrong{"1, 2\n3\n", "line 2: 1 column"},
        Wrong{"1, 2, -1\n", "'-1' is not a weight"}, Wrong{"# nothing\n", "no landmarks"}}) {
    std::ofstream(file("wrong.csv")) << wrong.text;
    check_refused(run(folder.path(), "register " + both + quoted(file("wrong.csv"))), wrong.reason);
  }
  check_refused(run(folder.path(), "register " + both + quoted(file("nowhere.csv"))), "nowhere.csv does not exist");
}

TEST_CASE("frames with triangles of their own become one animation", "[program]") {
  const test::TemporaryFolder folder;
  const auto file = [&](const std::string& name) { return folder.path() / name; };
  const auto write_frame = [&](const std::string& in, const std::string& name, const TriangleMesh& mesh) {
    std::filesystem::create_directories(file(in));
    std::ofstream out(file(in) / name);
    for (Index v = 0; v < mesh.vertices.cols(); ++v) out << "v " << mesh.vertices.col(v).transpose() << '\n';
    for (Index f = 0; f < mesh.faces.cols(); ++f) out << "f " << (mesh.faces.col(f).array() + 1).transpose() << '\n';
  };
  LimbedBody body;
  body.axes = {1, 0.7, 0.6};
  body.limbs = {{Vec3d(0.8, -0.7, -0.5).normalized(), 6, Vec3d(0.3, -0.9, -0.2), Vec3d(0, 0.3, 0.2)},
                {Vec3d(-0.8, 0.6, -0.5).normalized(), 6, Vec3d(-0.2, 0.6, -0.7), Vec3d(0.3, 0, 0.1)}};
  const auto place = [](const Mat3X& x) { return Mat3X((40 * x).colwise() + Vec3d(100, 0, 0)); };
  const TriangleMesh ball = icosphere(3);
  for (int k = 0; k < 3; ++k) {
    const TriangleMesh mesh = k == 1 ? latitude_longitude_sphere(18, 30) : ball;
    const Mat3X s = rotation_exp(k * Vec3d(1.1, -0.7, 0.4)) * mesh.vertices;
    write_frame("scans", "frame_" + std::to_string(k + 8) + ".obj", {place(positions(body, s, 0.1 * k)), mesh.faces});
  }
  check_refused(run(folder.path(), "inspect " + quoted(file("scans"))), "dsns track");
  const Run r = run(folder.path(), "track " + quoted(file("scans")) + " -o " + quoted(file("one.glb")) + " --json " +
                                       quoted(file("t.json")));
  INFO(r.out << r.err);
  REQUIRE(r.status == 0);
  const MeshSequence one = read_gltf(file("one.glb"), {"", 3}).sequence;
  REQUIRE(one.vertex_count() == ball.vertices.cols());
  REQUIRE(one.frame_count() == 3);
  const Mat3X truth = place(positions(body, ball.vertices, 0.2));
  const Mat3X moved = one.frames.back().colwise() - Vec3d(one.frames.back().rowwise().mean() - truth.rowwise().mean());
  CHECK((moved - truth).colwise().norm().mean() <
        0.02 * (truth.rowwise().maxCoeff() - truth.rowwise().minCoeff()).norm());
  const std::string json = read(file("t.json"));
  CHECK(count(json, "\"energy_left\": ") == 2);
  CHECK(number_after(json, "most_energy_left") < 0.05);
  CHECK(number_after(json, "min_jacobian") > 0);

  const Run few =
      run(folder.path(), "track " + quoted(file("scans")) + " --frames 2 --views 0 --json " + quoted(file("few.json")));
  REQUIRE(few.status == 0);
  CHECK(number_after(read(file("few.json")), "duration") == Approx(2 / 24.0));  // of all three

  std::filesystem::create_directory(file("empty"));
  check_refused(run(folder.path(), "track " + quoted(file("empty"))), "holds 0");
  write_frame("single", "a.obj", ball);
  check_refused(run(folder.path(), "track " + quoted(file("single"))), "holds 1");
  write_frame("single", "b.obj", test::torus(20, 10));
  const Run torus = run(folder.path(), "track " + quoted(file("single")));
  check_refused(torus, "genus");
  CHECK(torus.err.find("b.obj") != std::string::npos);
  check_refused(run(folder.path(), "track " + quoted(file("scans")) + " -o " + quoted(file("scans") / "one.glb")),
                "outside");
}

TEST_CASE("wrong usage ends with status 2, help with 0", "[program]") {
  const test::TemporaryFolder folder;
  for (const std::string usage :
       {"", "frobnicate", "fit", "register one.glb", "fit a.glb --frames 1", "fit a.glb --threads x",
        "mean a.glb b.glb --surface cubist", "inspect a.glb --no-such-option", "evaluate", "evaluate shapes a.glb",
        "evaluate representation", "evaluate representation a.glb --preset quick", "fit a.glb --target-msd x"}) {
    INFO(usage);
    const Run r = run(folder.path(), usage);
    CHECK(r.status == 2);
    CHECK_FALSE(r.err.empty());
  }
  // The words that are wrong are named.
  CHECK(run(folder.path(), "inspct a.glb").err.find("'inspct'") != std::string::npos);
  CHECK(run(folder.path(), "fit a.glb --step 10").err.find("--step") != std::string::npos);
  CHECK(run(folder.path(), "mean a.glb b.glb --surface cubist").err.find("neural or sampled") != std::string::npos);
  CHECK(run(folder.path(), "evaluate shapes a.glb").err.find("'shapes'") != std::string::npos);
  CHECK(run(folder.path(), "evaluate representation a.glb --second 3").err.find("--second") != std::string::npos);
  CHECK(run(folder.path(), "fit a.glb --preset quick").err.find("fast or general or paper") != std::string::npos);
  CHECK(run(folder.path(), "evaluate representation --help").status == 0);
  CHECK(run(folder.path(), "--help").status == 0);
  CHECK(run(folder.path(), "mean --help").status == 0);
  CHECK(run(folder.path(), "--version").status == 0);
}

TEST_CASE("inspect reports a torus without refusing it, and writes JSON", "[program]") {
  const test::TemporaryFolder folder;
  write_gltf(folder.path() / "torus.glb", growing(test::torus(20, 10)));
  const Run r = run(folder.path(),
                    "inspect " + quoted(folder.path() / "torus.glb") + " --json " + quoted(folder.path() / "t.json"));
  CHECK(r.status == 0);
  const std::string json = read(folder.path() / "t.json");
  CHECK(json.find("\"euler_characteristic\": 0") != std::string::npos);
  CHECK(json.find("\"usable\": false") != std::string::npos);
}

TEST_CASE("two bodies go through registration, and the result can be read again", "[program]") {
  const test::TemporaryFolder folder;
  LimbedBody body;
  body.limbs = {{Vec3d(1, 0.5, 0).normalized(), 6, Vec3d(1, 0.4, 0), Vec3d(0, 0.4, 0.2)}};
  LimbedBody other = body;
  other.axes = {1.2, 0.9, 1};
  other.pace = 0.3;
  write_gltf(folder.path() / "a.glb", sequence_of(body, icosphere(2), 6));
  write_gltf(folder.path() / "b.glb", sequence_of(other, latitude_longitude_sphere(9, 14), 6));
  const Run r =
      run(folder.path(), "geodesic " + quoted(folder.path() / "a.glb") + " " + quoted(folder.path() / "b.glb") +
                             " --frames 6 --points 3 -o " + quoted(folder.path() / "way.glb"));
  INFO(r.err);
  REQUIRE(r.status == 0);
  CHECK(r.out.find("distance") != std::string::npos);
  const MeshSequence way = read_gltf(folder.path() / "way.glb", {"", 6}).sequence;
  CHECK(way.vertex_count() == 3 * icosphere(2).vertices.cols());
  CHECK(way.frame_count() == 6);

  const Run moved =
      run(folder.path(), "transfer " + quoted(folder.path() / "a.glb") + " " + quoted(folder.path() / "b.glb") +
                             " --frames 6 -o " + quoted(folder.path() / "as_a.glb"));
  INFO(moved.out << moved.err);
  REQUIRE(moved.status == 0);
  const MeshSequence all = read_gltf(folder.path() / "as_a.glb", {"", 6}).sequence;
  CHECK(all.vertex_count() == icosphere(2).vertices.cols() + 2 * latitude_longitude_sphere(9, 14).vertices.cols());

  const Run laws = run(folder.path(), "evaluate consistency " + quoted(folder.path() / "a.glb") + " " +
                                          quoted(folder.path() / "b.glb") + " --frames 6 --degrees 3 --json " +
                                          quoted(folder.path() / "laws.json"));
  INFO(laws.out << laws.err);
  REQUIRE(laws.status == 0);
  const std::string json = read(folder.path() / "laws.json");
  CHECK(number_after(json, "min_jacobian") > 0);
  CHECK(number_after(json, "turned_rms_deg") < 0.1);
  CHECK(number_after(json, "inverse_rms_deg") < 10);  // two coarse, nearly round bodies of different shape
  CHECK(number_after(json, "warped_rms_deg") < 3);
}

TEST_CASE("a representation is evaluated on every file of a folder, and a broken one does not stop the rest",
          "[program]") {
  const test::TemporaryFolder folder;
  const auto file = [&](const std::string& name) { return folder.path() / name; };
  std::filesystem::create_directories(file("data") / "more");
  LimbedBody body;
  body.limbs = {{Vec3d(1, 0.5, 0).normalized(), 6, Vec3d(1, 0.4, 0), Vec3d(0, 0.4, 0.2)}};
  write_gltf(file("data") / "a.glb", sequence_of(body, icosphere(2), 6));
  body.pace = 0.4;
  write_gltf(file("data") / "more" / "c.glb", sequence_of(body, icosphere(2), 6));
  std::ofstream(file("data") / "b.glb") << "no mesh";
  const Run r = run(folder.path(), "evaluate representation " + quoted(file("data")) +
                                       " --preset general --steps 20 --rate 12 --frames-trained 5 -o " +
                                       quoted(file("maps")) + " --json " + quoted(file("t.json")) + " --csv " +
                                       quoted(file("t.csv")) + " --markdown " + quoted(file("t.md")));
  INFO(r.out);
  check_refused(r, "b.glb");
  const std::string json = read(file("t.json")), csv = read(file("t.csv")), markdown = read(file("t.md"));
  const std::string rows =
      json.substr(json.find("\"rows\": ["), json.find("\"failures\": [") - json.find("\"rows\": ["));
  for (const std::string key : {"file", "msd_heldout", "rms_distance_heldout", "normal_angle_mean_deg", "wall_seconds"})
    CHECK(count(rows, "\"" + key + "\": ") == 2);
  CHECK(number_after(rows, "frames") == 13);
  CHECK(number_after(rows, "frames_trained") == 5);
  CHECK(number_after(rows, "steps") == 20);
  CHECK(number_after(rows, "rms_distance_heldout") == Approx(std::sqrt(3 * number_after(rows, "msd_heldout"))));
  CHECK(number_after(rows, "ratio_to_interpolation") ==
        Approx(number_after(rows, "msd_other_frames") / number_after(rows, "msd_interpolation")));
  CHECK(count(json, "b.glb") >= 1);
  const double first = number_after(rows, "msd_heldout"),
               second = number_after(rows.substr(rows.rfind("\"file\": ")), "msd_heldout");
  const std::string summary = json.substr(json.find("\"summary\": "));
  CHECK(number_after(summary, "mean") == Approx((first + second) / 2));
  CHECK(number_after(summary, "median") == Approx((first + second) / 2));
  CHECK(number_after(summary, "std") == Approx(std::abs(first - second) / std::sqrt(2)).margin(1e-12));
  CHECK(count(csv, "\n") == 3);
  CHECK(csv.rfind("file,frames,msd_heldout,", 0) == 0);
  CHECK(count(markdown, "paper, DFAUST") == 2);
  CHECK(count(markdown, "c.glb#") == 2);
  const MeshSequence map = read_gltf(file("maps") / "a_motion_error.glb", {"", 6}).sequence;
  CHECK(count(r.out, "No picture") == 2);
  CHECK(map.vertex_count() == icosphere(2).vertices.cols());
}

TEST_CASE("known warps of a motion are recovered, by all methods, and pairs are compared", "[program]") {
  const test::TemporaryFolder folder;
  const auto file = [&](const std::string& name) { return folder.path() / name; };
  LimbedBody body;
  body.limbs = {{Vec3d(1, 0.5, 0).normalized(), 6, Vec3d(1, 0.4, 0), Vec3d(0, 0.4, 0.2)}};
  write_gltf(file("a.glb"), sequence_of(body, icosphere(2), 40));
  write_gltf(file("b.glb"), sequence_of(body, icosphere(2), 40));
  const Run r = run(folder.path(), "evaluate temporal " + quoted(file("a.glb")) +
                                       " --rate 40 --warps 2 --networks 0 --surface sampled -o " +
                                       quoted(file("boxes")) + " --json " + quoted(file("t.json")) + " --csv " +
                                       quoted(file("t.csv")) + " --markdown " + quoted(file("t.md")));
  INFO(r.out << r.err);
  REQUIRE(r.status == 0);
  const std::string json = read(file("t.json")), rows = json.substr(json.find("\"rows\": ["));
  // Two warps: before, dp and ours from all frames and from 25, dp and ours of 50 and 25 raw samples.
  CHECK(count(rows, "\"warp_l2\": ") == 2 * (3 + 3 + 2 + 2));
  for (const std::string key : {"file", "method", "samples", "seconds"}) CHECK(count(rows, "\"" + key + "\": ") >= 20);
  const std::string ours = rows.substr(rows.find("\"method\": \"ours\"")), before = rows;
  CHECK(number_after(before, "warp_l2") > 0.02);
  CHECK(number_after(ours, "warp_l2") < 1e-3);
  CHECK(count(read(file("t.csv")), "\n") == 21);
  CHECK(count(read(file("t.md")), "ours; sampled from all frames") == 1);
  CHECK(count(r.out, "No picture") == 1);
  CHECK(read(file("boxes") / "temporal_warps.gnuplot").find("boxplot") != std::string::npos);

  const Run pair = run(folder.path(), "evaluate temporal " + quoted(file("a.glb")) + " " + quoted(file("b.glb")) +
                                          " --rate 40 --warps 1 --json " + quoted(file("p.json")));
  INFO(pair.out << pair.err);
  REQUIRE(pair.status == 0);
  const std::string pairs = read(file("p.json"));
  CHECK(count(pairs, "\"distance\": ") == 5);  // before, three of dynamic programming, ours
  check_refused(run(folder.path(), "evaluate temporal " + quoted(file("nowhere.glb"))), "nowhere.glb");
}

TEST_CASE("a group has modes, new members and distances; a broken file is left out where that is asked for",
          "[program]") {
  const test::TemporaryFolder folder;
  const auto file = [&](const std::string& name) { return folder.path() / name; };
  std::string files;
  for (int i = 0; i < 4; ++i) {
    LimbedBody body;
    body.limbs = {{Vec3d(1, 0.5, 0).normalized(), 6, Vec3d(1, 0.4, 0), Vec3d(0, 0.4, 0.2)}};
    if (i >= 2) body.axes = {1.3, 0.9, 1};
    body.pace = 0.1 * (i % 2);
    const auto path = file(std::string(1, char('a' + i)) + ".glb");
    write_gltf(path, sequence_of(body, icosphere(2), 8));
    files += " " + quoted(path);
  }
  const std::string quick = " --frames 8 --threads 2 --json " + quoted(file("r.json"));

  const std::string kept_here = quick + " --work " + quoted(file("kept"));  // registered once
  const Run modes = run(folder.path(), "modes" + files + kept_here + " --modes 2 -o " + quoted(file("modes")) +
                                           " --csv " + quoted(file("m.csv")));
  INFO(modes.out << modes.err);
  REQUIRE(modes.status == 0);
  const std::string json = read(file("r.json"));
  CHECK(count(json, "\"scores\": ") == 4);
  for (const std::string key : {"compactness", "generalisation", "specificity"})
    CHECK(count(json, "\"" + key + "\": ") == 1);
  CHECK(count(read(file("m.csv")), "\n") == 5);
  CHECK(read_gltf(file("modes") / "mode_1.glb", {"", 8}).sequence.vertex_count() == 5 * icosphere(2).vertices.cols());
  CHECK(std::filesystem::exists(file("modes") / "mode_2.glb"));
  CHECK_FALSE(std::filesystem::exists(file("modes") / "mode_3.glb"));

  const Run sample = run(
      folder.path(), "sample" + files + kept_here + " --count 3 --modes 2 --part shape -o " + quoted(file("s.glb")));
  INFO(sample.out << sample.err);
  REQUIRE(sample.status == 0);
  CHECK(read_gltf(file("s.glb"), {"", 8}).sequence.vertex_count() == 3 * icosphere(2).vertices.cols());
  CHECK(number_after(read(file("r.json")), "sample_valid") == 3);
  const Run torn = run(folder.path(), "sample" + files + kept_here + " --count 3 --part start --spread 300 --folded 0");
  CHECK(torn.status == 1);
  CHECK(torn.err.find("--spread") != std::string::npos);
  CHECK(number_after(read(file("r.json")), "sample_draws") == 60);

  const Run distances =
      run(folder.path(), "distances" + files + kept_here +
                             " --part start --labels thin,thin,thick,thick --covariate 1,1,1.3,1.3 --csv " +
                             quoted(file("d.csv")));
  INFO(distances.out << distances.err);
  REQUIRE(distances.status == 0);
  const std::string group = read(file("r.json"));
  CHECK(number_after(group, "accuracy") == 1);
  CHECK(number_after(group, "chance") == Approx(1.0 / 3));
  CHECK(number_after(group, "p_value") == Approx(1.0 / 3).margin(0.06));  // one of three ways to make two pairs
  CHECK(number_after(group, "explained") > 0.9);
  CHECK(count(read(file("d.csv")), "\n") == 5);
  check_refused(run(folder.path(), "distances" + files + " --frames 8 --labels thin,thick"), "2 labels for 4");
  const Run bodies =
      run(folder.path(), "distances" + files + kept_here + " --part body --labels thin,thin,thick,thick");
  INFO(bodies.out << bodies.err);
  if (bodies.status == 0) {
    CHECK(number_after(read(file("r.json")), "accuracy") == 1);
    CHECK(number_after(read(file("r.json")), "eigenvalues") == 16);  // one for ten vertices
  } else {
    CHECK(bodies.err.find("Spectra") != std::string::npos);
  }

  std::ofstream(file("broken.glb")) << "no mesh";
  const std::string with_broken =
      "mean " + quoted(file("broken.glb")) + files + quick + " -o " + quoted(file("mean.glb"));
  const Run refused = run(folder.path(), with_broken);
  CHECK(refused.status == 1);
  CHECK(refused.err.find("broken.glb") != std::string::npos);
  CHECK(refused.err.find("--keep-going") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(file("mean.glb")));
  const Run kept = run(folder.path(), with_broken + " --keep-going");
  INFO(kept.out << kept.err);
  CHECK(kept.status == 0);
  CHECK(kept.err.find("broken.glb") != std::string::npos);
  CHECK(std::filesystem::exists(file("mean.glb")));
  CHECK(count(read(file("r.json")), "\"left_out\"") == 1);

  // Labels are of the files named, whether they can be used or not; what a work folder keeps is found again.
  const std::string labelled = "distances " + quoted(file("broken.glb")) + files + quick +
                               " --part start --labels none,thin,thin,thick,thick --keep-going --work " +
                               quoted(file("work")) + " --csv ";
  const Run fresh = run(folder.path(), labelled + quoted(file("d1.csv")));
  INFO(fresh.out << fresh.err);
  REQUIRE(fresh.status == 0);
  CHECK(number_after(read(file("r.json")), "accuracy") == 1);
  CHECK(read(file("d1.csv")) == read(file("d.csv")));
  const Run continued = run(folder.path(), labelled + quoted(file("d2.csv")));
  REQUIRE(continued.status == 0);
  CHECK(count(fresh.out, "found in") == 0);
  CHECK(count(continued.out, "found in") == 4);
  CHECK(read(file("d2.csv")) == read(file("d1.csv")));
}

TEST_CASE("a fit ends at its target error, which it names", "[program]") {
  const test::TemporaryFolder folder;
  write_gltf(folder.path() / "ball.glb", growing(icosphere(2)));
  const Run r = run(folder.path(), "fit " + quoted(folder.path() / "ball.glb") +
                                       " --preset general --frames 2 --target-msd 1e-3 --json " +
                                       quoted(folder.path() / "t.json"));
  INFO(r.err);
  REQUIRE(r.status == 0);
  const std::string json = read(folder.path() / "t.json");
  CHECK(json.find("\"stop\": \"target\"") != std::string::npos);
  CHECK(number_after(json, "msd_heldout") < 2e-3);
  CHECK(number_after(json, "steps") < 12000);
}

#endif

}  // namespace program_test
