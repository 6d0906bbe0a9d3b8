#pragma once
/// How users name an animation: `FILE#Clip`, `FILE` alone or a folder of frames.
#include <dsns/core/errors.hpp>

#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>

namespace dsns {

struct SourceName {
  std::filesystem::path file;
  std::string clip;  ///< empty where none was named
};

/// Splits at the last '#', unless a file or folder of the whole name exists.
/// throws   InvalidArgument where no file is named
inline SourceName parse_source(std::string_view text) {
  const auto mark = text.rfind('#');
  std::error_code ignored;
  SourceName source;
  if (mark == std::string_view::npos || std::filesystem::exists(text, ignored)) {
    source.file = text;
  } else {
    source.file = text.substr(0, mark);
    source.clip = text.substr(mark + 1);
  }
  require(!source.file.empty(), "'", text, "' names no file: write FILE#Clip, FILE, or a folder of OBJ frames");
  return source;
}

}  // namespace dsns
