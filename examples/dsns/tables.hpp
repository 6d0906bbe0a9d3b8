#pragma once
/// Cells of tables, as Markdown and CSV.
#include <string>
#include <vector>

namespace dsns::program {

std::string scientific(double x);  ///< 1.23e-04
std::string fixed(double x, int digits);
/// A line of a Markdown table, and its first two lines; bars in cells are escaped.
std::string table_line(const std::vector<std::string>& cells);
std::string table_head(const std::vector<std::string>& cells);
/// A field of a CSV file, in quotation marks where it needs them.
std::string csv_field(const std::string& text);

}  // namespace dsns::program
