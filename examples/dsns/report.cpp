#include "report.hpp"

#include <dsns/io/atomic_file.hpp>

#include <nlohmann/json.hpp>

#include <unistd.h>

#include <cstdio>
#include <iostream>
#include <sstream>

namespace dsns::program {

void Report::say(const std::string& sentence) { std::cout << sentence << '\n'; }

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

struct Report::Json {
  nlohmann::ordered_json root;

  nlohmann::ordered_json& at(const std::string& section, const std::string& key) {
    std::istringstream levels(section.empty() ? key : section + "." + key);
    nlohmann::ordered_json* place = &root;
    for (std::string level; std::getline(levels, level, '.');)
      place = place->is_array() ? &place->at(std::stoul(level)) : &(*place)[level];
    return *place;
  }
};

Report::Report() : json_(std::make_unique<Json>()) {}
Report::~Report() = default;

void Report::row(const std::string& list) {
  nlohmann::ordered_json& rows = json_->at("", list);
  rows.push_back(nlohmann::ordered_json::object());
  section_ = message(list, ".", rows.size() - 1);
}

void Report::note(const std::string& key, const Value& value) {
  nlohmann::ordered_json& place = json_->at(section_, key);
  std::visit([&](const auto& v) { place = v; }, value);
}

void Report::figure(const std::string& key, const std::string& label, const Value& value) {
  note(key, value);
  const nlohmann::ordered_json& place = json_->at(section_, key);
  std::cout << "  " << label << std::string(label.size() < 44 ? 44 - label.size() : 1, ' ') << readable(place) << '\n';
}

void Report::wrote(const std::string& key, const std::filesystem::path& path) {
  json_->at(section_, "files." + key) = path.string();
  say("Wrote " + path.string());
}

void Report::save(const std::filesystem::path& path) const {
  if (!path.empty()) write_file_atomically(path, json_->root.dump(2) + "\n");
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
