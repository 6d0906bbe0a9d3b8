#include "gnuplot.hpp"

#include <dsns/core/errors.hpp>
#include <dsns/io/atomic_file.hpp>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>

extern char** environ;

namespace dsns::program {

bool run_gnuplot(const std::filesystem::path& script) {
  const std::filesystem::path folder = script.has_parent_path() ? script.parent_path() : ".";
  std::string program = "gnuplot", argument = script.filename().string(), in = folder.string();
  std::array<char*, 3> arguments{program.data(), argument.data(), nullptr};
  posix_spawn_file_actions_t actions;  // what it has to say is whether there is a picture
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, in.c_str());
  for (const int stream : {STDOUT_FILENO, STDERR_FILENO})
    posix_spawn_file_actions_addopen(&actions, stream, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const int failed = posix_spawnp(&child, program.c_str(), &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  int status = 0;
  return failed == 0 && waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

bool draw_boxes(const std::vector<Box>& boxes, const std::string& quantity, const std::filesystem::path& picture) {
  const std::filesystem::path script = std::filesystem::path(picture).replace_extension(".gnuplot");
  std::string text, tics, plots;
  for (std::size_t k = 0; k < boxes.size(); ++k) {
    text += message("$box", k + 1, " << END\n");
    for (const double x : boxes[k].values) text += message(std::max(x, 1e-9), "\n");
    text += "END\n";
    tics += message(k == 0 ? "" : ", ", "\"", boxes[k].label, "\" ", k + 1);
    plots += message(k == 0 ? "" : ", ", "$box", k + 1, " using (", k + 1, "):1 lc ", boxes[k].color);
  }
  text += message(
      "set terminal svg size ", 160 + 90 * boxes.size(), ",620 background 'white'\nset output '",
      picture.filename().string(), "'\nset logscale y\nset format y '10^{%T}'\nset grid y\nset ylabel '", quantity,
      "'\nset style data boxplot\nset style fill solid 0.3\nset boxwidth 0.5\nset xtics noenhanced rotate by -35\n"
      "unset key\nset xrange [0.3:",
      double(boxes.size()) + 0.7, "]\nset xtics (", tics, ")\nplot ", plots, "\n");
  write_file_atomically(script, text);
  return run_gnuplot(script);
}

}  // namespace dsns::program
