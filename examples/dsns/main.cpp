// dsns: elastic analysis of moving surfaces from the command line.
#include "commands.hpp"
#include "evaluations.hpp"
#include "fits.hpp"

#include <dsns/core/errors.hpp>
#include <dsns/io/frames.hpp>
#include <dsns/io/source_name.hpp>
#include <dsns/version.hpp>

#include <CLI/CLI.hpp>

#include <filesystem>
#include <iostream>
#include <map>
#include <thread>

using namespace dsns::program;

namespace {

constexpr int usage_error = 2;

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

/// An option that takes one of a few words.
template <class E>
void add_choice(CLI::App* command, const std::string& name, E& value, const std::map<std::string, E>& words,
                const std::string& what) {
  std::string list;
  for (const auto& [word, meaning] : words) list += (list.empty() ? "" : " or ") + word;
  command
      ->add_option_function<std::string>(
          name, [&value, words](const std::string& word) { value = words.at(word); }, what)
      ->check(CLI::Validator(
          [words, list](std::string& word) {
            return words.count(word) ? "" : "'" + word + "' is not a choice: give " + list;
          },
          list));
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

/// Commands about a fit see every frame and take the fast preset unless told otherwise.
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
             {{"upright", dsns::RotationSearch::upright}, {"full", dsns::RotationSearch::full}},
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

void about_groups(CLI::App* command, Settings& settings) {
  command->add_flag("--keep-going", settings.keep_going, "leave out animations that cannot be used");
  command->add_option("--work", settings.work,
                      "folder in which bodies and registrations are kept: an interrupted run goes on from there, and "
                      "bodies are read from it one at a time");
  add_registration(command, settings);
}

/// Reads the sources and, if the settings ask for networks, fits them. Says which cannot be used, all of them: then it throws,
/// or leaves them out where it may and `least` remain.
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

/// What is wrong with the words of the command line, where the parser would complain of something else; or nothing.
std::string misspelt(const CLI::App& app, int argc, char** argv) {
  const auto is_option = [](const std::string& word) { return word.size() > 1 && word[0] == '-'; };
  if (argc < 2 || is_option(argv[1])) return "";
  const CLI::App* command = &app;
  int first = 1;
  for (;; ++first) {  // a command may have commands
    const auto subcommands = command->get_subcommands([](const CLI::App*) { return true; });
    if (subcommands.empty() || first >= argc || is_option(argv[first])) break;
    const CLI::App* chosen = nullptr;
    std::string names;
    for (const CLI::App* sub : subcommands) {
      if (sub->get_name() == argv[first]) chosen = sub;
      names += " " + sub->get_name();
    }
    if (chosen == nullptr) return dsns::message("there is no command '", argv[first], "': choose one of", names);
    command = chosen;
  }
  for (int i = first; i < argc; ++i) {
    const std::string word = argv[i], name = word.substr(0, word.find('='));
    if (word.rfind("--", 0) == 0 && word.size() > 2 && command->get_option_no_throw(name) == nullptr)
      return dsns::message("there is no option ", name, " of '", argv[1], "': see dsns ", argv[1], " --help");
  }
  return "";
}

/// Refuses before the work what could not be written after it.
void check_output(const std::string& path, const std::string& extension) {
  if (path.empty()) return;
  const std::filesystem::path file(path), folder = file.has_parent_path() ? file.parent_path() : ".";
  dsns::require<dsns::FileError>(std::filesystem::is_directory(folder), "cannot write ", path, ": there is no folder ",
                                 folder.string(), "; make it first");
  dsns::require<dsns::FileError>(extension.empty() || file.extension() == extension, "cannot write ", path,
                                 ": name it *", extension);
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

int main(int argc, char** argv) {
  Settings settings;
  settings.threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  Report report;
  std::vector<std::string> sources;
  std::string out, overview, own;
  int unusable = 0;
  RepresentationEvaluation evaluation;
  TemporalEvaluation temporal;
  bool pairs = false, stretches = false;

  CLI::App app{"Elastic analysis of moving surfaces: registered sequences, geodesics and means of animations."};
  app.set_version_flag("--version", dsns::version);
  app.require_subcommand(1);
  app.footer(
      "FILE is a GLB or glTF animation, FILE#Clip one of its clips (full name, or the part after the last '|'),\n"
      "a folder of OBJ, OFF or PLY frames, or of .npz frames, or a .npy array (these two with --faces),\n"
      "FILE.hdf5#SEQUENCE of DFAUST, or a .mat file (-v7.3) of grids Surface{t}.Mall.\n"
      "Try: dsns demo -o demo");
  const auto command_of = [&](CLI::App* parent, const std::string& name, const std::string& what, auto run) {
    CLI::App* sub = parent->add_subcommand(name, what);
    sub->callback([&, run, name] {
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
  };
  const auto command = [&](const std::string& name, const std::string& what, auto run) {
    return command_of(&app, name, what, run);
  };

  const auto add_own_mesh = [&](CLI::App* sub) {
    sub->add_option(
        "--own-mesh", own,
        "write the result on the first file's own mesh: a GLB with its materials, a .npy or a folder for OBJ frames");
  };

  CLI::App* inspect_command = command("inspect", "what an animation holds and whether it can be used",
                                      [&] { inspect(sources[0], settings, report); });
  inspect_command->add_option("FILE", sources, "the animation")->required()->expected(1);

  CLI::App* map_command = command("parameterize", "map an animation to the sphere, one to one",
                                  [&] { parameterize(sources[0], out, settings, report); });
  map_command->add_option("FILE", sources, "the animation")->required()->expected(1);
  map_command->add_option("-o,--output", out, "write it and its sphere, in the same colours, to this GLB");

  CLI::App* fit_command = command("fit", "fit a surface that is a function of point and time to an animation", [&] {
    settings.representation = Representation::sampled;
    say_preset(settings, report);
    std::vector<Body> bodies = load(sources, settings, report, 1);
    fit(bodies[0], out, settings, report);
  });
  fit_command->add_option("FILE", sources, "the animation")->required()->expected(1);
  fit_command->add_option("-o,--output", out, "write the fitted animation to this GLB, or the surface to this .dsns");
  CLI::Option* checkpoint = fit_command->add_option(
      "--checkpoint", settings.checkpoint, "keep what the fit needs to go on in this .dsns file, every second");
  fit_command->add_flag("--resume", settings.resume, "go on from the checkpoint, where there is one")
      ->needs(checkpoint);
  about_fits(fit_command, settings);

  CLI::App* evaluate_command = app.add_subcommand("evaluate", "how good a representation is, on many animations");
  evaluate_command->require_subcommand(1);
  CLI::App* representation_command = command_of(
      evaluate_command, "representation", "fit each animation, compare it with its mesh on points never seen", [&] {
        check_output(evaluation.csv.string(), "");
        check_output(evaluation.markdown.string(), "");
        evaluation.out = out;
        unusable = evaluate_representation(sources, settings, evaluation, report);
      });
  representation_command
      ->add_option("FILES", sources, "animations, or folders, which stand for every clip of every file in them")
      ->required()
      ->expected(1, 10000);
  representation_command
      ->add_option("--frames-trained", evaluation.frames_trained,
                   "of a second fit from so many frames, tested on the others (0: none)")
      ->capture_default_str()
      ->check(CLI::Range(0, 1000));
  representation_command->add_option("-o,--output", out,
                                     "folder for each animation coloured by its error, and pictures");
  representation_command->add_option("--csv", evaluation.csv, "write the table to this file");
  representation_command->add_option("--markdown", evaluation.markdown, "likewise, with the D-SNS paper's beside it");
  about_fits(representation_command, settings);

  CLI::App* temporal_command = command_of(evaluate_command, "temporal",
                                          "recover known warps of time, or bring pairs of animations to one pace", [&] {
                                            check_output(temporal.csv.string(), "");
                                            check_output(temporal.markdown.string(), "");
                                            temporal.out = out;
                                            if (pairs || (sources.size() == 2 && !stretches))
                                              temporal.experiment = TemporalExperiment::pairs;
                                            if (stretches) temporal.experiment = TemporalExperiment::stretches;
                                            unusable = evaluate_temporal(sources, settings, temporal, report);
                                          });
  temporal_command
      ->add_option("FILES", sources,
                   "animations, or folders, which stand for every clip of every file in them; two of them are a pair")
      ->required()
      ->expected(1, 10000);
  temporal_command->add_option("--warps", temporal.warps, "random warps of each")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  temporal_command->add_option("--networks", temporal.networks, "for how many of them the paper's network is trained")
      ->capture_default_str()
      ->check(CLI::Range(0, 1000));
  temporal_command->add_flag("--strong", temporal.strong, "warps with slopes from 0.03 to 4 instead of 0.2 to 2.3");
  CLI::Option* pairs_flag =
      temporal_command->add_flag("--pairs", pairs, "each animation against each other, not against itself");
  temporal_command
      ->add_flag("--stretches", stretches, "each against itself played twice, begun a third late, cut off at 70 %")
      ->excludes(pairs_flag);
  temporal_command->add_option("-o,--out", out, "folder for a plot of the errors");
  temporal_command->add_option("--csv", temporal.csv, "write all errors to this file");
  temporal_command->add_option("--markdown", temporal.markdown, "write the table to this file");
  add_choice(temporal_command, "--surface", settings.representation,
             {{"sampled", Representation::sampled}, {"fitted", Representation::neural}},
             "fitted: closed forms, five seconds unless told otherwise; sampled: the mesh with splines in time");
  about_fits(temporal_command, settings);
  temporal_command->preparse_callback([&](std::size_t) {
    settings.frames = 0;
    settings.preset = Preset::fast;
    settings.seconds = 5;
    settings.representation = Representation::neural;
  });

  SpatialEvaluation spatial;
  CLI::App* spatial_command =
      command_of(evaluate_command, "spatial", "find known warps and turns of each animation again", [&] {
        check_output(spatial.csv.string(), "");
        check_output(spatial.markdown.string(), "");
        check_output(spatial.plot.string(), ".svg");
        unusable = evaluate_spatial(sources, settings, spatial, report);
      });
  spatial_command->add_option("FILES", sources, "animations")->required()->expected(1, 10000);
  spatial_command->add_option("--degrees", spatial.degrees, "sizes of the warps, degrees in the root mean square")
      ->delimiter(',')
      ->check(CLI::Range(0.0, 28.0));
  spatial_command->add_option("--warps", spatial.warps, "warps of each size")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  spatial_command->add_option("--warp-degree", spatial.warp_degree, "of the fields that warp")
      ->capture_default_str()
      ->check(CLI::Range(1, 12));
  add_choice(spatial_command, "--second-map", spatial.map, {{"own", SecondMap::own}, {"again", SecondMap::again}},
             "own: both share their sphere map; again: the second is mapped anew, its vertices in another order");
  spatial_command->add_option("--without", spatial.without, "parts of the registration to leave out, for comparison")
      ->delimiter(',')
      ->check(CLI::IsMember({"jacobian", "smoothing", "positions", "refinement"}));
  spatial_command->add_option("--csv", spatial.csv, "write the table to this file");
  spatial_command->add_option("--markdown", spatial.markdown, "likewise");
  spatial_command->add_option("--plot", spatial.plot, "draw boxes of what is left to this SVG, by gnuplot");
  add_choice(spatial_command, "--surface", settings.representation,
             {{"sampled", Representation::sampled}, {"neural", Representation::neural}},
             "sampled: the mesh itself; neural: fits to it, of either side with a seed of its own");
  add_fit(spatial_command, settings);

  double common_warp = 5;
  CLI::App* consistency_command = command_of(
      evaluate_command, "consistency", "laws that the registration of two animations in space should obey", [&] {
        const std::vector<Body> bodies = load(sources, settings, report, 2);
        evaluate_consistency(bodies[0], bodies[1], common_warp, settings, report);
      });
  consistency_command->add_option("FILES", sources, "two animations")->required()->expected(2);
  consistency_command->add_option("--degrees", common_warp, "size of the warp of both spheres, degrees rms")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 20.0));
  add_registration(consistency_command, settings);
  add_views(consistency_command, settings);

  CorrespondenceEvaluation correspondence;
  CLI::App* correspondence_command =
      command_of(evaluate_command, "correspondence",
                 "match two bodies whose vertices correspond by number, which is not shown", [&] {
                   check_output(correspondence.markdown.string(), "");
                   evaluate_correspondence(sources[0], sources[1], settings, correspondence, report);
                 });
  correspondence_command->add_option("FILES", sources, "two animations")->required()->expected(2);
  std::string truth;
  correspondence_command->add_option("--truth", truth, "what is true: identity, of the vertices' numbers")
      ->required()
      ->check(CLI::IsMember({"identity"}));
  correspondence_command
      ->add_option("--seeds", correspondence.seeds, "runs, each remeshed, turned and warped its own way")
      ->capture_default_str()
      ->check(CLI::Range(1, 100));
  correspondence_command->add_option("--degrees", correspondence.degrees, "size of the warp, degrees rms")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 20.0));
  correspondence_command->add_flag("--baselines", correspondence.baselines, "other methods too");
  correspondence_command->add_flag("--refine", correspondence.refine,
                                   "also the elastic refinement of the correspondence");
  add_choice(correspondence_command, "--search", settings.search,
             {{"upright", dsns::RotationSearch::upright}, {"full", dsns::RotationSearch::full}},
             "of the others: upright: the bodies stand alike (same up, same heading); full: they lie at will");
  add_views(correspondence_command, settings);
  correspondence_command->add_option("--markdown", correspondence.markdown, "write the table to this file");

  StatisticsEvaluation statistics;
  CLI::App* statistics_command = command_of(evaluate_command, "statistics",
                                            "means of copies of one motion that are warped, turned and noisy", [&] {
                                              check_output(statistics.markdown.string(), "");
                                              evaluate_statistics(statistics, settings, report);
                                            });
  statistics_command->add_option("--copies", statistics.copies, "numbers of copies, each of which is one mean")
      ->delimiter(',')
      ->check(CLI::Range(1, 1000));
  statistics_command->add_option("--degrees", statistics.degrees, "size of the warps of the spheres, degrees rms")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 20.0));
  statistics_command->add_option("--noise", statistics.noise, "of every coordinate, as a share of the body's size")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1.0));
  statistics_command->add_option("--level", statistics.level, "of the icosphere on which the copies are sampled")
      ->capture_default_str()
      ->check(CLI::Range(1, 7));
  statistics_command
      ->add_option("--reordered", statistics.reordered, "take the mean again in another order of so many, at most")
      ->capture_default_str()
      ->check(CLI::Range(0, 1000));
  statistics_command->add_option("--markdown", statistics.markdown, "write the table to this file");

  bool spatial_only = false;
  SpatialBeginning beginning = SpatialBeginning::rotation;
  CLI::App* register_command =
      command("register", "bring the second animation into correspondence with the first", [&] {
        const std::vector<Body> bodies = load(sources, settings, report, 2);
        if (spatial_only)
          register_spatial_only(bodies[0], bodies[1], out, beginning, settings, report);
        else
          register_two(bodies[0], bodies[1], out, own, settings, report);
      });
  register_command->add_option("FILES", sources, "two animations")->required()->expected(2);
  register_command->add_option("-o,--output", out, "write both and the registered second to this GLB");
  add_choice(
      register_command, "--align", settings.alignment,
      {{"whole", dsns::TemporalAlignment::whole},
       {"partial", dsns::TemporalAlignment::partial},
       {"cyclic", dsns::TemporalAlignment::cyclic}},
      "whole: from start to end; partial: of the longer one, what matches the other; cyclic: the second runs around");
  add_own_mesh(register_command);
  CLI::Option* only =
      register_command->add_flag("--spatial-only", spatial_only, "in space alone: equal times correspond");
  only->excludes("--own-mesh");
  add_choice(register_command, "--start", beginning,
             {{"rotation", SpatialBeginning::rotation}, {"correspondence", SpatialBeginning::correspondence}},
             "of --spatial-only: rotation: the best of many; correspondence: by intrinsic spectra, for other shapes "
             "and poses");
  register_command->get_option("--start")->needs(only);
  add_views(register_command, settings);
  register_command->get_option("--views")->needs(only)->excludes("--start");
  add_registration(register_command, settings);

  GeodesicOptions way;
  CLI::App* geodesic_command = command("geodesic", "the way from one animation to another, and their distance", [&] {
    const std::vector<Body> bodies = load(sources, settings, report, 2);
    way.out = out;
    geodesic(bodies[0], bodies[1], way, settings, report);
  });
  geodesic_command->add_option("FILES", sources, "two animations")->required()->expected(2);
  geodesic_command->add_option("-o,--output", out, "write the way to this GLB, side by side");
  add_choice(geodesic_command, "--ends", way.ends,
             {{"registered", GeodesicEnds::registered}, {"as-they-are", GeodesicEnds::as_they_are}},
             "as-they-are: without registration, to see what it is for");
  geodesic_command->add_option("--points", way.steps, "animations along the way, ends included")
      ->capture_default_str()
      ->check(CLI::Range(2, 50));
  geodesic_command->add_option("--each", way.each, "write each of them to a GLB of its own in this folder");
  add_choice(geodesic_command, "--path", way.path,
             {{"components", GeodesicPath::components}, {"srnf", GeodesicPath::srnf}},
             "components: through curves in the space of principal components; srnf: through square-root normal "
             "fields, sent back to surfaces time by time");
  geodesic_command->add_option("--degree", way.degree, "of the harmonics of --path srnf; above it ends are mixed")
      ->capture_default_str()
      ->check(CLI::Range(2, 20));
  add_registration(geodesic_command, settings);

  CLI::App* transfer_command = command("transfer", "the motion of the first animation on the body of the second", [&] {
    const std::vector<Body> bodies = load(sources, settings, report, 2);
    transfer(bodies[0], bodies[1], out, own, settings, report);
  });
  transfer_command->add_option("FILES", sources, "two animations that begin alike")->required()->expected(2);
  transfer_command->add_option("-o,--output", out, "write both and the second in the first's motion to this GLB");
  transfer_command->add_option("--own-mesh", own, "write the result on the second file's own mesh, as register does");
  add_registration(transfer_command, settings);

  std::string before, fitted;
  CLI::App* mean_command = command("mean", "the mean of animations", [&] {
    check_output(before, ".glb");
    check_output(fitted, ".dsns");
    mean(Group(sources, settings, report, 2), {out, overview, before, own, fitted}, settings, report);
  });
  mean_command->add_option("FILES", sources, "two animations or more")->required()->expected(2, 1000);
  mean_command->add_option("-o,--output", out, "write the mean to this GLB");
  mean_command->add_option("--overview", overview, "write all, registered, with the mean last, to this GLB");
  mean_command->add_option("--before", before,
                           "write all as they are, with the mean that they have without registration, to this GLB");
  mean_command->add_option("--fitted", fitted, "fit a surface to the mean, write it to this .dsns file");
  add_own_mesh(mean_command);
  about_groups(mean_command, settings);

  Study study;
  const auto add_study = [&](CLI::App* sub) {
    sub->add_option("FILES", sources, "three animations or more")->required()->expected(3, 1000);
    add_choice(sub, "--part", study.part,
               {{"all", dsns::MotionPart::all},
                {"start", dsns::MotionPart::start},
                {"shape", dsns::MotionPart::shape},
                {"pace", dsns::MotionPart::pace}},
               "what is compared: start: the first pose; shape: how it changes; pace: when; all: these together");
    about_groups(sub, settings);
  };
  const auto add_modes = [&](CLI::App* sub, const std::string& what) {
    sub->add_option("--modes", study.modes, what)->capture_default_str()->check(CLI::Range(1, 1000));
  };
  const auto add_csv = [&](CLI::App* sub) { sub->add_option("--csv", study.csv, "write the table to this file"); };

  CLI::App* modes_command = command("modes", "how animations vary around their mean", [&] {
    check_output(study.csv.string(), "");
    study.out = out;
    modes(Group(sources, settings, report, 3), study, settings, report);
  });
  modes_command->add_option("-o,--output", out, "folder for an animation of each mode");
  add_modes(modes_command, "modes that are written");
  add_csv(modes_command);
  add_study(modes_command);

  CLI::App* sample_command = command("sample", "random new members of a group of animations", [&] {
    sample_bodies(Group(sources, settings, report, 3), study, out, settings, report);
  });
  sample_command->add_option("-o,--output", out, "write them to this GLB, side by side");
  sample_command->add_option("--count", study.samples, "how many")->capture_default_str()->check(CLI::Range(1, 1000));
  add_modes(sample_command, "modes that they vary along");
  add_study(sample_command);

  CLI::App* distances_command = command("distances", "who is near whom, and what labels or a number explain", [&] {
    check_output(study.csv.string(), "");
    distances(Group(sources, settings, report, 3), study, settings, report);
  });
  distances_command->add_option("--labels", study.labels, "one word for each animation named, with commas between")
      ->delimiter(',');
  distances_command
      ->add_option("--covariate", study.covariate, "one number for each animation named, with commas between")
      ->delimiter(',');
  add_csv(distances_command);
  add_study(distances_command);

  CLI::App* demo_command = command("demo", "the whole chain; without files, on three bodies that it makes",
                                   [&] { demo(sources, out.empty() ? "demo" : out, settings, report); });
  demo_command->add_option("FILES", sources, "animations, or nothing")->expected(0, 1000);
  demo_command->add_option("-o,--output", out, "folder to write to (default: demo)");
  add_registration(demo_command, settings);
  demo_command->preparse_callback([&](std::size_t) { settings.representation = Representation::neural; });
  demo_command->get_option("--surface")
      ->description("neural (default here): a network fitted to each; sampled: the mesh itself");

  if (const std::string wrong = misspelt(app, argc, argv); !wrong.empty()) {
    std::cerr << "dsns: " << wrong << '\n';
    return usage_error;
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : usage_error;
  } catch (const std::exception& error) {
    std::cout << std::flush;
    std::cerr << "dsns: " << error.what() << '\n';
    return 1;
  }
  return unusable > 0 ? 1 : 0;
}
