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
  RegistrationOptions registration;                            ///< its mask is that of the first body
  std::function<Eigen::VectorXd(const Mat3X&)> second_mask{};  ///< of the second, for the way back
  int views = 1;             ///< ways there and back; all but the first through a warp of both spheres
  int warp_degree = 3;       ///< of the fields of those warps
  double warp_size = 0.087;  ///< radians in the root mean square: 5 degrees
  std::uint64_t seed = 0;    ///< of those warps
  double same_turn = 0.35;   ///< radians rms: maps farther than this from that of the least energy are left out of the mean
  DiffeomorphismFitOptions fit{{4, 8, 12, 16, 16, 20, 20}};  ///< of the mean, from what the first view found
};

struct SymmetricRegistration {
  SpatialResult there, back;
  int averaged = 0;          ///< maps, of 2 x views
  AngularDistance apart;     ///< of the first view's way there and back from the identity, radians
  AngularDistance together;  ///< of the results' way there and back
};

namespace detail {

/// Registers f1(w) to f2(w), w the warp.
template <AnimatedSurface F1, AnimatedSurface F2>
SpatialResult register_through(const SphereDiffeomorphism& warp, const F1& first, const F2& second,
                               RegistrationOptions options, const Progress& progress) {
  if (options.spatial.mask)
    options.spatial.mask = [mask = options.spatial.mask, warp](const Mat3X& s) { return mask(warp(s)); };
  return register_in_space(RegisteredSurface(first, Mat3::Identity(), warp),
                           RegisteredSurface(second, Mat3::Identity(), warp), options, progress);
}

/// What several maps make of the same points, and how much energy each leaves.
struct MapImages {
  std::vector<Mat3X> of_maps;
  std::vector<double> energies;

  std::size_t best() const {
    return static_cast<std::size_t>(std::min_element(energies.begin(), energies.end()) - energies.begin());
  }
  Mat3X mean(const std::vector<bool>& kept) const {
    Mat3X sum = Mat3X::Zero(3, of_maps.front().cols());
    for (std::size_t k = 0; k < of_maps.size(); ++k)
      if (kept[k]) sum += of_maps[k];
    return sum.colwise().normalized();
  }
};

inline Mat3X side_by_side(const Mat3X& a, const Mat3X& b) {
  Mat3X out(3, a.cols() + b.cols());
  out << a, b;
  return out;
}

/// Maps of both ways, inverse to each other: fitted to images of the nodes, and again to the mean of what both then say.
/// there    images of the nodes under the way there; back  likewise
inline void fit_both_ways(const SphereQuadrature& q, Mat3X there, Mat3X back, const DiffeomorphismFitOptions& options,
                          SymmetricRegistration& r) {
  constexpr int rounds = 2;
  const Eigen::VectorXd weights = q.weights.replicate(2, 1);
  const auto fitted = [&](const Mat3X& s, const Mat3X& y, const SphereDiffeomorphism& start) {
    DiffeomorphismFitOptions from = options;
    from.start = start;
    return fit_diffeomorphism(s, y, weights, from).gamma;
  };
  for (int round = 0; round < rounds; ++round) {
    const Mat3X s = side_by_side(q.points, back), y = side_by_side(there, q.points);
    r.there.gamma = fitted(s, y, r.there.gamma);
    r.back.gamma = fitted(y, s, r.back.gamma);
    there = (r.there.gamma(q.points) + r.back.gamma.inverse(q.points)).colwise().normalized();
    back = (r.back.gamma(q.points) + r.there.gamma.inverse(q.points)).colwise().normalized();
  }
}

}  // namespace detail

/// Registers both ways and through common warps of both spheres, and gives the mean.
/// returns  maps that are inverse to each other as far as `together` says, and the same, changed over, for (second, first)
/// accuracy there and back 0.1 degrees rms from the identity, of bodies of which each way alone gives 4 [docs/spatial.md]
/// throws   Error where a mean folds
template <AnimatedSurface F1, AnimatedSurface F2>
SymmetricRegistration register_symmetrically(const F1& first, const F2& second, const SymmetricOptions& options = {},
                                             const Progress& progress = {}) {
  require(options.views >= 1, "register_symmetrically: ", options.views, " views, give at least one");
  RegistrationOptions backward = options.registration;
  backward.spatial.mask = options.second_mask;
  const SphereQuadrature q = sphere_quadrature(28);
  SymmetricRegistration out;
  detail::MapImages there, back;
  std::vector<Mat3> turns;
  for (int view = 0; view < options.views; ++view) {
    const SphereDiffeomorphism warp =
        view == 0 ? SphereDiffeomorphism()
                  : random_diffeomorphism(options.seed + std::uint64_t(view), options.warp_degree, options.warp_size);
    const SpatialResult ways[] = {detail::register_through(warp, first, second, options.registration, progress),
                                  detail::register_through(warp, second, first, backward, progress)};
    const Mat3X s = warp.inverse(q.points);
    for (const bool way_back : {false, true}) {
      const SpatialResult& way = ways[way_back];
      const Mat3X along = warp(way.gamma(s)), against = warp(way.gamma.inverse(s));
      there.of_maps.push_back(way_back ? against : along);
      back.of_maps.push_back(way_back ? along : against);
      there.energies.push_back(way.summary.energy_after / way.summary.norm);
      turns.push_back(way_back ? Mat3(way.rotation.transpose()) : way.rotation);
    }
    if (view == 0) out.there = ways[0], out.back = ways[1];
  }
  const auto round_trip = [&] { return angular_distance(out.there.gamma(out.back.gamma(q.points)), q.points, q.weights); };
  out.apart = round_trip();
  std::vector<bool> kept;
  Mat3 turn = Mat3::Zero();
  const Mat3X& best = there.of_maps[there.best()];
  for (std::size_t k = 0; k < turns.size(); ++k) {
    kept.push_back(angular_distance(there.of_maps[k], best, q.weights).rms <= options.same_turn);
    if (kept.back()) turn += turns[k], ++out.averaged;
  }
  out.there.rotation = nearest_rotation(turn);
  out.back.rotation = out.there.rotation.transpose();
  detail::fit_both_ways(q, there.mean(kept), back.mean(kept), options.fit, out);
  out.together = round_trip();
  return out;
}

}  // namespace dsns
