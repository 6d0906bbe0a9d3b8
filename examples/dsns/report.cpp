#include "report.hpp"

#include <dsns/io/atomic_file.hpp>

#include <unistd.h>

#include <cstdio>
#include <iostream>
#include <sstream>

namespace dsns::program {

void Report::say(const std::string& sentence) { std::cout << sentence << '\n'; }

nlohmann::ordered_json& Report::at(const std::string& key) {
  std::istringstream levels(section_.empty() ? key : section_ + "." + key);
  nlohmann::ordered_json* place = &json_;
  for (std::string level; std::getline(levels, level, '.');) place = &(*place)[level];
  return *place;
}

namespace {

/// Six digits for people; the JSON keeps all.
std::string readable(const nlohmann::ordered_json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  if (value.is_number_float()) return message(value.get<double>());
  if (!value.is_array()) return value.dump();
  std::string list;
  for (const auto& item : value) list += (list.empty() ? "" : ", ") + readable(item);
  return list;
}

}  // namespace

void Report::line(const std::string& label, const nlohmann::ordered_json& value) {
  std::cout << "  " << label << std::string(label.size() < 44 ? 44 - label.size() : 1, ' ') << readable(value) << '\n';
}

void Report::wrote(const std::string& key, const std::filesystem::path& path) {
  at("files." + key) = path.string();
  say("Wrote " + path.string());
}

void Report::save(const std::filesystem::path& path) const {
  if (!path.empty()) write_file_atomically(path, json_.dump(2) + "\n");
}

ProgressLine::ProgressLine() : terminal_(isatty(STDERR_FILENO) == 1) {}

ProgressLine::~ProgressLine() {
  if (terminal_ && !last_.empty()) std::cerr << "\r\033[K" << std::flush;
}

void ProgressLine::operator()(std::string_view stage, double fraction) {
  if (!terminal_) return;
  std::string text = message(stage, " ", static_cast<int>(100 * fraction), " %");
  if (text == last_) return;
  last_ = std::move(text);
  std::cerr << "\r\033[K" << last_ << std::flush;
}

}  // namespace dsns::program
