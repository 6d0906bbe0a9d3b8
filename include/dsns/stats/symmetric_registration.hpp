#pragma once
/// Registration in space without a first and a second: both ways, and the mean of both.
///
///   const SymmetricRegistration r = register_symmetrically(f1, f2);
///   r.there; r.back;                       // f1(s) ~ O f2(gamma(s)) and the other way, inverse to each other
///
/// The energy is flat along many warps, so what a registration finds depends on which body comes first and on the
/// parametrisation that both have. The truth does not: the mean over both ways, and over several warps of both spheres, is
/// nearer to it than each.
#include <dsns/sphere/fit_diffeomorphism.hpp>
#include <dsns/stats/co_registration.hpp>

namespace dsns {

struct SymmetricOptions {
  RegistrationOptions registration;                            ///< its mask and landmarks are seen from the first body
  std::function<Eigen::VectorXd(const Mat3X&)> second_mask{};  ///< of the second, for the way back
  int views = 1;             ///< ways there and back; all but the first through a warp of both spheres
  int warp_degree = 3;       ///< of the fields of those warps
  double warp_size = 0.087;  ///< radians in the root mean square: 5 degrees
  std::uint64_t seed = 0;    ///< of those warps
  double same_turn = 0.35;   ///< radians rms: maps farther than this from that of the least energy are left out
  DiffeomorphismFitOptions fit{{1, 2, 4, 8, 12, 16, 20}};  ///< of the mean
};

/// The map of one direction is fitted, that of the other is its inverse.
struct SymmetricRegistration {
  SpatialResult there, back;
  int averaged = 0;            ///< maps, of 2 x views
  AngularDistance apart;       ///< of the first view's way there and back from the identity, radians
  AngularDistance mean_apart;  ///< of the result from the map of the least energy
};

namespace detail {

/// Registers f1(w) to f2(w), w the warp.
template <AnimatedSurface F1, AnimatedSurface F2>
SpatialResult register_through(const SphereDiffeomorphism& warp, const F1& first, const F2& second,
                               RegistrationOptions options, const Progress& progress) {
  if (options.spatial.mask)
    options.spatial.mask = [mask = options.spatial.mask, warp](const Mat3X& s) { return mask(warp(s)); };
  SphereLandmarks& landmarks = options.spatial.landmarks;
  landmarks.points = warp.inverse(landmarks.points);
  landmarks.targets = warp.inverse(landmarks.targets);
  return register_in_space(RegisteredSurface(first, Mat3::Identity(), warp),
                           RegisteredSurface(second, Mat3::Identity(), warp), options, progress);
}

/// What one registration makes of the nodes on the first sphere and on the second.
struct SeenMap {
  Mat3X there, back;
  Mat3 rotation;
  double energy;  ///< left of the squared norm
};

/// w(gamma(w^-1)) and its inverse at the nodes.
inline SeenMap seen(const SpatialResult& found, const SphereDiffeomorphism& warp, const Mat3X& nodes) {
  const Mat3X s = warp.inverse(nodes);
  return {warp(found.gamma(s)), warp(found.gamma.inverse(s)), found.rotation,
          found.summary.energy_after / found.summary.norm};
}
inline SeenMap changed_over(SeenMap map) {
  std::swap(map.there, map.back);
  map.rotation.transposeInPlace();
  return map;
}

/// The map fitted to the mean; `otherwise` where that folds.
inline SphereDiffeomorphism mean_map(const std::vector<SeenMap>& maps, const SphereQuadrature& q,
                                     const SphereDiffeomorphism& otherwise, const DiffeomorphismFitOptions& options) {
  Mat3X s(3, 2 * q.size()), y(3, 2 * q.size());
  Mat3X there = Mat3X::Zero(3, q.size()), back = there;
  for (const SeenMap& map : maps) there += map.there, back += map.back;
  s << q.points, back.colwise().normalized();
  y << there.colwise().normalized(), q.points;
  try {
    return fit_diffeomorphism(s, y, q.weights.replicate(2, 1), options).gamma;
  } catch (const InvalidArgument&) {
    throw;
  } catch (const Error&) {
    return otherwise;
  }
}

/// What the summary says of a result that was not found by descent.
template <AnimatedSurface F1, AnimatedSurface F2>
void judge(const F1& first, const F2& second, const RegistrationOptions& options, SpatialResult& result) {
  const TimeWarp clock;
  const int times = std::max(1, options.spatial_times), threads = options.spatial.threads;
  result.summary.energy_after = registered_energy(MovingStack<F1, TimeWarp>{first, clock, times, threads},
                                                  MovingStack<F2, TimeWarp>{second, clock, times, threads},
                                                  result.rotation, result.gamma, options.spatial);
  result.summary.min_jacobian = certify(result.gamma).min_jacobian;
  result.summary.landmarks_missed = missed(options.spatial.landmarks, result.gamma);
}

}  // namespace detail

/// Registers both ways and through common warps of both spheres, and gives the mean.
/// returns  maps inverse to each other, and the same changed over for (second, first), to 1e-9 radians. The summaries are those
///          of the first view; energy_after and min_jacobian those of the result
/// accuracy of man and woman walking, misses 8 % less in the root mean square than one way alone [docs/spatial.md]
template <AnimatedSurface F1, AnimatedSurface F2>
SymmetricRegistration register_symmetrically(const F1& first, const F2& second, const SymmetricOptions& options = {},
                                             const Progress& progress = {}) {
  require(options.views >= 1, "register_symmetrically: ", options.views, " views, give at least one");
  RegistrationOptions backward = options.registration;
  backward.spatial.mask = options.second_mask;
  backward.spatial.landmarks = changed_over(options.registration.spatial.landmarks);
  const SphereQuadrature q = sphere_quadrature(28);
  SymmetricRegistration out;
  std::vector<detail::SeenMap> maps;  // as ways there, of both ways in turn
  for (int view = 0; view < options.views; ++view) {
    const SphereDiffeomorphism warp =
        view == 0 ? SphereDiffeomorphism()
                  : random_diffeomorphism(options.seed + std::uint64_t(view), options.warp_degree, options.warp_size);
    SpatialResult there = detail::register_through(warp, first, second, options.registration, progress),
                  back = detail::register_through(warp, second, first, backward, progress);
    maps.push_back(detail::seen(there, warp, q.points));
    maps.push_back(detail::changed_over(detail::seen(back, warp, q.points)));
    if (view > 0) continue;
    out.there = std::move(there);
    out.back = std::move(back);
    out.apart = angular_distance(out.there.gamma(out.back.gamma(q.points)), q.points, q.weights);
  }
  const auto best =
      std::min_element(maps.begin(), maps.end(), [](const auto& a, const auto& b) { return a.energy < b.energy; });
  const bool fit_there = (best - maps.begin()) % 2 == 0;
  const Mat3X of_best = best->there;
  std::erase_if(maps, [&](const detail::SeenMap& m) {
    return angular_distance(m.there, of_best, q.weights).rms > options.same_turn;
  });
  Mat3 turn = Mat3::Zero();
  for (const detail::SeenMap& map : maps) turn += map.rotation;
  out.averaged = static_cast<int>(maps.size());
  out.there.rotation = nearest_rotation(turn);
  out.back.rotation = out.there.rotation.transpose();
  if (fit_there) {
    out.there.gamma = detail::mean_map(maps, q, out.there.gamma, options.fit);
    out.back.gamma = inverted(out.there.gamma);
  } else {
    std::transform(maps.begin(), maps.end(), maps.begin(), detail::changed_over);
    out.back.gamma = detail::mean_map(maps, q, out.back.gamma, options.fit);
    out.there.gamma = inverted(out.back.gamma);
  }
  out.mean_apart = angular_distance(out.there.gamma(q.points), of_best, q.weights);
  detail::judge(first, second, options.registration, out.there);
  detail::judge(second, first, backward, out.back);
  return out;
}

}  // namespace dsns
