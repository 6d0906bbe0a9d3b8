// Known warps of bodies from formulas, found again: known_warps [COUNT], 1 without it. Ellipsoids with six bumps, any turns of
// body and sphere, warps of degree 6 and up to 10 degrees rms or of degree 3 and 13 to 24 degrees.
#include <dsns/elastic/known_warp.hpp>
#include <dsns/elastic/registered_surface.hpp>
#include <dsns/surface/analytic.hpp>

#include <ctime>
#include <iostream>

using namespace dsns;

namespace {

LimbedBody random_body(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> normal;
  const auto direction = [&] { return Vec3d(normal(random), normal(random), normal(random)).normalized(); };
  LimbedBody body;
  body.axes = Vec3d(1, 0.6 + 0.3 * uniform(random), 0.5 + 0.3 * uniform(random));
  for (int k = 0; k < 6; ++k) {
    const Vec3d where = direction();
    body.limbs.push_back({where, 4 + 6 * uniform(random), (0.3 + 0.5 * uniform(random)) * (where + 0.3 * direction())});
  }
  return body;
}

}  // namespace

int main(int argc, char** argv) {
  const int count = argc > 1 ? std::max(1, std::atoi(argv[1])) : 1;
  constexpr double degree = pi / 180;
  int failures = 0;
  for (const bool large : {false, true}) {
    int good = 0;
    for (int seed = 0; seed < count; ++seed) {
      const double share = count > 1 ? double(seed) / (count - 1) : 0.0;
      const double size = large ? 13 + 11 * share : 4 + 6 * share, allowed = large ? 0.15 : 0.1;
      const LimbedBody body = random_body(std::uint64_t(seed));
      try {
        const KnownWarp truth = known_warp(std::uint64_t(seed), large ? 3 : 6, size * degree);
        const RegisteredSurface moved(body, truth.rotation, truth.gamma);
        const std::clock_t begin = std::clock();
        const SpatialResult r = register_spatially(at_time(moved, 0.0), at_time(body, 0.0));
        const double seconds = double(std::clock() - begin) / CLOCKS_PER_SEC;
        const WarpRecovery w = recovery(truth, r.rotation, r.gamma);
        const double ratio = r.summary.energy_after / r.summary.energy_before;
        const bool found = w.missed <= allowed * degree && w.min_jacobian > 0 && (large || ratio <= 2e-4);
        good += found ? 1 : 0;
        std::cout << "seed " << seed << ": warped by " << size << " degrees, missed by " << w.missed / degree
                  << ", energy ratio " << ratio << ", " << seconds << " CPU-seconds"
                  << (found ? "\n" : ", not found\n");
      } catch (const Error& folds) {  // no such warp of this seed
        std::cout << "seed " << seed << ": " << folds.what() << '\n';
        ++good;
      }
    }
    std::cout << good << " of " << count << (large ? " large ones of degree 3\n" : " of degree 6\n");
    failures += count - good;
  }
  return failures == 0 ? 0 : 1;
}
