#pragma once
/// The experiments of `evaluate temporal` beside that of known warps.
#include "commands.hpp"
#include "temporal_tables.hpp"

namespace dsns::program {

/// Every sequence against every other. What cannot be used is said on stderr, and counted in `failures`.
struct PairComparison {
  std::vector<PairRow> rows;
  int failures = 0;
};
PairComparison compare_pairs(const std::vector<std::string>& names, const Settings& settings,
                             const TemporalEvaluation& evaluation, Report& report);

/// A sequence against itself played twice, begun a third late, and cut off at 70 %, each also at another pace.
std::vector<StretchRow> compare_stretches(const std::string& name, const Settings& settings,
                                          const TemporalEvaluation& evaluation, Report& report);

}  // namespace dsns::program
