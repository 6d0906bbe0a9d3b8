// evaluate temporal --pairs: sequences brought to the pace of others.
#include "temporal_experiments.hpp"

#include "fits.hpp"
#include "registration.hpp"
#include "temporal_curves.hpp"
#include "temporal_events.hpp"

#include <dsns/elastic/temporal_registration.hpp>
#include <dsns/io/source_name.hpp>
#include <dsns/surface/sampled.hpp>

#include <array>
#include <iostream>

namespace dsns::program {

namespace {

bool same_triangles(const Body& a, const Body& b) {
  return a.sphere.faces.cols() == b.sphere.faces.cols() && a.sphere.faces == b.sphere.faces;
}

/// Times at which both bodies do the same.
struct Events {
  std::vector<std::array<double, 2>> times;
};

Events common_events(const Body& a, const Body& b) {
  const auto first = landmarks(a), second = landmarks(b);
  Events out;
  for (const std::size_t k : {0u, 1u})
    if (first[k] && second[k]) out.times.push_back({*first[k], *second[k]});
  return out;
}

/// All methods on two curves; with the warp that was applied to the second, if the two should agree without it.
void compare_pair(const PairRow& names, const Curve& first, const Curve& second, const TimeWarp* truth,
                  const Events& events, std::vector<PairRow>& rows) {
  const Moving moving(first);
  const auto add = [&](const std::string& method, int samples, const auto& warp, double seconds) {
    PairRow row = names;
    row.method = method;
    row.samples = samples;
    row.distance = std::sqrt(elastic_energy(first, second, warp));
    if (truth != nullptr) row.timing = moving.miss(warp, *truth);
    if (truth == nullptr && !events.times.empty()) {
      double sum = 0;
      for (const auto& [t1, t2] : events.times) sum += std::abs(warp(t1) - t2);
      row.events = sum / double(events.times.size());
    }
    row.seconds = seconds;
    rows.push_back(row);
  };
  add("before", 0, TimeWarp(), 0);
  for (const int samples : {25, 50, 200}) {
    const Stopwatch dp;
    const auto path = dynamic_programming_warp(first, second, {.samples = samples});
    add("dp", samples, path, dp.seconds());
  }
  const Stopwatch ours;
  const TemporalResult r = register_temporally(first, second);
  add("ours", 0, r.warp, ours.seconds());
}

/// The curves of two bodies in the space of their joint components.
struct CurvePair {
  Curve first, second;
};

/// Vertex i of one is vertex i of the other: the second is seen on the first's sphere. The spline in time of sampled surfaces is
/// that of their coefficients.
CurvePair curves_of_same_mesh(const Body& a, const Body& b, const Mat3X& y) {
  constexpr int snapshots = 48;
  std::vector<SurfaceSamples> samples;
  std::vector<std::vector<Mat3X>> frames;
  for (const Body* body : {&a, &b}) {
    const SampledSurface surface(body->normalized.sequence, a.sphere.vertices);
    const SampledSurface::Hits hits = surface.locate(y);
    frames.emplace_back();
    for (const double t : equidistant_times(body->normalized.sequence.frame_count()))
      frames.back().push_back(surface.positions(hits, t));
    samples.emplace_back();
    for (const int k : spread_frames(int(frames.back().size()), snapshots))
      samples.back().snapshots.push_back(frames.back()[std::size_t(k)]);
  }
  const FunctionalPca pca = basis_of(samples);
  const auto curve = [&](const std::vector<Mat3X>& all) {
    Eigen::MatrixXd points(pca.modes(), Index(all.size()));
    for (std::size_t k = 0; k < all.size(); ++k) points.col(Index(k)) = pca.project(all[k]);
    return curve_through(points, equidistant_times(points.cols()));
  };
  return {curve(frames[0]), curve(frames[1])};
}

CurvePair curves_of_registered(const Body& a, const Body& b, const Mat3X& y, const Settings& settings) {
  constexpr int snapshots = 48;
  ProgressLine line;
  Settings told = settings;
  told.frames = 32;
  const SpatialResult s = register_bodies(a, b, told, std::ref(line)).spatial;
  const std::vector<SurfaceSamples> samples{samples_at(a.surface, y, Mat3::Identity(), snapshots),
                                            samples_at(b.surface, s.gamma(y), s.rotation, snapshots)};
  const FunctionalPca pca = basis_of(samples);
  return {shape_curve(samples[0], pca), shape_curve(samples[1], pca)};
}

void compare_bodies(const Body& a, const Body& b, const std::string& name_a, const std::string& name_b,
                    const Settings& settings, const TemporalEvaluation& evaluation, std::vector<PairRow>& rows) {
  const Mat3X y = points_of(a, settings);
  const bool same = same_triangles(a, b);
  const auto [first, second] = same ? curves_of_same_mesh(a, b, y) : curves_of_registered(a, b, y, settings);
  const PairRow names{name_a, name_b, {}, 0, 0, {}, {}, 0};
  const std::string clip = parse_source(name_a).clip;
  if (!same || clip.empty() || clip != parse_source(name_b).clip)
    return compare_pair(names, first, second, nullptr, common_events(a, b), rows);
  for (int k = 0; k < evaluation.warps; ++k) {
    const TimeWarp truth = random_pace(evaluation, k, settings);
    compare_pair(names, first, warped(second, truth), &truth, {}, rows);
  }
}

}  // namespace

PairComparison compare_pairs(const std::vector<std::string>& names, const Settings& settings,
                             const TemporalEvaluation& evaluation, Report& report) {
  PairComparison out;
  std::vector<std::optional<Body>> bodies;
  const auto failed = [&](const std::string& name, const std::exception& error) {
    ++out.failures;
    std::cout << std::flush;
    std::cerr << "dsns: " << name << ": " << error.what() << '\n';
    report.row("failures");
    report.note("file", name);
    report.note("reason", std::string(error.what()));
  };
  for (const std::string& name : names) {
    try {
      ProgressLine line;
      bodies.emplace_back(load_body(name, settings, report, std::ref(line)));
    } catch (const Error& error) {
      bodies.emplace_back();
      failed(name, error);
    }
  }
  for (std::size_t i = 0; i < names.size(); ++i)
    for (std::size_t j = i + 1; j < names.size(); ++j) {
      if (!bodies[i] || !bodies[j]) continue;
      try {
        compare_bodies(*bodies[i], *bodies[j], names[i], names[j], settings, evaluation, out.rows);
      } catch (const Error& error) {
        failed(names[i] + " and " + names[j], error);
      }
    }
  for (const PairRow& row : out.rows) {
    report.row("rows");
    report.note("file", row.first);
    report.note("second", row.second);
    report.note("method", row.method);
    report.note("samples", std::int64_t(row.samples));
    report.note("distance", row.distance);
    if (row.timing) report.note("timing", *row.timing);
    if (row.events) report.note("events", *row.events);
    report.note("seconds", row.seconds);
  }
  return out;
}

}  // namespace dsns::program
