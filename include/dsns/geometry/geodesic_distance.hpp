#pragma once
/// Geodesic distance between two points of a smooth surface, to near rounding: paths relaxed from several starts are sharpened
/// by shooting. What is returned is a geodesic and the shortest of those found; that no shorter one exists is not proved.
#include <dsns/geometry/geodesic_starts.hpp>
#include <dsns/geometry/geodesics.hpp>

namespace dsns {

struct GeodesicDistanceOptions {
  GeodesicOptions path;     ///< of each shot
  int nodes = 33;           ///< of the relaxed starts; more for long paths over many bends
  int graph_level = 4;      ///< icosphere whose edges give one of the starts; thin limbs need finer ones
  int max_iterations = 20;  ///< shots for each start
};

/// The shortest geodesic found.
struct GeodesicDistance {
  double length = 0;
  Geodesic path;           ///< from the first point to the second; its last jacobi and conjugate_points(path) judge it
  double miss = 0;         ///< distance in R^3 of its end from the second point
  int found = 0;           ///< starts from which shooting converged
  bool converged = false;  ///< miss <= 1e-9 length for the path returned, else the path is only near a geodesic
};

namespace detail {

/// Newton's method on the angle at the start and the length. An end that misses the target by m is brought there by
/// dlength = <m, T> and dangle = <m, N> / J with the end's tangent T, its conormal N = n x T and the Jacobi field J. A step
/// that does not come closer is halved. The path has its ends only.
template <Surface S>
GeodesicDistance shoot(const S& surface, const SpherePath& start, const GeodesicDistanceOptions& options) {
  const Vec3d a = start.col(0), b = start.rightCols<1>();
  const Vec3d target = surface(b);
  const ChartBatch at_a = charts_at(a), at_b = charts_at(b);
  const Vec3d normal_a = unit_normals(tangents(surface, at_a)).col(0);
  const SurfaceTangents first = tangents(surface, charts_at(start.leftCols<3>()));
  // The direction at a from a parabola through the first three points, which lie at equal lengths.
  Vec3d direction = -3 * first.f.col(0) + 4 * first.f.col(1) - first.f.col(2);
  direction = (direction - normal_a * normal_a.dot(direction)).normalized();
  double length = chords(surface, start).sum(), step = 1;

  GeodesicOptions ends = options.path;
  ends.samples = 2;
  const auto shot = [&](const Vec3d& along, double far) {
    GeodesicDistance d;
    d.path = geodesic(surface, a, along, far, ends);
    d.length = far;
    d.miss = d.path.summary.converged ? (target - d.path.points.rightCols<1>()).norm()
                                      : std::numeric_limits<double>::infinity();
    return d;
  };
  GeodesicDistance best = shot(direction, length);
  Vec3d best_direction = direction;
  for (int i = 0; i < options.max_iterations && std::isfinite(best.miss); ++i) {
    if (best.miss <= 1e-14 * target.norm() + 1e-13 * best.length) break;
    const Index end = best.path.size() - 1;
    const Vec3d m = target - best.path.points.col(end), T = best.path.tangents.col(end);
    const Vec3d n = unit_normals(tangents(surface, charts_at(best.path.s.col(end)))).col(0);
    const double J = best.path.jacobi[end];
    const double angle = J == 0 ? 0 : std::clamp(step * m.dot(n.cross(T)) / J, -0.5, 0.5);
    length = best.length + std::clamp(step * m.dot(T), -best.length / 2, best.length / 2);
    direction = std::cos(angle) * best_direction + std::sin(angle) * normal_a.cross(best_direction);
    GeodesicDistance next = shot(direction, length);
    if (next.miss < best.miss) {
      best = std::move(next);
      best_direction = direction;
      step = std::min(1.0, 2 * step);
    } else {
      if (best.miss <= 1e-12 * best.length) break;  // rounding
      step /= 2;
    }
  }
  best.converged = best.miss <= 1e-9 * best.length;
  return best;
}

}  // namespace detail

/// Distance along the surface between f(a) and f(b), a and b unit vectors. Starts: the great circle and the great circle bent
/// to both sides, and the shortest path over the edges of an icosphere, all relaxed first. The shortest converged path wins;
/// if none converged, the one that misses least.
/// accuracy 1e-11 relative on spheres and ellipsoids; symmetric to 1e-10 [geometry/geodesic_distance_test]
/// throws   InvalidArgument unless a and b are unit vectors, nodes >= 5; DegenerateSurface at points not immersed
template <Surface S>
GeodesicDistance geodesic_distance(const S& surface, const Vec3d& a, const Vec3d& b,
                                   const GeodesicDistanceOptions& options = GeodesicDistanceOptions()) {
  require(options.nodes >= 5, "geodesic_distance: ", options.nodes, " nodes, give at least 5");
  if (a == b) {
    GeodesicDistance none;
    none.path = geodesic(surface, a, tangents(surface, charts_at(a)).fu.col(0), 0, options.path);
    none.converged = true;
    return none;
  }
  std::vector<detail::SpherePath> starts;
  for (const double bend : {0.0, 1.0, -1.0}) starts.push_back(detail::bent_arc(a, b, bend, options.nodes));
  starts.push_back(detail::edge_path(surface, a, b, options.graph_level));
  std::vector<GeodesicDistance> candidates;
  for (const detail::SpherePath& start : starts) {
    const auto path = detail::relaxed(surface, detail::resampled(surface, start, options.nodes));
    candidates.push_back(detail::shoot(surface, detail::resampled(surface, path, options.nodes), options));
  }
  const auto rank = [](const GeodesicDistance& d) { return std::pair(!d.converged, d.converged ? d.length : d.miss); };
  GeodesicDistance best = *std::min_element(candidates.begin(), candidates.end(),
                                            [&](const auto& x, const auto& y) { return rank(x) < rank(y); });
  best.found = static_cast<int>(
      std::count_if(candidates.begin(), candidates.end(), [](const GeodesicDistance& d) { return d.converged; }));
  best.path = geodesic(surface, a, best.path.tangents.col(0), best.length, options.path);
  return best;
}

}  // namespace dsns
