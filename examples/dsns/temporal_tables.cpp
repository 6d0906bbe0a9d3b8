#include "temporal_tables.hpp"

#include "gnuplot.hpp"
#include "tables.hpp"

#include <dsns/core/errors.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace dsns::program {

namespace {

std::string name_of(const std::string& method, int samples) {
  if (method == "before") return "before";
  if (method == "dp") return "DP, " + std::to_string(samples) + " samples";
  return method;
}

}  // namespace

Quantiles quantiles(std::vector<double> values) {
  Quantiles q;
  q.count = values.size();
  if (values.empty()) return q;
  std::sort(values.begin(), values.end());
  const double n = double(values.size());
  for (const double x : values) q.mean += x / n;
  for (const double x : values) q.std += (x - q.mean) * (x - q.mean);
  q.std = n > 1 ? std::sqrt(q.std / (n - 1)) : 0;
  const auto at = [&](double share) {
    const double u = share * (n - 1);
    const auto left = std::min(static_cast<std::size_t>(u), values.size() - 1);
    const std::size_t right = std::min(left + 1, values.size() - 1);
    return values[left] + (u - double(left)) * (values[right] - values[left]);
  };
  q.median = at(0.5);
  q.high = at(0.95);
  q.most = values.back();
  return q;
}

std::vector<RecoveryGroup> groups(const std::vector<RecoveryRow>& rows) {
  std::vector<RecoveryGroup> out;
  std::vector<std::vector<double>> seconds;
  for (const RecoveryRow& row : rows) {
    const std::string from = row.surface == "raw" ? " raw samples" : row.samples == 0 ? " all frames" : " frames";
    const std::string label = name_of(row.method, row.samples == 0 ? 200 : row.samples) + "; " + row.surface + " from" +
                              (row.samples == 0 ? "" : " " + std::to_string(row.samples)) + from;
    auto group = std::find_if(out.begin(), out.end(), [&](const auto& g) { return g.label == label; });
    if (group == out.end()) {
      out.push_back({label, row.surface, row.method, row.samples, {}, {}, {}});
      seconds.emplace_back();
      group = out.end() - 1;
    }
    group->values.push_back(row.warp_l2);
    seconds[std::size_t(group - out.begin())].push_back(row.seconds);
  }
  for (std::size_t k = 0; k < out.size(); ++k) {
    out[k].warp_l2 = quantiles(out[k].values);
    out[k].seconds = quantiles(seconds[k]);
  }
  return out;
}

std::vector<PairGroup> groups(const std::vector<PairRow>& rows) {
  std::vector<PairGroup> out;
  std::vector<std::array<std::vector<double>, 4>> values;
  for (const PairRow& row : rows) {
    const std::string label = name_of(row.method, row.samples);
    auto group = std::find_if(out.begin(), out.end(), [&](const auto& g) { return g.label == label; });
    if (group == out.end()) {
      out.push_back({label, row.method, row.samples, {}, {}, {}, {}});
      values.emplace_back();
      group = out.end() - 1;
    }
    auto& mine = values[std::size_t(group - out.begin())];
    mine[0].push_back(row.distance);
    if (row.timing) mine[1].push_back(*row.timing);
    if (row.events) mine[2].push_back(*row.events);
    mine[3].push_back(row.seconds);
  }
  for (std::size_t k = 0; k < out.size(); ++k) {
    out[k].distance = quantiles(values[k][0]);
    out[k].timing = quantiles(values[k][1]);
    out[k].events = quantiles(values[k][2]);
    out[k].seconds = quantiles(values[k][3]);
  }
  return out;
}

std::string csv(const std::vector<RecoveryRow>& rows) {
  std::string out = "file,surface,method,samples,warp,warp_l2,seconds\n";
  for (const RecoveryRow& r : rows)
    out += message(csv_field(r.file), ",", r.surface, ",", r.method, ",", r.samples, ",", r.warp, ",", r.warp_l2, ",",
                   r.seconds, "\n");
  return out;
}

std::string csv(const std::vector<PairRow>& rows) {
  std::string out = "first,second,method,samples,distance,timing,events,seconds\n";
  for (const PairRow& r : rows)
    out += message(csv_field(r.first), ",", csv_field(r.second), ",", r.method, ",", r.samples, ",", r.distance, ",",
                   r.timing ? message(*r.timing) : std::string(), ",", r.events ? message(*r.events) : std::string(),
                   ",", r.seconds, "\n");
  return out;
}

std::string markdown(const std::vector<RecoveryRow>& rows) {
  std::string out =
      table_head({"method and surface", "warps", "L2 error: median", "95th percentile", "largest", "seconds"});
  for (const RecoveryGroup& g : groups(rows))
    out += table_line({g.label, std::to_string(g.warp_l2.count), scientific(g.warp_l2.median),
                       scientific(g.warp_l2.high), scientific(g.warp_l2.most), scientific(g.seconds.mean)});
  return out;
}

std::string markdown(const std::vector<PairRow>& rows) {
  std::string out =
      table_head({"method", "pairs", "distance: mean", "standard deviation", "median", "timing: warps known", "mean",
                  "median", "largest", "events: pairs", "mean", "median", "seconds"});
  const auto cells = [](const Quantiles& q, std::initializer_list<double> values) {
    std::vector<std::string> text{std::to_string(q.count)};
    for (const double x : values) text.push_back(q.count > 0 ? scientific(x) : "-");
    return text;
  };
  for (const PairGroup& g : groups(rows)) {
    std::vector<std::string> row{g.label};
    for (const auto& part : {cells(g.distance, {g.distance.mean, g.distance.std, g.distance.median}),
                             cells(g.timing, {g.timing.mean, g.timing.median, g.timing.most}),
                             cells(g.events, {g.events.mean, g.events.median})})
      row.insert(row.end(), part.begin(), part.end());
    row.push_back(scientific(g.seconds.mean));
    out += table_line(row);
  }
  return out;
}

std::string csv(const std::vector<StretchRow>& rows) {
  std::string out =
      "file,case,warp,warp_l2_whole,warp_l2,energy_whole,energy,first_end,second_begin,second_passes,seconds,advice\n";
  for (const StretchRow& r : rows)
    out += message(csv_field(r.file), ",", r.content, ",", r.warp, ",", r.miss_whole, ",", r.miss_named, ",",
                   r.energy_whole, ",", r.energy_named, ",", r.first_end, ",", r.second_begin, ",", r.second_passes,
                   ",", r.seconds, ",", csv_field(r.advice), "\n");
  return out;
}

std::string markdown(const std::vector<StretchRow>& rows) {
  std::string out = table_head({"file", "case", "warps", "L2 error, whole: median", "by its option: median", "largest",
                                "energy left, whole", "by its option", "advised", "seconds"});
  for (std::size_t k = 0; k < rows.size();) {
    std::array<std::vector<double>, 5> values;
    std::size_t next = k;
    int advised = 0;
    for (; next < rows.size() && rows[next].file == rows[k].file && rows[next].content == rows[k].content; ++next) {
      const StretchRow& r = rows[next];
      const std::array<double, 5> row{r.miss_whole, r.miss_named, r.energy_whole, r.energy_named, r.seconds};
      for (std::size_t i = 0; i < row.size(); ++i) values[i].push_back(row[i]);
      advised += r.advice.empty() ? 0 : 1;
    }
    const Quantiles named = quantiles(values[1]);
    out += table_line({rows[k].file, rows[k].content, std::to_string(next - k), scientific(quantiles(values[0]).median),
                       scientific(named.median), scientific(named.most), scientific(quantiles(values[2]).median),
                       scientific(quantiles(values[3]).median), std::to_string(advised),
                       scientific(quantiles(values[4]).mean)});
    k = next;
  }
  return out;
}

bool draw_boxes(const std::vector<RecoveryRow>& rows, const std::filesystem::path& folder) {
  std::vector<Box> boxes;
  for (const RecoveryGroup& group : groups(rows)) {
    std::string label = group.label;
    label.replace(label.find("; "), 2, "\\n");
    boxes.push_back({label, group.values, group.method == "ours" ? 2 : 1});
  }
  return draw_boxes(boxes, "L2 error of the warp", folder / "temporal_warps.svg");
}

}  // namespace dsns::program
