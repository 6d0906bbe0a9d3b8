// evaluate consistency: laws of the registration of two bodies in space.
#include "evaluations.hpp"

#include <dsns/elastic/known_warp.hpp>
#include <dsns/mesh/sphere_mask.hpp>
#include <dsns/stats/co_registration.hpp>

namespace dsns::program {

namespace {

/// Root mean square and largest angle between two maps, as figures.
template <class A, class B>
void report_angle(const std::string& key, const std::string& label, const A& a, const B& b, Report& report) {
  const SphereQuadrature q = fibonacci_sphere(4000);
  const AngularDistance d = angular_distance(Mat3X(a(q.points)), Mat3X(b(q.points)), q.weights);
  report.figure(key + "_rms_deg", label + ", degrees rms", d.rms * 180 / pi);
  report.figure(key + "_max_deg", "  at most", d.largest * 180 / pi);
}

}  // namespace

void evaluate_consistency(const Body& first, const Body& second, double degrees, const Settings& settings,
                          Report& report) {
  // A mask, where holes of a body are closed, goes with its sphere.
  const auto mask = [](const Body& body,
                       const SphereDiffeomorphism& place) -> std::function<Eigen::VectorXd(const Mat3X&)> {
    if (body.normalized.sequence.cap_faces == 0) return {};
    return [mask = SphereMask(body.normalized.sequence, body.sphere.vertices), place](const Mat3X& s) {
      return mask(place(s));
    };
  };
  ProgressLine line;
  // Both bodies turned, and their spheres warped.
  const auto registered = [&](const Body& a, const Body& b, const KnownWarp& warp) {
    SymmetricOptions options;
    options.registration.spatial.search = settings.search;
    options.registration.spatial.threads = settings.threads;
    options.registration.spatial.mask = mask(a, warp.gamma);
    options.second_mask = mask(b, warp.gamma);
    options.views = settings.views;
    options.seed = settings.seed + 100;  // other warps than the one that is judged
    return register_spatial(AnyAnimatedSurface(RegisteredSurface(a.surface, warp.rotation, warp.gamma)),
                            AnyAnimatedSurface(RegisteredSurface(b.surface, warp.rotation, warp.gamma)), options,
                            std::ref(line));
  };
  const KnownWarp none{Mat3::Identity(), {}, 0};
  const SpatialResult there = registered(first, second, none), back = registered(second, first, none);
  report.figure("energy_share", "energy left, of the squared norm", there.summary.energy_after / there.summary.norm);
  report.figure("min_jacobian", "smallest Jacobian", min_jacobian(there.gamma, fibonacci_sphere(20000).points));
  report_angle(
      "inverse", "there and back", [&](const Mat3X& s) { return there.gamma(back.gamma(s)); },
      [](const Mat3X& s) { return s; }, report);

  const KnownWarp turn{known_warp(settings.seed + 1, 3, 0).rotation, {}, 0};
  report_angle("turned", "changed by a turn of both bodies", registered(first, second, turn).gamma, there.gamma,
               report);

  const KnownWarp warp = known_warp(settings.seed + 1, 3, degrees * pi / 180, KnownTurns::none);
  const SpatialResult warped = registered(first, second, warp);
  report_angle(
      "warped", message("changed by a warp of both spheres by ", degrees, " degrees"),
      [&](const Mat3X& s) { return warp.gamma(warped.gamma(s)); },
      [&](const Mat3X& s) { return there.gamma(warp.gamma(s)); }, report);
}

}  // namespace dsns::program
