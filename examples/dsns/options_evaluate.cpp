// evaluate: the options of its subcommands.
#include "command_line.hpp"

namespace dsns::program {

void CommandLine::add_evaluations() {
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

  CLI::App* tracking_command = command_of(
      evaluate_command, "track", "give each frame triangles of its own, track them, and compare with the truth",
      [&] { evaluate_track(sources[0], out, tracking, settings, report); });
  tracking_command->add_option("FILE", sources, "the animation")->required()->expected(1);
  tracking_command->add_option("-o,--output", out, "write the truth and what was tracked to this GLB, side by side");
  tracking_command
      ->add_option("--density", tracking.density, "vertices of each frame, times those of the animation, about")
      ->capture_default_str()
      ->check(CLI::Range(0.1, 100.0));
  add_step_views(tracking_command, settings);
  tracking_command->preparse_callback([&](std::size_t) { settings.views = 1; });

  CLI::App* correspondence_command =
      command_of(evaluate_command, "correspondence",
                 "match two bodies whose vertices correspond by number, which is not shown", [&] {
                   check_output(correspondence.markdown.string(), "");
                   evaluate_correspondence(sources[0], sources[1], settings, correspondence, report);
                 });
  correspondence_command->add_option("FILES", sources, "two animations")->required()->expected(2);
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
}

}  // namespace dsns::program
