#pragma once
/// Spatial registration: the rotation O and the diffeomorphism gamma of the sphere that minimise |h1 - O (h2 * gamma)|^2 over
/// one pair of surfaces, or summed over corresponding times of two moving ones.
///
/// Every surface, analytic, sampled or neural, is first projected on spherical harmonics; the levels then go from smooth to
/// detailed and from positions to the SRNF. A start comes from a search over rotations.
#include <dsns/core/progress.hpp>
#include <dsns/elastic/spatial_gauss_newton.hpp>
#include <dsns/elastic/spatial_refinement.hpp>
#include <dsns/sphere/sphere_map.hpp>

#include <span>

namespace dsns {

namespace detail {

/// The two stacks of surfaces, centred, and the scale that balances positions against the SRNF.
class SpatialPair {
 public:
  SpatialPair(std::span<const HarmonicSurface> first, std::span<const HarmonicSurface> second,
              const SpatialOptions& options)
      : first_(centred(first)), second_(centred(second)), options_(&options) {
    require_landmarks(options.landmarks, "register_spatially");
    require(!first.empty() && first.size() == second.size(), "register_spatially: ", first.size(), " surfaces against ",
            second.size(), ", give as many of both, at least one");
    const SphereQuadrature q = masked(sphere_quadrature(options.latitudes), options);
    double area = 0;
    for (const auto& f : first_) area += srnf(f, q.points).colwise().squaredNorm() * q.weights;
    position_scale_ = 3 / std::sqrt(area / double(first.size()));
  }

  HalfDensityField field(const std::vector<HarmonicSurface>& surfaces, const SpatialLevel& level) const {
    std::vector<HarmonicSurface> smooth;
    for (const auto& f : surfaces) smooth.push_back(f.smoothed(level.surface_degree, level.smoothing));
    return {std::move(smooth), level.position_weight, position_scale_};
  }
  SpatialProblem problem(const SpatialLevel& level, const SphereQuadrature& q) const {
    return {field(first_, level), field(second_, level), q, *options_};
  }

  const std::vector<HarmonicSurface>& first() const { return first_; }
  const std::vector<HarmonicSurface>& second() const { return second_; }

 private:
  static std::vector<HarmonicSurface> centred(std::span<const HarmonicSurface> surfaces) {
    std::vector<HarmonicSurface> out;
    for (const auto& f : surfaces) {
      Eigen::MatrixX3d c = f.coefficients();
      const SphereQuadrature q = sphere_quadrature(f.degree() + 4);
      const Eigen::RowVectorXd density =
          area_normals(f.jets(charts_at(q.points))).colwise().norm().cwiseProduct(q.weights.transpose());
      const Vec3d centroid = f.positions(q.points) * density.transpose() / density.sum();
      c.row(0) -= centroid.transpose() * std::sqrt(4 * pi);
      out.emplace_back(std::move(c));
    }
    return out;
  }

  std::vector<HarmonicSurface> first_, second_;
  double position_scale_ = 1;
  const SpatialOptions* options_;
};

/// A turn R of the sphere with the turn O of the body that goes with it, and how well they fit.
struct RotationCandidate {
  Mat3 R, O;
  double energy;
};

/// Candidates in the order of their energy, the identity among them.
inline std::vector<RotationCandidate> search_rotations(const SpatialPair& pair, const SpatialOptions& options) {
  const SphereQuadrature q = masked(fibonacci_sphere(400), options);
  const bool upright = options.search == RotationSearch::upright;
  SpatialLevel level = options.levels.front();
  if (upright) level.position_weight = 1;
  const HalfDensityField first = pair.field(pair.first(), level), second = pair.field(pair.second(), level);
  const Eigen::MatrixXd target = first(charts_at(q.points)).g;
  const std::vector<Mat3> grid = rotation_grid(options.rotations);
  const LandmarkTerm landmarks(options.landmarks, target.colwise().squaredNorm() * q.weights);
  std::vector<RotationCandidate> candidates(grid.size());
  parallel_for(static_cast<int>(grid.size()), options.threads, [&](int k) {
    const Mat3& R = grid[std::size_t(k)];
    const Eigen::MatrixXd g = second(charts_at((R * q.points).colwise().normalized())).g;
    const Mat3 O = upright ? Mat3::Identity() : nearest_rotation(block_correlation(target, g, q.weights));
    candidates[std::size_t(k)] = {R, O,
                                  (target - rotate_blocks(O, g)).colwise().squaredNorm() * q.weights +
                                      landmarks.energy(R * landmarks.behind(q.points), q.size())};
  });
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const auto& a, const auto& b) { return a.energy < b.energy; });
  return candidates;
}

/// The first `count` of the candidates that turn the sphere differently: neighbours of a good one would lead to the same end.
inline std::vector<RotationCandidate> distinct(const std::vector<RotationCandidate>& candidates, int count) {
  constexpr double apart = 0.5;  // radians, somewhat more than neighbours are
  std::vector<RotationCandidate> kept;
  for (const auto& candidate : candidates) {
    if (int(kept.size()) >= std::max(1, count)) break;
    const auto near = [&](const RotationCandidate& k) { return rotation_angle(k.R * candidate.R.transpose()) < apart; };
    if (std::none_of(kept.begin(), kept.end(), near)) kept.push_back(candidate);
  }
  return kept;
}

/// The best candidate after a few steps on a coarse grid: all are turned and shifted, the best of those bent by degree 2 and 3. The
/// right turn of a large warp is often not among the first before that, and many turns end in one place.
inline RotationCandidate best_rotation(const SpatialPair& pair, const SpatialOptions& options) {
  const SphereQuadrature q = masked(sphere_quadrature(12), options);
  const SpatialProblem problem = pair.problem(options.levels.front(), q);
  std::vector<std::pair<RotationCandidate, Particles>> shifted, bent;
  const auto descend_to = [&](Particles p, int degree) {
    std::vector<SphereVectorField> fields;
    std::vector<double> energies;
    return problem.minimise(std::move(p), degree, 8, fields, energies);
  };
  const Mat3X& points = problem.points();
  for (const auto& candidate : distinct(search_rotations(pair, options), options.refined))
    shifted.emplace_back(candidate, descend_to(problem.at((candidate.R * points).colwise().normalized(),
                                                          Eigen::VectorXd::Ones(points.cols()), candidate.O),
                                               1));
  const auto lower = [](const auto& a, const auto& b) { return a.second.energy < b.second.energy; };
  std::stable_sort(shifted.begin(), shifted.end(), lower);
  constexpr double one_place = 0.3;  // radians rms
  for (const auto& found : shifted) {
    if (int(bent.size()) >= std::max(1, options.bent)) break;
    const Mat3X y = found.second.y.leftCols(q.size());
    const auto same = [&](const auto& b) {
      return angular_distance(b.second.y.leftCols(q.size()), y, q.weights).rms < one_place;
    };
    if (std::none_of(bent.begin(), bent.end(), same)) bent.push_back(found);
  }
  for (auto& [candidate, particles] : bent)
    for (const int degree : {2, 3}) particles = descend_to(std::move(particles), degree);
  return std::min_element(bent.begin(), bent.end(), lower)->first;
}

inline double missed(const SphereLandmarks& landmarks, const SphereDiffeomorphism& gamma) {
  return landmarks.size() == 0 ? 0
                               : angular_distance(gamma(landmarks.points), landmarks.targets, landmarks.weights).rms;
}

/// gamma from its parts, without the last increments for which the fine grid shows a fold; says in `summary` if any were dropped.
inline SphereDiffeomorphism certified(const Mat3& R, std::vector<SphereVectorField> fields, SpatialSummary& summary) {
  for (const std::size_t found = fields.size();;) {
    SphereDiffeomorphism gamma(R);
    for (const auto& v : fields) gamma.append(v);
    const DiffeomorphismCertificate certificate = certify(gamma);
    if (certificate.holds() || fields.empty()) {
      summary.min_jacobian = certificate.min_jacobian;
      if (fields.size() < found)
        summary.stop += message("; ", found - fields.size(), " last steps dropped, a finer grid showed a fold");
      return gamma;
    }
    fields.pop_back();
  }
}

}  // namespace detail

/// Registers surfaces already projected on harmonics; surface k of the second stack corresponds to surface k of the first.
/// returns  O and gamma with gamma certified on a grid; the identity, or the start given, where nothing better was found
/// accuracy a degree-3 warp of 5 degrees with a rotation is recovered to 0.01 degrees [elastic/spatial_registration_test]
/// source   Gauss-Newton on the SRNF distance of Jermyn et al. 2012, fields as in Kurtek et al. 2010
inline SpatialResult register_harmonic(std::span<const HarmonicSurface> first, std::span<const HarmonicSurface> second,
                                       const SpatialOptions& options = {}, const Progress& progress = {}) {
  require(!options.levels.empty(), "register_spatially: no levels, give at least one");
  const detail::SpatialPair pair(first, second, options);
  const SphereQuadrature q = masked(sphere_quadrature(options.latitudes), options);

  const SpatialStart unmoved = options.search == RotationSearch::none ? options.start : SpatialStart{};
  SpatialStart start = unmoved;
  if (options.search != RotationSearch::none) {
    report(progress, "rotation search", 0);
    const detail::RotationCandidate turn = detail::best_rotation(pair, options);
    start = {turn.O, SphereDiffeomorphism(turn.R)};
  }
  std::vector<SphereVectorField> fields = start.gamma.increments();
  const Mat3X points = detail::LandmarkTerm(options.landmarks, 0).behind(q.points);
  const SphereDisplacement begin = start.gamma.displacement(charts_at(points));
  Mat3X y = begin.y;
  Eigen::VectorXd J = begin.J;

  SpatialResult result;
  SpatialSummary& summary = result.summary;
  Mat3 O = start.rotation;
  for (std::size_t k = 0; k < options.levels.size(); ++k) {
    const SpatialLevel& level = options.levels[k];
    report(progress, "spatial registration", double(k) / double(options.levels.size()));
    const detail::SpatialProblem problem = pair.problem(level, q);
    detail::Particles p =
        problem.minimise(problem.at(y, J, O), level.field_degree, options.steps_per_level, fields, summary.energies);
    y = std::move(p.y);
    J = std::move(p.J);
    O = p.O;
  }
  summary.stop = "all levels done";
  result.gamma = detail::certified(start.gamma.rotation(), std::move(fields), summary);
  result.rotation = O;

  SpatialLevel level = options.levels.back();
  const auto energies = [&](const Mat3X& at) {
    const detail::SpatialProblem problem = pair.problem(level, q);
    const SphereDisplacement end = result.gamma.displacement(charts_at(at));
    summary.norm = problem.norm();
    const SphereDisplacement before = unmoved.gamma.displacement(charts_at(at));
    summary.energy_before = problem.at(before.y, before.J, unmoved.rotation).energy;
    summary.energy_after = problem.at(end.y, end.J, O).energy;
  };
  energies(points);
  const bool better = summary.energy_after <= summary.energy_before;
  level.position_weight = 0;
  energies(q.points);
  summary.steps = static_cast<int>(result.gamma.increments().size() - start.gamma.increments().size());
  if (!better) {
    result = {unmoved.rotation, unmoved.gamma, summary};
    result.summary.energy_after = summary.energy_before;
    result.summary.min_jacobian = certify(unmoved.gamma).min_jacobian;
    result.summary.steps = 0;
    result.summary.stop = "nothing better than the start was found";
  }
  result.summary.landmarks_missed = detail::missed(options.landmarks, result.gamma);
  report(progress, "spatial registration", 1);
  return result;
}

/// |h1 - O (h2 * gamma)|^2 of surfaces that are warped first and projected on harmonics then, as many as the last level has; h
/// the SRNF alone.
template <SurfaceStack First, SurfaceStack Second>
double registered_energy(const First& first, const Second& second, const Mat3& rotation,
                         const SphereDiffeomorphism& gamma, const SpatialOptions& options) {
  require(!options.levels.empty() || !options.refinement.empty(), "registered_energy: no levels, give at least one");
  SpatialLevel level = options.levels.empty() ? options.refinement.back() : options.levels.back();
  level.position_weight = 0;
  SpatialOptions elastic = options;
  elastic.landmarks = {};
  const detail::RefinementProblem problem(first, second, level, elastic);
  SphereDisplacement end = gamma.displacement(charts_at(problem.points()));
  return problem.at(std::move(end.y), std::move(end.J), rotation).energy;
}

/// Refines a registration by the levels of options.refinement, on surfaces that are warped first and projected then.
/// first, second  corresponding surfaces, e.g. StillStack or MovingStack
/// returns  the registration with further increments; the former one where no step helps or the increments would fold
/// accuracy of warps of 4 to 8.5 degrees, found to 1 to 2 degrees, misses 0.003 to 0.08 degrees [docs/spatial.md]
template <SurfaceStack First, SurfaceStack Second>
SpatialResult refine_registration(const First& first, const Second& second, const SpatialResult& former,
                                  const SpatialOptions& options = {}, const Progress& progress = {}) {
  std::vector<SphereVectorField> fields = former.gamma.increments();
  SpatialResult result = former;
  bool one_body = false;
  for (std::size_t k = 0; k < options.refinement.size(); ++k) {
    report(progress, "spatial refinement", double(k) / double(options.refinement.size()));
    const bool finest = one_body && k + 1 == options.refinement.size();
    const SpatialLevel& level = finest ? options.finest : options.refinement[k];
    const detail::RefinementProblem problem(first, second, level, options);
    SphereDiffeomorphism gamma(former.gamma.rotation());
    for (const auto& v : fields) gamma.append(v);
    const SphereDisplacement begin = gamma.displacement(charts_at(problem.points()));
    detail::RefinementState p = problem.at(begin.y, begin.J, result.rotation);
    const int most_steps = finest ? 1 : 8;
    for (int step = 0; step < most_steps; ++step) {
      const double energy = p.energy;
      p = problem.minimise(std::move(p), level.field_degree, 1, fields, result.summary.energies);
      const double left = p.energy / energy;
      if (!(left < 1 - options.tolerance) || (step + 1 >= options.refinement_steps && left > 0.3)) break;
    }
    result.rotation = p.O;
    one_body = p.energy <= options.one_body * problem.norm();
  }
  const std::size_t before = former.gamma.increments().size(), found = fields.size();
  result.gamma = detail::certified(former.gamma.rotation(), std::move(fields), result.summary);
  if (result.gamma.increments().size() < found) {
    const std::string stop = former.summary.stop + "; a refinement that folds was dropped";
    result = former;
    result.summary.stop = stop;
  }
  result.summary.steps += static_cast<int>(result.gamma.increments().size() - before);
  result.summary.landmarks_missed = detail::missed(options.landmarks, result.gamma);
  if (!options.refinement.empty())
    result.summary.energy_after = registered_energy(first, second, result.rotation, result.gamma, options);
  report(progress, "spatial refinement", 1);
  return result;
}

/// Degree of the harmonics that the levels of the options ask for.
inline int surface_degree(const SpatialOptions& options) {
  int degree = 1;
  for (const auto& level : options.levels) degree = std::max(degree, level.surface_degree);
  return degree;
}

/// Registers one surface to another, of any kind, and refines.
/// accuracy warps of degree 6 up to 10 degrees, with any turns of body and sphere, are found again to 0.04 degrees on bodies of
///          several limbs, warps of degree 3 and 13 to 24 degrees to 0.14 [examples/known_warps]
template <Surface S1, Surface S2>
SpatialResult register_spatially(const S1& first, const S2& second, const SpatialOptions& options = {},
                                 const Progress& progress = {}) {
  const int degree = surface_degree(options);
  const std::vector<HarmonicSurface> a{project_on_harmonics(first, degree)}, b{project_on_harmonics(second, degree)};
  const SpatialResult result = register_harmonic(a, b, options, progress);
  return refine_registration(StillStack<S1>{first}, StillStack<S2>{second}, result, options, progress);
}

}  // namespace dsns
