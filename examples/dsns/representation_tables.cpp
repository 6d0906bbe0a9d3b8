#include "representation_tables.hpp"

#include "tables.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace dsns::program {

namespace {

/// The D-SNS paper's tables 1 and 2: the mean error trained on all frames of a sequence, which table 2 rounds, and on 30.
struct Published {
  const char* data;
  double all, table_2_all, table_2_few;
};
constexpr Published published[] = {{"DFAUST", 1.60e-6, 0.17e-5, 1.00e-5},
                                   {"CAPE", 1.51e-6, 0.14e-5, 1.34e-5},
                                   {"COMA", 2.29e-6, 0.23e-5, 0.14e-5},
                                   {"VOCA", 0.89e-6, 0.10e-5, 0.11e-5}};

std::string by_sequence(const RepresentationTable& table) {
  std::string out = table_head({"sequence", "frames", "MSD", "RMS distance", "largest", "to flat normals: mean",
                                "median", "to interpolated: mean", "median", "flat to interpolated: mean", "median",
                                "modes", "steps", "seconds", "CPU-seconds"});
  for (const auto& [file, f, others] : table.rows) {
    const SampledSurfaceError& e = f.error;
    out += table_line({file, std::to_string(f.frames), scientific(e.msd), scientific(e.rms_distance),
                       scientific(e.max_distance), fixed(e.normal_angle_mean_deg, 2),
                       fixed(e.normal_angle_median_deg, 2), fixed(e.smooth_normal_angle_mean_deg, 2),
                       fixed(e.smooth_normal_angle_median_deg, 2), fixed(e.mesh_normal_angle_mean_deg, 2),
                       fixed(e.mesh_normal_angle_median_deg, 2), f.separable ? std::to_string(f.separable->modes) : "-",
                       std::to_string(f.steps), fixed(f.wall_seconds, 1), fixed(f.cpu_seconds, 1)});
  }
  return out;
}

std::string table_1(const RepresentationTable& table) {
  const Spread s = spread(column(table.rows, [](const auto& row) { return row.fit.error.msd; }));
  std::string out = table_head({"MSD, trained on all frames", "mean", "standard deviation", "median"});
  out += table_line({"these " + std::to_string(table.rows.size()) + ", on points never seen", scientific(s.mean),
                     scientific(s.std), scientific(s.median)});
  for (const Published& p : published)
    out += table_line({std::string("paper, ") + p.data + ", on its training points", scientific(p.all), "-", "-"});
  return out;
}

std::string table_2(const RepresentationTable& table) {
  const std::string few = std::to_string(table.frames_trained) + " frames";
  std::string out = table_head({"sequence", "MSD, all frames", few + ", on the others", "cubic interpolation of " + few,
                                "ratio", "CPU-seconds"});
  for (const auto& [file, f, others] : table.rows)
    if (others)
      out += table_line({file, scientific(f.error.msd), scientific(others->msd), scientific(others->msd_interpolation),
                         fixed(others->ratio(), 2), fixed(others->fit.cpu_seconds, 1)});
  for (const Published& p : published)
    out += table_line({std::string("paper, ") + p.data + " (30 frames)", scientific(p.table_2_all),
                       scientific(p.table_2_few), "-", "-", "-"});
  return out;
}

}  // namespace

Spread spread(std::vector<double> values) {
  Spread s;
  if (values.empty()) return s;
  const double n = double(values.size());
  for (const double x : values) s.mean += x / n;
  for (const double x : values) s.std += (x - s.mean) * (x - s.mean);
  s.std = n > 1 ? std::sqrt(s.std / (n - 1)) : 0;
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  s.median = values.size() % 2 == 1 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
  return s;
}

std::string csv(const RepresentationTable& table) {
  std::string out =
      "file,frames,msd_heldout,rms_distance_heldout,max_distance_heldout,normal_angle_mean_deg,normal_angle_median_deg,"
      "smooth_normal_angle_mean_deg,smooth_normal_angle_median_deg,mesh_normal_angle_mean_deg,"
      "mesh_normal_angle_median_deg,steps,wall_seconds,cpu_seconds,frames_trained,msd_other_frames,msd_interpolation,"
      "ratio_to_interpolation\n";
  const auto number = [](double x) { return "," + message(x); };
  for (const auto& [file, f, others] : table.rows) {
    const SampledSurfaceError& e = f.error;
    out += csv_field(file) + "," + std::to_string(f.frames);
    for (const double x : {e.msd, e.rms_distance, e.max_distance, e.normal_angle_mean_deg, e.normal_angle_median_deg,
                           e.smooth_normal_angle_mean_deg, e.smooth_normal_angle_median_deg,
                           e.mesh_normal_angle_mean_deg, e.mesh_normal_angle_median_deg})
      out += number(x);
    out += "," + std::to_string(f.steps) + number(f.wall_seconds) + number(f.cpu_seconds);
    out += others ? "," + std::to_string(others->fit.frames) + number(others->msd) + number(others->msd_interpolation) +
                        number(others->ratio())
                  : ",,,,";
    out += "\n";
  }
  return out;
}

std::string markdown(const RepresentationTable& table) {
  std::string out =
      "# How well moving surfaces are represented\n\n" + table.conditions +
      " Root motion is removed first; the smallest ball around the centroid that holds all frames has "
      "radius 1. MSD is the mean over points, frames and the three coordinates of the squared difference. "
      "Angles are in degrees.\n\n";
  if (!table.rows.empty()) out += by_sequence(table) + "\n" + table_1(table) + "\n";
  const bool any = std::any_of(table.rows.begin(), table.rows.end(), [](const auto& row) { return row.others; });
  if (any) out += table_2(table) + "\n";
  for (const auto& [file, reason] : table.failures) out += "Not usable: " + file + ": " + reason + "\n\n";
  return out.substr(0, out.size() - 1);
}

}  // namespace dsns::program
