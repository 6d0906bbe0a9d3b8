#pragma once
/// What the program prints: the same figures as lines for people and as JSON for programs.
#include <concepts>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

namespace dsns::program {

class Report {
 public:
  Report();
  ~Report();
  Report(const Report&) = delete;
  Report& operator=(const Report&) = delete;

  /// A sentence for people only.
  void say(const std::string& sentence);
  /// From here on keys are below this one, levels separated by dots; empty: the top.
  void section(const std::string& key) { section_ = key; }
  const std::string& section() const { return section_; }
  /// Puts a new object at the end of a list; from here on keys are in it.
  void row(const std::string& list);
  using Value = std::variant<bool, std::int64_t, double, std::string, std::vector<double>, std::vector<std::string>>;
  /// A figure; `key` names its place in the JSON, levels separated by dots.
  void figure(const std::string& key, const std::string& label, const Value& value);
  /// The same for the JSON only.
  void note(const std::string& key, const Value& value);
  template <std::integral T>
  void figure(const std::string& key, const std::string& label, T value) {
    if constexpr (std::is_same_v<T, bool>)
      figure(key, label, Value(value));
    else
      figure(key, label, Value(static_cast<std::int64_t>(value)));
  }
  /// A file that was written.
  void wrote(const std::string& key, const std::filesystem::path& path);
  /// Writes the JSON, unless `path` is empty.
  void save(const std::filesystem::path& path) const;

 private:
  struct Json;  // the JSON library is slow to compile: only report.cpp sees it
  std::unique_ptr<Json> json_;
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
