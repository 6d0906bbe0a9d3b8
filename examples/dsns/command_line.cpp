#include "command_line.hpp"

#include <dsns/core/errors.hpp>
#include <dsns/io/frames.hpp>
#include <dsns/io/source_name.hpp>
#include <dsns/version.hpp>

#include <filesystem>
#include <iostream>
#include <thread>

namespace dsns::program {

namespace {

/// The options that several subcommands share, on each of them.
void add_common(CLI::App* command, Settings& settings) {
  command->add_option("--frames", settings.frames, "equidistant frames read from a clip")
      ->capture_default_str()
      ->check(CLI::Range(2, 1000));
  command->add_option("--rate", settings.rate, "frames a second: of a clip, instead of --frames; of frame files (24)")
      ->check(CLI::Range(0.0, 1e5));
  command->add_option("--node", settings.node, "of a glTF file, only the meshes at this node and below it");
  command->add_option("--faces", settings.faces, "mesh file with the faces of .npy and .npz vertices");
  command->add_option("--piece", settings.repair.piece, "of a mesh in pieces, the one that counts: 1 for the largest")
      ->check(CLI::Range(1, 1000));
  command->add_flag("--join", settings.join, "join comparable pieces by tubes")->excludes("--piece");
  command->add_option("--threads", settings.threads, "threads to use")
      ->capture_default_str()
      ->check(CLI::Range(1, 256));
  command->add_option("--seed", settings.seed, "of everything random")->capture_default_str();
  command->add_option("--json", settings.json, "write every figure to this file");
}

/// Likewise for a result on the first file's own mesh.
void check_own_mesh(const std::string& path, const std::string& source) {
  if (path.empty()) return;
  const std::string extension = dsns::lower_extension(path);
  const std::string first = dsns::lower_extension(dsns::parse_source(source).file);
  dsns::require<dsns::FileError>(extension.empty() || extension == ".npy" || extension == ".glb", "cannot write ", path,
                                 ": name a .glb, a .npy or a folder");
  dsns::require<dsns::FileError>(extension != ".glb" || first == ".glb" || first == ".gltf", "cannot write ", path,
                                 ": ", source, " is no glTF file to take materials from; name a .npy or a folder");
  if (!extension.empty()) check_output(path, "");
}

}  // namespace

void check_output(const std::string& path, const std::string& extension) {
  if (path.empty()) return;
  const std::filesystem::path file(path), folder = file.has_parent_path() ? file.parent_path() : ".";
  dsns::require<dsns::FileError>(std::filesystem::is_directory(folder), "cannot write ", path, ": there is no folder ",
                                 folder.string(), "; make it first");
  dsns::require<dsns::FileError>(extension.empty() || file.extension() == extension, "cannot write ", path,
                                 ": name it *", extension);
}

void add_fit(CLI::App* command, Settings& settings) {
  add_choice(command, "--preset", settings.preset,
             {{"fast", Preset::fast}, {"general", Preset::general}, {"paper", Preset::paper}},
             "fast: temporal modes, harmonics and local functions, closed forms; general: one network of point and "
             "time; paper: that of "
             "the D-SNS paper, which takes weeks");
  command->add_option("--steps", settings.steps, "training steps of a network (0: the preset's)")
      ->check(CLI::Range(0, 10000000));
  command->add_option("--seconds", settings.seconds, "wall time of a fit, at most (0: no limit)")
      ->check(CLI::Range(0.0, 1e6));
  command
      ->add_option("--target-msd", settings.target_msd, "end a fit at this error of points not trained on (0: never)")
      ->check(CLI::Range(0.0, 1.0));
}

void about_fits(CLI::App* command, Settings& settings) {
  add_fit(command, settings);
  command->preparse_callback([&](std::size_t) {
    settings.frames = 0;
    settings.preset = Preset::fast;
  });
  command->get_option("--preset")->default_str("fast");
  command->get_option("--frames")
      ->description("equidistant frames read from a clip, instead of --rate (or all, of frame files)")
      ->default_str("");
  command->get_option("--rate")->description("frames a second: of a clip (60); of frame files (24)");
}

void add_registration(CLI::App* command, Settings& settings) {
  add_choice(command, "--surface", settings.representation,
             {{"sampled", Representation::sampled}, {"neural", Representation::neural}},
             "sampled: the mesh itself; neural: a network fitted to it");
  add_choice(command, "--search", settings.search,
             {{"upright", RotationSearch::upright}, {"full", RotationSearch::full}},
             "upright: the bodies stand alike (same up, same heading); full: they lie at will");
  add_fit(command, settings);
}

void add_views(CLI::App* command, Settings& settings) {
  command
      ->add_option(
          "--views", settings.views,
          "registration in space, 0: of the second to the first alone; 1: the mean of both ways; more: also through "
          "warps of both spheres")
      ->capture_default_str()
      ->check(CLI::Range(0, 100));
}

void add_step_views(CLI::App* command, Settings& settings) {
  command
      ->add_option_function<int>(
          "--views", [&settings](int views) { settings.views = views; },
          "of each step, 0: of the later frame to the former alone; 1: the mean of both ways; more: also through warps "
          "of both spheres")
      ->default_str("1")
      ->check(CLI::Range(0, 100));
}

void about_groups(CLI::App* command, Settings& settings) {
  command->add_flag("--keep-going", settings.keep_going, "leave out animations that cannot be used");
  command->add_option("--work", settings.work,
                      "folder in which bodies and registrations are kept: an interrupted run goes on from there, and "
                      "bodies are read from it one at a time");
  add_registration(command, settings);
}

std::vector<Body> load(const std::vector<std::string>& sources, const Settings& settings, Report& report,
                       std::size_t least) {
  std::vector<Body> bodies;
  std::vector<std::string> unusable;
  for (const auto& source : sources) {
    try {
      ProgressLine line;
      Body body = load_body(source, settings, report, std::ref(line));
      if (settings.representation != Representation::sampled && unusable.empty()) {
        report.section("fit." + std::to_string(bodies.size() + 1));
        fit(body, {}, settings, report);
        report.section("");
      }
      bodies.push_back(std::move(body));
    } catch (const dsns::Error& error) {
      if (sources.size() <= 2) throw;
      report.section("");
      std::cerr << "dsns: " << error.what() << '\n';
      unusable.push_back(source);
    }
  }
  if (unusable.empty()) return bodies;
  report.note("left_out", unusable);
  dsns::require<dsns::FileError>(
      settings.keep_going, unusable.size(), " of ", sources.size(),
      " animations cannot be used, see above: mend them, or leave them out with --keep-going");
  dsns::require<dsns::FileError>(bodies.size() >= least, "only ", bodies.size(), " of ", sources.size(),
                                 " animations can be used, ", least, " are needed");
  report.figure("used", "animations that can be used", bodies.size());
  return bodies;
}

CommandLine::CommandLine()
    : app("Elastic analysis of moving surfaces: registered sequences, geodesics and means of animations.") {
  settings.threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  app.set_version_flag("--version", dsns::version);
  app.require_subcommand(1);
  app.footer(
      "FILE is a GLB or glTF animation, FILE#Clip one of its clips (full name, or the part after the last '|'),\n"
      "a folder of OBJ, OFF or PLY frames, or of .npz frames, or a .npy array (these two with --faces),\n"
      "FILE.hdf5#SEQUENCE of DFAUST, or a .mat file (-v7.3) of grids Surface{t}.Mall.\n"
      "Try: dsns demo -o demo");
  add_single();
  add_evaluations();
  add_pairs();
  add_groups();
}

CLI::App* CommandLine::command_of(CLI::App* parent, const std::string& name, const std::string& what,
                                  const std::function<void()>& run) {
  CLI::App* sub = parent->add_subcommand(name, what);
  sub->callback([this, run, name] {
    check_output(settings.json, "");
    if (name != "demo" && name != "representation" && name != "temporal" && name != "modes")
      check_output(out, name == "fit" && dsns::lower_extension(out) == ".dsns" ? ".dsns" : ".glb");
    check_output(settings.checkpoint, ".dsns");
    check_output(overview, ".glb");
    check_own_mesh(own, sources.empty() ? "" : name == "transfer" ? sources.back() : sources.front());
    run();
    report.save(settings.json);
  });
  add_common(sub, settings);
  return sub;
}

void CommandLine::add_own_mesh(CLI::App* command) {
  command->add_option(
      "--own-mesh", own,
      "write the result on the first file's own mesh: a GLB with its materials, a .npy or a folder for OBJ frames");
}

}  // namespace dsns::program
