// mean, modes, sample, distances, demo: the options of subcommands about many animations.
#include "command_line.hpp"

namespace dsns::program {

void CommandLine::add_groups() {
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

  using Parts = std::map<std::string, std::optional<MotionPart>>;
  const Parts parts{
      {"all", MotionPart::all}, {"start", MotionPart::start}, {"shape", MotionPart::shape}, {"pace", MotionPart::pace}};
  const std::string of_parts =
      "what is compared: start: the first pose; shape: how it changes; pace: when; all: these together";
  const auto add_study = [&](CLI::App* sub, const Parts& choices, const std::string& what) {
    sub->add_option("FILES", sources, "three animations or more")->required()->expected(3, 1000);
    add_choice(sub, "--part", study.part, choices, what);
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
  add_study(modes_command, parts, of_parts);

  CLI::App* sample_command = command("sample", "random new members of a group of animations, all of them valid", [&] {
    sample_bodies(Group(sources, settings, report, 3), study, out, settings, report);
  });
  sample_command->add_option("-o,--output", out, "write them to this GLB, side by side");
  sample_command->add_option("--count", study.samples, "how many")->capture_default_str()->check(CLI::Range(1, 1000));
  add_modes(sample_command, "modes that they vary along");
  sample_command->add_option("--spread", study.spread, "standard deviations of the samples, of the animations'")
      ->capture_default_str()
      ->check(CLI::Range(1e-3, 1e3));
  sample_command
      ->add_option("--folded", study.folded,
                   "share of the area that may fold; else as much as in the median animation, and 0.002 more")
      ->check(CLI::Range(0.0, 1.0));
  add_study(sample_command, parts, of_parts);

  CLI::App* distances_command = command("distances", "who is near whom, and what labels or a number explain", [&] {
    check_output(study.csv.string(), "");
    distances(Group(sources, settings, report, 3), study, settings, report);
  });
  distances_command->add_option("--labels", study.labels, "one word for each animation named, with commas between")
      ->delimiter(',');
  distances_command
      ->add_option("--covariate", study.covariate, "one number for each animation named, with commas between")
      ->delimiter(',');
  distances_command
      ->add_option("--eigenvalues", study.eigenvalues,
                   "of --part body, so many of each; at most a tenth of the vertices")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  add_csv(distances_command);
  Parts and_bodies = parts;
  and_bodies["body"] = std::nullopt;
  add_study(distances_command, and_bodies, of_parts + "; body: the bodies, whatever they do (Shape-DNA)");

  CLI::App* demo_command = command("demo", "the whole chain; without files, on three bodies that it makes",
                                   [&] { demo(sources, out.empty() ? "demo" : out, settings, report); });
  demo_command->add_option("FILES", sources, "animations, or nothing")->expected(0, 1000);
  demo_command->add_option("-o,--output", out, "folder to write to (default: demo)");
  add_registration(demo_command, settings);
  demo_command->preparse_callback([&](std::size_t) { settings.representation = Representation::neural; });
  demo_command->get_option("--surface")
      ->description("neural (default here): a network fitted to each; sampled: the mesh itself");
}

}  // namespace dsns::program
