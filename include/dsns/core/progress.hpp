#pragma once
#include <functional>
#include <string_view>

namespace dsns {

/// Called now and then by long routines with the stage's name and the finished fraction in [0, 1]. May be empty.
using Progress = std::function<void(std::string_view stage, double fraction)>;

inline void report(const Progress& progress, std::string_view stage, double fraction) {
  if (progress) progress(stage, fraction);
}

}  // namespace dsns
