#pragma once
/// What registration in time is told, and what it says.
#include <dsns/elastic/srvf.hpp>

#include <string>
#include <vector>

namespace dsns {

/// Which stretches of two motions are brought together.
enum class TemporalAlignment {
  whole,    ///< all of both: starts meet, and ends
  partial,  ///< starts meet; of the one that goes on longer only a part is taken, as much as matches the other
  cyclic    ///< the second is run around: it starts at any phase and is played as often as matches the first
};

struct TemporalOptions {
  TemporalAlignment alignment = TemporalAlignment::whole;
  double penalty =
      0;  ///< of a warp: times the norm and the integral of (1 - sqrt(zeta'))^2, so that noise is not aligned
  double min_share = 0.3;  ///< partial: at least this share of the longer one is taken
  double passes = 0;  ///< cyclic: how often the second is played while the first is once; 0: best of 1/3, 1/2, 1, 2, 3

  int grid = 200;                           ///< nodes of the dynamic programming
  int max_slope = 7;                        ///< its slopes are the fractions of coprime numbers up to this
  std::vector<int> cosines = {16, 32, 48};  ///< unknowns of the refinement, level by level
  int steps_per_level = 15;
  double min_slope =
      0.02;  ///< warps that nearly stop either clock, with slopes below this or above its inverse, are not taken
  double ridge = 1e-8;      ///< times k^4 and the norm: what a cosine must gain to be used
  double tolerance = 1e-8;  ///< a level ends when a step lowers the energy by less than this share of it
  int search_grid = 40;     ///< nodes of the searches for a phase, and for advice; 0: no advice
};

struct TemporalSummary {
  double energy_before = 0;  ///< |q1 - q2|^2 of the whole curves, length unit
  double energy_after = 0;   ///< of the stretches that are brought together
  double norm = 0;           ///< |q1|^2
  double min_slope = 1;      ///< of the warp and of its inverse
  int steps = 0;
  std::string stop;
  /// Where whole motions leave much energy and another alignment would not: which. Empty where none is better.
  std::string advice;
};

/// first.(window)(t) is brought together with second.(window)(warp(t)), t from 0 to 1.
struct TemporalResult {
  TimeWarp warp;
  TimeWindow first, second;  ///< all of both, except in partial and cyclic alignment
  TemporalSummary summary;

  double first_time(double t) const { return first(t); }
  double second_time(double t) const { return second(warp(t)); }
};

}  // namespace dsns
