#pragma once
/// Pictures of tables, drawn by gnuplot where it is there.
#include <filesystem>
#include <string>
#include <vector>

namespace dsns::program {

/// Runs a script in its own folder, silently.
/// returns  whether gnuplot is there and did what it should
bool run_gnuplot(const std::filesystem::path& script);

struct Box {
  std::string label;
  std::vector<double> values;
  int color = 2;  ///< of gnuplot's line types
};

/// Boxes of values side by side, on a scale by powers of ten, as an SVG; the script stays beside it.
/// returns  whether there is a picture
bool draw_boxes(const std::vector<Box>& boxes, const std::string& quantity, const std::filesystem::path& picture);

}  // namespace dsns::program
