#pragma once
/// Names with numbers in them, in the order that people give them.
#include <algorithm>
#include <cctype>
#include <cstddef>
#include <string_view>

namespace dsns::detail {

/// Names in the order of their numbers: frame_2 before frame_10.
inline bool natural_less(std::string_view a, std::string_view b) {
  const auto is_digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
  const auto number = [&](std::string_view& s) {
    const auto end = std::find_if_not(s.begin(), s.end(), is_digit);
    auto digits = s.substr(0, static_cast<std::size_t>(end - s.begin()));
    s.remove_prefix(digits.size());
    digits.remove_prefix(std::min(digits.find_first_not_of('0'), digits.size()));
    return digits;
  };
  const std::string_view whole_a = a, whole_b = b;
  while (!a.empty() && !b.empty()) {
    if (is_digit(a.front()) && is_digit(b.front())) {
      const auto x = number(a), y = number(b);
      if (x != y) return x.size() != y.size() ? x.size() < y.size() : x < y;
    } else {
      if (a.front() != b.front()) return a.front() < b.front();
      a.remove_prefix(1);
      b.remove_prefix(1);
    }
  }
  return a.empty() != b.empty() ? a.empty() : whole_a < whole_b;
}

}  // namespace dsns::detail
