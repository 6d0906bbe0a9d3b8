#pragma once
/// The tables of `evaluate representation`, as Markdown and CSV.
#include "fits.hpp"

#include <optional>
#include <string>
#include <vector>

namespace dsns::program {

/// A fit from a few frames, judged on the others, which it never saw.
struct OtherFrames {
  FitFigures fit;
  double msd = 0;                ///< on held-out points at the other frames
  double msd_interpolation = 0;  ///< there, of the cubic through the same few frames at each vertex
  double ratio() const { return msd / msd_interpolation; }
};

struct RepresentationRow {
  std::string file;
  FitFigures fit;
  std::optional<OtherFrames> others;  ///< where there are more frames than trained
};

struct FailedRow {
  std::string file, reason;
};

struct RepresentationTable {
  std::vector<RepresentationRow> rows;
  std::vector<FailedRow> failures;
  std::string conditions;  ///< preset and budget, a sentence
  int frames_trained = 0;
};

struct Spread {
  double mean = 0, std = 0, median = 0;  ///< std with n - 1, 0 for one value
};
Spread spread(std::vector<double> values);

/// A quantity of every row.
template <class F>
std::vector<double> column(const std::vector<RepresentationRow>& rows, const F& quantity) {
  std::vector<double> out;
  for (const RepresentationRow& row : rows) out.push_back(quantity(row));
  return out;
}

std::string csv(const RepresentationTable& table);
/// With the D-SNS paper's numbers beside ours.
std::string markdown(const RepresentationTable& table);

}  // namespace dsns::program
