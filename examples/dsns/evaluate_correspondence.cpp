// evaluate correspondence: which point of one body is which of another, against vertices that both share.
#include "evaluations.hpp"

#if defined(DSNS_WITH_SPECTRA)
#include "representation_tables.hpp"

#include <dsns/elastic/gradient_registration.hpp>
#include <dsns/elastic/known_warp.hpp>
#include <dsns/io/atomic_file.hpp>
#include <dsns/matching/correspond.hpp>
#include <dsns/mesh/edge_distances.hpp>
#include <dsns/mesh/isotropic_remesh.hpp>
#include <dsns/mesh/sphere_mask.hpp>
#include <dsns/mesh/spherical_parameterization.hpp>
#include <dsns/sphere/fit_diffeomorphism.hpp>
#include <dsns/stats/matched_registration.hpp>
#include <dsns/surface/sampled.hpp>

#include <chrono>
#include <ctime>
#include <iomanip>
#endif

namespace dsns::program {

#if !defined(DSNS_WITH_SPECTRA)

void evaluate_correspondence(const std::string&, const std::string&, const Settings&, const CorrespondenceEvaluation&,
                             Report&) {
  fail<Error>(
      "this program was built without Spectra, on which matching rests; install it (Debian: libspectra-dev) and build "
      "again");
}

#else

namespace {

/// The second body as matching gets it: other triangles, another sphere map, which is turned and warped.
struct Disguised {
  MeshSequence sequence;
  Mat3X sphere;
  std::vector<SurfacePoint> places;  ///< of its vertices on the body that it was
};

Disguised disguised(const Body& body, std::uint64_t seed, double degrees) {
  const MeshSequence& given = body.normalized.sequence;
  std::mt19937_64 random(seed);
  const double share = std::uniform_real_distribution<double>(0.9, 1.1)(random);
  const Remeshing r = isotropic_remesh(given.frame(0), {Index(share * double(given.vertex_count())), 6});
  Disguised out{remeshed(given, r), {}, r.places};
  out.sphere = known_warp(seed, 3, degrees * pi / 180).gamma(spherical_parameterization(out.sequence).sphere);
  return out;
}

/// Errors of maps to the second body, in per cent of its diameter: twice the largest distance from the centre of its box.
class Judge {
 public:
  Judge(const Body& first, const Body& second, const Disguised& shown, std::uint64_t seed)
      : walk_(second.normalized.sequence.frame(0)),
        places_(&shown.places),
        location_(shown.sphere, shown.sequence.faces),
        vertices_(&shown.sequence.frames.front()) {
    constexpr int samples = 400;
    const Mat3X& x = walk_.mesh().vertices;
    const Vec3d centre = (x.rowwise().minCoeff() + x.rowwise().maxCoeff()) / 2;
    diameter_ = 2 * (x.colwise() - centre).colwise().norm().maxCoeff();
    const MeshSequence& a = first.normalized.sequence;
    const Eigen::VectorXd areas = vertex_areas(a.frames.front(), a.faces.leftCols(a.faces.cols() - a.cap_faces));
    std::discrete_distribution<Index> by_area(areas.data(), areas.data() + areas.size());
    std::mt19937_64 random(seed);
    const EdgeDistances distances(walk_.mesh());
    points_.resize(3, samples);
    for (int k = 0; k < samples; ++k) {
      const Index v = by_area(random);
      points_.col(k) = first.sphere.vertices.col(v);
      from_truth_.push_back(distances.from(v));
    }
  }

  template <class Map>
  std::vector<double> errors(const Map& gamma) const {
    const Mat3X images = gamma(points_);
    std::vector<double> out;
    for (Index k = 0; k < images.cols(); ++k) {
      const SphereHit hit = location_(Vec3d(images.col(k)));
      Index corner = 0;
      hit.barycentric.maxCoeff(&corner);
      const Vec3d x = position(*vertices_, location_.faces(), {hit.face, hit.barycentric});
      const SurfacePoint p = walk_.nearest(x, (*places_)[std::size_t(location_.faces()(corner, hit.face))]);
      const Vec3d on_surface = walk_.position(p);
      double least = std::numeric_limits<double>::infinity();
      for (int c = 0; c < 3; ++c) {
        const Index v = walk_.mesh().faces(c, p.face);
        least = std::min(least, from_truth_[std::size_t(k)][v] + (on_surface - walk_.mesh().vertices.col(v)).norm());
      }
      out.push_back(100 * least / diameter_);
    }
    std::sort(out.begin(), out.end());
    return out;
  }

 private:
  SurfaceWalk walk_;
  const std::vector<SurfacePoint>* places_;
  SphereLocation location_;
  const Mat3X* vertices_;
  double diameter_ = 1;
  Mat3X points_;
  std::vector<Eigen::VectorXd> from_truth_;
};

struct Row {
  std::string method;
  std::uint64_t seed;
  double median, p90;
  bool flipped;
  double min_jacobian, seconds, cpu_seconds;
  double energy;  ///< share of the squared norm of the first's field; below 0: not known
};

class Clock {
 public:
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count(); }
  double cpu_seconds() const { return double(std::clock() - cpu_) / CLOCKS_PER_SEC; }

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  std::clock_t cpu_ = std::clock();
};

template <class Map>
Row judged(const std::string& method, std::uint64_t seed, const Judge& judge, const Map& gamma, const Clock& clock,
           double energy) {
  const double seconds = clock.seconds(), cpu = clock.cpu_seconds();
  const std::vector<double> e = judge.errors(gamma);
  const auto share = [&](double s) { return e[std::size_t(s * double(e.size() - 1))]; };
  return {method,  seed, share(0.5), share(0.9), share(0.9) > 25, min_jacobian(gamma, fibonacci_sphere(20000).points),
          seconds, cpu,  energy};
}

/// Ours: the correspondence, and from it the elastic refinement of its smooth version.
void add_ours(std::vector<Row>& rows, const Body& a, const Disguised& b, const AnyAnimatedSurface& second,
              std::uint64_t seed, const Judge& judge, const RegistrationOptions& options,
              const CorrespondenceEvaluation& evaluation, const Progress& progress) {
  Clock clock;
  const Correspondence c = correspond(MatchingBody(a.normalized.sequence, a.sphere.vertices),
                                      MatchingBody(b.sequence, b.sphere), {}, {}, {}, progress);
  rows.push_back(judged("correspond", seed, judge, c.gamma, clock, -1));
  if (!evaluation.refine) return;
  const MatchedRegistrationOptions usual;  // whose steps are looked at one by one
  const SphereDiffeomorphism smooth = smoothed(c.gamma, usual.smoothing).gamma;
  rows.push_back(judged("correspond, smoothed", seed, judge, smooth, clock, -1));
  RegistrationOptions from = options;
  from.spatial.search = RotationSearch::none;
  from.spatial.start = {Mat3::Identity(), smooth};
  from.spatial.levels = usual.levels;
  from.spatial.refinement = usual.refinement;
  const SpatialResult r = register_in_space(a.surface, second, from, progress);
  rows.push_back(
      judged("correspond, refined elastically", seed, judge, r.gamma, clock, r.summary.energy_after / r.summary.norm));
}

std::vector<Row> evaluate_seed(const Body& a, const Body& truth, std::uint64_t seed, const Settings& settings,
                               const CorrespondenceEvaluation& evaluation) {
  ProgressLine line;
  const Disguised b = disguised(truth, seed, evaluation.degrees);
  const AnyAnimatedSurface second(SampledSurface(b.sequence, b.sphere));
  const Judge judge(a, truth, b, seed);
  RegistrationOptions options;
  options.spatial.search = settings.search;
  options.spatial.threads = settings.threads;
  if (a.normalized.sequence.cap_faces > 0) options.spatial.mask = SphereMask(a.normalized.sequence, a.sphere.vertices);

  std::vector<Row> rows;
  if (evaluation.baselines) {
    Clock clock;
    const int harmonics = 20;
    const std::vector<HarmonicSurface> f{project_on_harmonics(at_time(a.surface, 0.0), harmonics)},
        g{project_on_harmonics(at_time(second, 0.0), harmonics)};
    SpatialOptions turn = options.spatial;
    turn.levels = {{1, 6, 0.05, 0.5}};
    turn.steps_per_level = 0;
    turn.rotations = 5000;
    turn.refined = 1;
    const SpatialResult best = register_harmonic(f, g, turn);
    const auto share = [](const SpatialSummary& s) { return s.energy_after / s.norm; };
    rows.push_back(judged("best rotation", seed, judge, best.gamma, clock, share(best.summary)));
    for (const auto& [name, scheme] : {std::pair("paper's scheme", GradientScheme::paper),
                                       std::pair("released code's scheme", GradientScheme::released)}) {
      clock = {};
      const SpatialResult r = register_by_gradient(f, g, scheme, {best.rotation, best.gamma}, options.spatial);
      rows.push_back(judged(name, seed, judge, r.gamma, clock, share(r.summary)));
    }
    clock = {};
    const SpatialResult elastic = register_in_space(a.surface, second, options, std::ref(line));
    rows.push_back(judged("register_spatially alone", seed, judge, elastic.gamma, clock, share(elastic.summary)));
  }
  if (settings.views > 0) {
    SymmetricOptions both;
    both.registration = options;
    if (b.sequence.cap_faces > 0) both.second_mask = SphereMask(b.sequence, b.sphere);
    both.views = settings.views;
    both.seed = settings.seed + 100;
    Clock clock;
    const SpatialResult mean = register_spatial(a.surface, second, both, std::ref(line));
    rows.push_back(judged(message("both ways, ", settings.views, " views"), seed, judge, mean.gamma, clock,
                          mean.summary.energy_after / mean.summary.norm));
  }
  add_ours(rows, a, b, second, seed, judge, options, evaluation, std::ref(line));
  return rows;
}

std::string markdown(const std::vector<Row>& rows) {
  std::ostringstream out;
  out << "| method | seed | median, % of the diameter | 90th percentile | flipped | smallest Jacobian | energy | "
         "seconds | "
         "CPU-seconds |\n|---|---|---|---|---|---|---|---|---|\n"
      << std::setprecision(3);
  for (const Row& r : rows) {
    out << "| " << r.method << " | " << r.seed << " | " << r.median << " | " << r.p90 << " | "
        << (r.flipped ? "yes" : "no") << " | " << r.min_jacobian << " | ";
    if (r.energy >= 0)
      out << r.energy;
    else
      out << '-';
    out << " | " << r.seconds << " | " << r.cpu_seconds << " |\n";
  }
  return out.str();
}

}  // namespace

void evaluate_correspondence(const std::string& first, const std::string& second, const Settings& settings,
                             const CorrespondenceEvaluation& evaluation, Report& report) {
  ProgressLine line;
  const Body a = load_body(first, settings, report, std::ref(line)),
             b = load_body(second, settings, report, std::ref(line));
  const Faces &fa = a.normalized.sequence.faces, &fb = b.normalized.sequence.faces;
  require<UnusableMesh>(fa.cols() == fb.cols() && fa == fb, first, " and ", second,
                        " have different triangles: the truth is that equal numbers of vertices correspond");
  std::vector<Row> all;
  for (int k = 0; k < evaluation.seeds; ++k)
    for (const Row& row : evaluate_seed(a, b, settings.seed + std::uint64_t(k) + 1, settings, evaluation)) {
      all.push_back(row);
      report.row("rows");
      report.note("method", row.method);
      report.note("seed", static_cast<std::int64_t>(row.seed));
      report.say(message(row.method, ", seed ", row.seed, ":"));
      report.figure("median_percent", "geodesic error, % of the diameter, median", row.median);
      report.figure("p90_percent", "  90th percentile", row.p90);
      report.figure("flipped", "flipped", row.flipped);
      report.figure("min_jacobian", "smallest Jacobian, on points not used", row.min_jacobian);
      if (row.energy >= 0) report.figure("energy_share", "energy over the squared norm", row.energy);
      report.figure("seconds", "seconds", row.seconds);
      report.figure("cpu_seconds", "CPU-seconds", row.cpu_seconds);
    }
  report.section("");
  Row worst{"", 0, 0, 0, false, std::numeric_limits<double>::infinity(), 0, 0, -1};
  for (const Row& row : all)
    if (row.method == "correspond") {
      worst.median = std::max(worst.median, row.median);
      worst.p90 = std::max(worst.p90, row.p90);
      worst.flipped = worst.flipped || row.flipped;
      worst.min_jacobian = std::min(worst.min_jacobian, row.min_jacobian);
      worst.seconds = std::max(worst.seconds, row.seconds);
    }
  report.say("The worst of correspond() over all seeds:");
  report.figure("median_percent", "geodesic error, % of the diameter, median", worst.median);
  report.figure("p90_percent", "  90th percentile", worst.p90);
  report.figure("flipped", "flipped", worst.flipped);
  report.figure("min_jacobian", "smallest Jacobian", worst.min_jacobian);
  report.figure("seconds", "seconds", worst.seconds);
  if (!evaluation.markdown.empty()) write_file_atomically(evaluation.markdown, markdown(all));
}

#endif

}  // namespace dsns::program
