#pragma once
/// Tensors of float32 and float64 from safetensors files: a length, a JSON header with names, types, shapes and places, and
/// the numbers.
#include <dsns/io/npy.hpp>

#include <map>
#include <utility>

namespace dsns::detail {

/// What the header says of a tensor.
struct SafetensorsEntry {
  std::string type;
  std::vector<std::uint64_t> shape, place;  // place: begin and end behind the header
};

/// Reads the JSON that safetensors writes, which is a small part of JSON: objects of texts, and lists of whole numbers.
class SafetensorsHeader {
 public:
  SafetensorsHeader(std::string_view text, const std::string& name) : left_(text), name_(&name) {}

  /// throws   FileError that begins with the name
  std::map<std::string, SafetensorsEntry> read() {
    std::map<std::string, SafetensorsEntry> entries;
    for_each_member([&](const std::string& tensor) {
      if (tensor == "__metadata__") return for_each_member([&](const std::string&) { text(); });
      check(entries.count(tensor) == 0, "'" + tensor + "' is there twice");
      entries.emplace(tensor, entry());
    });
    skip_blanks();
    check(left_.empty(), "there is more behind its end");
    return entries;
  }

 private:
  void check(bool ok, const std::string& what) const {
    require<FileError>(ok, *name_, ": the header is no safetensors header, ", what, "; save the file again");
  }
  void skip_blanks() { left_.remove_prefix(std::min(left_.find_first_not_of(" \t\r\n"), left_.size())); }
  bool next_is(char c) {
    skip_blanks();
    return !left_.empty() && left_.front() == c;
  }
  void expect(char c) {
    check(next_is(c), std::string("there is no '") + c + "' where one belongs");
    left_.remove_prefix(1);
  }
  std::string text() {
    expect('"');
    std::string out;
    for (; !left_.empty() && left_.front() != '"'; left_.remove_prefix(1)) {
      if (left_.front() == '\\') {
        left_.remove_prefix(1);
        constexpr std::string_view known = "\"\\/";
        check(!left_.empty() && known.find(left_.front()) != std::string_view::npos, "a name has an unusual character");
      }
      check(static_cast<unsigned char>(left_.front()) >= 0x20, "a name has an unusual character");
      out += left_.front();
    }
    expect('"');
    return out;
  }
  std::vector<std::uint64_t> numbers() {
    std::vector<std::uint64_t> out;
    expect('[');
    while (!next_is(']')) {
      if (!out.empty()) expect(',');
      skip_blanks();
      const std::string_view word = left_.substr(0, left_.find_first_not_of("0123456789"));
      std::uint64_t x = 0;
      check(parse_number(word, x), "a size is no whole number");
      out.push_back(x);
      left_.remove_prefix(word.size());
    }
    expect(']');
    return out;
  }
  template <class Member>
  void for_each_member(const Member& member) {
    expect('{');
    for (bool first = true; !next_is('}'); first = false) {
      if (!first) expect(',');
      const std::string key = text();
      expect(':');
      member(key);
    }
    expect('}');
  }
  SafetensorsEntry entry() {
    SafetensorsEntry out;
    int members = 0;
    for_each_member([&](const std::string& key) {
      ++members;
      if (key == "dtype") return void(out.type = text());
      check(key == "shape" || key == "data_offsets", "a tensor has '" + key + "'");
      (key == "shape" ? out.shape : out.place) = numbers();
    });
    check(members == 3 && !out.type.empty() && out.place.size() == 2 && out.place[0] <= out.place[1],
          "a tensor lacks its type, shape or place");
    return out;
  }

  std::string_view left_;
  const std::string* name_;
};

using NamedArrays = std::vector<std::pair<std::string, NpyArray>>;

/// source   the safetensors format, huggingface.co/docs/safetensors
/// throws   FileError that begins with `name`: also where numbers overlap, or lie where no tensor is
inline NamedArrays parse_safetensors(std::string_view bytes, const std::string& name) {
  const auto check = [&](bool ok, const auto&... what) { require<FileError>(ok, name, ": ", what...); };
  check(bytes.size() >= 10, "this is no safetensors file: ", bytes.size(), " bytes are too few");
  const auto length = number_at<std::uint64_t>(bytes, std::endian::little);
  check(length <= bytes.size() - 8, "claims a header of ", length, " bytes where ", bytes.size() - 8,
        " are there: this is no whole safetensors file, save it again");
  const std::string_view data = bytes.substr(8 + std::size_t(length));
  NamedArrays arrays;
  std::map<std::uint64_t, std::uint64_t> places;
  for (auto& [tensor, entry] : SafetensorsHeader(bytes.substr(8, std::size_t(length)), name).read()) {
    check(entry.type == "F32" || entry.type == "F64", "'", tensor, "' has type ", entry.type,
          ": save tensors of float32 or float64");
    const std::uint64_t begin = entry.place[0], end = entry.place[1], size = entry.type == "F32" ? 4 : 8;
    check(end <= data.size(), "'", tensor, "' ends at ", end, " of ", data.size(), " bytes: save the file again");
    std::uint64_t count = 1;
    NpyArray array;
    for (const std::uint64_t n : entry.shape) {
      check(n == 0 || count <= data.size() / n, "'", tensor, "' claims ", n, " entries along an axis, ", data.size(),
            " bytes are there: save the file again");
      count *= n;
      array.shape.push_back(std::size_t(n));
    }
    check(count * size == end - begin, "'", tensor, "' has ", end - begin, " bytes for ", count,
          " entries: save the file again");
    if (count > 0) check(places.emplace(begin, end).second, "two tensors share their numbers: save the file again");
    array.values.resize(std::size_t(count));
    for (std::size_t k = 0; k < array.values.size(); ++k) {
      const std::string_view raw = data.substr(std::size_t(begin + k * size), std::size_t(size));
      array.values[k] =
          size == 8 ? number_at<double>(raw, std::endian::little) : double(number_at<float>(raw, std::endian::little));
    }
    arrays.emplace_back(tensor, std::move(array));
  }
  std::uint64_t covered = 0;
  for (const auto& [begin, end] : places)
    check(begin == covered, "the tensors overlap or leave a gap at ", begin), covered = end;
  check(covered == data.size(), "the tensors end at ", covered, " of ", data.size(), " bytes: save the file again");
  return arrays;
}

}  // namespace dsns::detail
