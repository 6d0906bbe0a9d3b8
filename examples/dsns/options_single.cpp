// inspect, parameterize, track, fit: the options of subcommands about one animation.
#include "command_line.hpp"
#include "fits.hpp"

namespace dsns::program {

void CommandLine::add_single() {
  CLI::App* inspect_command = command("inspect", "what an animation holds and whether it can be used",
                                      [&] { inspect(sources[0], settings, report); });
  inspect_command->add_option("FILE", sources, "the animation")->required()->expected(1);

  CLI::App* map_command = command("parameterize", "map an animation to the sphere, one to one",
                                  [&] { parameterize(sources[0], out, settings, report); });
  map_command->add_option("FILE", sources, "the animation")->required()->expected(1);
  map_command->add_option("-o,--output", out, "write it and its sphere, in the same colours, to this GLB");

  CLI::App* track_command =
      command("track", "make one moving mesh of frames that each have their own triangles, such as scans",
              [&] { track(sources[0], out, settings, report); });
  track_command->add_option("FOLDER", sources, "OBJ, OFF or PLY files, one a frame, in the order of their names")
      ->required()
      ->expected(1);
  track_command->add_option("-o,--output", out, "write the motion on the first frame's triangles to this GLB");
  add_step_views(track_command, settings);
  track_command->preparse_callback([&](std::size_t) {
    settings.frames = 0;
    settings.views = 1;
  });
  track_command->get_option("--frames")->description("equidistant ones of the frames (all)")->default_str("");
  track_command->get_option("--rate")->description("frames a second (24)");

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
}

}  // namespace dsns::program
