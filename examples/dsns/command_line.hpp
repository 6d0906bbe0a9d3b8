#pragma once
/// The words of the command line: what every subcommand takes, and what it runs.
#include "commands.hpp"
#include "evaluations.hpp"

#include <CLI/CLI.hpp>

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace dsns::program {

/// The parser, and everything that options write to. The four kinds of subcommands have a file each.
struct CommandLine {
  CommandLine();
  CommandLine(const CommandLine&) = delete;  // options point into it
  CommandLine& operator=(const CommandLine&) = delete;

  void add_single();
  void add_evaluations();
  void add_pairs();
  void add_groups();

  CLI::App app;
  Settings settings;
  Report report;
  std::vector<std::string> sources;
  std::string out, overview, own;
  int unusable = 0;
  RepresentationEvaluation evaluation;
  TemporalEvaluation temporal;
  bool pairs = false, stretches = false;
  SpatialEvaluation spatial;
  double common_warp = 5;
  CorrespondenceEvaluation correspondence;
  std::string truth;
  StatisticsEvaluation statistics;
  bool spatial_only = false;
  SpatialBeginning beginning = SpatialBeginning::rotation;
  TrackEvaluation tracking;
  std::string landmark_file;
  double landmark_weight = LandmarkFile{}.together;
  GeodesicOptions way;
  std::string before, fitted;
  Study study;

 private:
  /// A subcommand with the common options. Before it runs, files that it could not write are refused.
  CLI::App* command_of(CLI::App* parent, const std::string& name, const std::string& what,
                       const std::function<void()>& run);
  CLI::App* command(const std::string& name, const std::string& what, const std::function<void()>& run) {
    return command_of(&app, name, what, run);
  }
  void add_own_mesh(CLI::App* command);
};

void add_fit(CLI::App* command, Settings& settings);
/// Commands about a fit see every frame and take the fast preset unless told otherwise.
void about_fits(CLI::App* command, Settings& settings);
void add_registration(CLI::App* command, Settings& settings);
void add_views(CLI::App* command, Settings& settings);
/// The same of the steps from frame to frame: both ways unless told otherwise.
void add_step_views(CLI::App* command, Settings& settings);
void about_groups(CLI::App* command, Settings& settings);
/// Reads the sources and, if the settings ask for networks, fits them. Says which cannot be used, all of them: then it throws,
/// or leaves them out where it may and `least` remain.
std::vector<Body> load(const std::vector<std::string>& sources, const Settings& settings, Report& report,
                       std::size_t least);
/// Refuses before the work what could not be written after it.
void check_output(const std::string& path, const std::string& extension);

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

}  // namespace dsns::program
