#pragma once
/// What the program prints: the same figures as lines for people and as JSON for programs.
#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace dsns::program {

class Report {
 public:
  /// A sentence for people only.
  void say(const std::string& sentence);
  /// From here on keys are below this one, levels separated by dots; empty: the top.
  void section(const std::string& key) { section_ = key; }
  const std::string& section() const { return section_; }
  /// A figure; `key` names its place in the JSON, levels separated by dots.
  template <class T>
  void figure(const std::string& key, const std::string& label, const T& value) {
    nlohmann::ordered_json& place = at(key);
    place = value;
    line(label, place);
  }
  /// A file that was written.
  void wrote(const std::string& key, const std::filesystem::path& path);
  /// Writes the JSON, unless `path` is empty.
  void save(const std::filesystem::path& path) const;

 private:
  nlohmann::ordered_json& at(const std::string& key);
  static void line(const std::string& label, const nlohmann::ordered_json& value);
  nlohmann::ordered_json json_;
  std::string section_;
};

/// A line on stderr that follows long work, if stderr is a terminal.
class ProgressLine {
 public:
  ProgressLine();
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;
  void operator()(std::string_view stage, double fraction);

 private:
  bool terminal_;
  std::string last_;
};

}  // namespace dsns::program
