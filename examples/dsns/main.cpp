// dsns: elastic analysis of moving surfaces from the command line.
#include "command_line.hpp"

#include <dsns/core/errors.hpp>

#include <iostream>

namespace {

constexpr int usage_error = 2;

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

}  // namespace

int main(int argc, char** argv) {
  dsns::program::CommandLine line;
  if (const std::string wrong = misspelt(line.app, argc, argv); !wrong.empty()) {
    std::cerr << "dsns: " << wrong << '\n';
    return usage_error;
  }
  try {
    line.app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return line.app.exit(error) == 0 ? 0 : usage_error;
  } catch (const std::exception& error) {
    std::cout << std::flush;
    std::cerr << "dsns: " << error.what() << '\n';
    return 1;
  }
  return line.unusable > 0 ? 1 : 0;
}
