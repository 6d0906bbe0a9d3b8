// register, geodesic, transfer: the options of subcommands about two animations.
#include "command_line.hpp"

namespace dsns::program {

void CommandLine::add_pairs() {
  CLI::App* register_command =
      command("register", "bring the second animation into correspondence with the first", [&] {
        const LandmarkFile landmarks = read_landmarks(landmark_file, landmark_weight);
        const std::vector<Body> bodies = load(sources, settings, report, 2);
        if (spatial_only)
          register_spatial_only(bodies[0], bodies[1], out, beginning, landmarks, settings, report);
        else
          register_two(bodies[0], bodies[1], out, own, landmarks, settings, report);
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
  CLI::Option* marks = register_command->add_option(
      "--landmarks", landmark_file,
      "points that correspond, a line each: vertex of the first file's own mesh, vertex of the second's, and a weight "
      "if you like (1; 0: only measured), separated by commas, vertices from 0");
  register_command
      ->add_option("--landmark-weight", landmark_weight,
                   "of all landmarks together: 1 counts a miss of one radian as much as the whole squared norm of the "
                   "first body's field")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1e6))
      ->needs(marks);
  add_registration(register_command, settings);

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
}

}  // namespace dsns::program
