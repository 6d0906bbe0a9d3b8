#pragma once
/// The tables of `evaluate spatial`, as Markdown and CSV.
#include "representation_tables.hpp"

#include <cstdint>

namespace dsns::program {

struct SpatialRow {
  std::string file;
  std::uint64_t seed = 0;
  double before = 0, after = 0, largest = 0, rotation = 0;  ///< degrees
  double energy_ratio = 0, min_jacobian = 0, seconds = 0, cpu_seconds = 0;
};

std::string csv(const std::vector<SpatialRow>& rows);
std::string markdown(const std::vector<SpatialRow>& rows);

}  // namespace dsns::program
