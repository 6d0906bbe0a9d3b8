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
  RegistrationOptions options;
  options.spatial.search = settings.search;
  options.spatial.threads = settings.threads;
  // A mask, where holes of the first are closed, would go with its sphere.
  const auto masked = [&](const Body& body, auto place) {
    RegistrationOptions o = options;
    if (body.normalized.sequence.cap_faces > 0)
      o.spatial.mask = [mask = SphereMask(body.normalized.sequence, body.sphere.vertices), place](const Mat3X& s) {
        return mask(place(s));
      };
    return o;
  };
  const auto same_place = [](const Mat3X& s) { return s; };
  const auto& f = first.surface;
  const auto& g = second.surface;
  ProgressLine line;
  const SpatialResult there = register_in_space(f, g, masked(first, same_place), std::ref(line)),
                      back = register_in_space(g, f, masked(second, same_place), std::ref(line));
  report.figure("energy_share", "energy left, of the squared norm", there.summary.energy_after / there.summary.norm);
  report.figure("min_jacobian", "smallest Jacobian", min_jacobian(there.gamma, fibonacci_sphere(20000).points));
  report_angle(
      "inverse", "there and back", [&](const Mat3X& s) { return there.gamma(back.gamma(s)); },
      [](const Mat3X& s) { return s; }, report);

  const KnownWarp turn = known_warp(settings.seed + 1, 3, 0);
  const SpatialResult turned =
      register_in_space(RegisteredSurface(f, turn.rotation, {}), RegisteredSurface(g, turn.rotation, {}),
                        masked(first, same_place), std::ref(line));
  report_angle("turned", "changed by a turn of both bodies", turned.gamma, there.gamma, report);

  const KnownWarp warp = known_warp(settings.seed + 1, 3, degrees * pi / 180, KnownTurns::none);
  const SpatialResult warped = register_in_space(
      RegisteredSurface(f, Mat3::Identity(), warp.gamma), RegisteredSurface(g, Mat3::Identity(), warp.gamma),
      masked(first, [gamma = warp.gamma](const Mat3X& s) { return gamma(s); }), std::ref(line));
  report_angle(
      "warped", message("changed by a warp of both spheres by ", degrees, " degrees"),
      [&](const Mat3X& s) { return warp.gamma(warped.gamma(s)); },
      [&](const Mat3X& s) { return there.gamma(warp.gamma(s)); }, report);
}

}  // namespace dsns::program
