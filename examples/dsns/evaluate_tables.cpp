#include "evaluate_tables.hpp"

#include <dsns/core/errors.hpp>

#include <iomanip>

namespace dsns::program {

namespace {

std::string rounded(double x, int digits) {
  std::ostringstream text;
  text << std::setprecision(digits) << x;
  return text.str();
}

}  // namespace

std::string csv(const std::vector<SpatialRow>& rows) {
  std::string out =
      "file,seed,warp_rms_deg_before,warp_rms_deg_after,warp_max_deg_after,rotation_deg_after,energy_ratio,min_"
      "jacobian,"
      "seconds,cpu_seconds\n";
  for (const SpatialRow& r : rows)
    out += message('"', r.file, "\",", r.seed, ',', r.before, ',', r.after, ',', r.largest, ',', r.rotation, ',',
                   r.energy_ratio, ',', r.min_jacobian, ',', r.seconds, ',', r.cpu_seconds, '\n');
  return out;
}

std::string markdown(const std::vector<SpatialRow>& rows) {
  std::string out =
      "| sequence | known warp, ° rms | left of it | at most | left of the body's turn, ° | energy ratio | smallest "
      "Jacobian | "
      "seconds | CPU-seconds |\n|---|---|---|---|---|---|---|---|---|\n";
  for (const SpatialRow& r : rows)
    out += message("| ", r.file, " | ", rounded(r.before, 3), " | ", rounded(r.after, 2), " | ", rounded(r.largest, 2),
                   " | ", rounded(r.rotation, 2), " | ", rounded(r.energy_ratio, 2), " | ", rounded(r.min_jacobian, 2),
                   " | ", rounded(r.seconds, 2), " | ", rounded(r.cpu_seconds, 2), " |\n");
  return out;
}

}  // namespace dsns::program
