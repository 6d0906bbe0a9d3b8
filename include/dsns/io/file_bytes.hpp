#pragma once
/// Whole files in memory, and numbers out of them without ever reading past the end.
#include <dsns/core/errors.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <system_error>

namespace dsns::detail {

/// throws   FileError where there is no such file, or nothing in it
inline std::string read_whole_file(const std::filesystem::path& path) {
  std::error_code ignored;
  require<FileError>(std::filesystem::exists(path, ignored), path.string(), " does not exist: check the name");
  require<FileError>(!std::filesystem::is_directory(path, ignored), path.string(),
                     " is a folder: give the name of a file");
  std::ifstream stream(path, std::ios::binary);
  std::string bytes;
  if (const auto size = std::filesystem::file_size(path, ignored); !ignored)
    bytes.reserve(static_cast<std::size_t>(size));
  std::array<char, 1 << 16> block;  // many times faster than an iterator, and pipes have no size to ask for
  while (stream.read(block.data(), block.size()) || stream.gcount() > 0)
    bytes.append(block.data(), static_cast<std::size_t>(stream.gcount()));
  require<FileError>(stream.eof(), path.string(), " cannot be read: check its permissions");
  require<FileError>(!bytes.empty(), path.string(), " is empty: export the animation again");
  return bytes;
}

/// A number of type T from the start of `bytes`, whatever this machine's byte order is.
template <class T>
T number_at(std::string_view bytes, std::endian order) {
  char raw[sizeof(T)];
  std::memcpy(raw, bytes.data(), sizeof raw);
  if (order != std::endian::native) std::reverse(std::begin(raw), std::end(raw));
  T value;
  std::memcpy(&value, raw, sizeof value);
  return value;
}

/// The next word of a text and what lies before it is taken off.
inline std::string_view next_word(std::string_view& line) {
  constexpr std::string_view blanks = " \t\r\n";
  line.remove_prefix(std::min(line.find_first_not_of(blanks), line.size()));
  const auto word = line.substr(0, line.find_first_of(blanks));
  line.remove_prefix(word.size());
  return word;
}

/// The next line of a text, without its end, is taken off.
inline std::string_view next_line(std::string_view& text) {
  const auto end = text.find('\n');
  std::string_view line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

template <class T>
bool parse_number(std::string_view word, T& value) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  const auto [end, failure] = std::from_chars(word.data(), word.data() + word.size(), value);
  return failure == std::errc{} && end == word.data() + word.size();
}

}  // namespace dsns::detail
