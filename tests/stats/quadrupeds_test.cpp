#include "catch.hpp"

#include <dsns/elastic/normalization.hpp>
#include <dsns/io/frames.hpp>
#include <dsns/mesh/spherical_parameterization.hpp>
#include <dsns/stats/symmetric_registration.hpp>
#include <dsns/surface/any_surface.hpp>
#include <dsns/surface/sampled.hpp>

#include <filesystem>

namespace quadrupeds_test {

using namespace dsns;
namespace fs = std::filesystem;

namespace {

#ifdef DSNS_TEST_DATA_DIR
const fs::path folder = fs::path(DSNS_TEST_DATA_DIR) / "obj_sequences";
#else
const fs::path folder;
#endif

/// A gallop with its tips, placed by hand: vertices of the snout, the tail, the right and left hind hoof, the right and left front hoof.
struct Animal {
  const char* name;
  std::array<Index, 6> tips;
};
const Animal horse{"Horse_Gallop", {971, 849, 1002, 986, 1007, 992}},
    cow{"Cow_Gallop", {1008, 716, 1074, 1046, 1058, 1030}}, wolf{"Wolf_Gallop", {982, 831, 890, 754, 884, 748}};

struct Mapped {
  Mat3X first_frame, sphere;
  std::array<Index, 6> tips;
  AnyAnimatedSurface surface;
};

Mapped mapped(const Animal& animal) {
  MeshSequence sequence = normalize(read_frames(folder / animal.name)).sequence;
  Mat3X sphere = spherical_parameterization(sequence).sphere;
  Mat3X first = sequence.frames.front();
  AnyAnimatedSurface surface(SampledSurface(std::move(sequence), sphere));
  return {std::move(first), std::move(sphere), animal.tips, std::move(surface)};
}

/// Distances of the tips' images from the second animal's tips, in per cent of its diameter.
std::array<double, 6> missed(const Mapped& a, const Mapped& b, const SphereDiffeomorphism& gamma) {
  const Vec3d centre = (b.first_frame.rowwise().minCoeff() + b.first_frame.rowwise().maxCoeff()) / 2;
  const double diameter = 2 * (b.first_frame.colwise() - centre).colwise().norm().maxCoeff();
  std::array<double, 6> out{};
  for (std::size_t k = 0; k < 6; ++k) {
    const Mat3X image = positions(b.surface, gamma(Mat3X(a.sphere.col(a.tips[k]))), 0.0);
    out[k] = 100 * (image - b.first_frame.col(b.tips[k])).norm() / diameter;
  }
  return out;
}

}  // namespace

TEST_CASE("tips of a galloping horse come near those of a cow and of a wolf", "[stats][data]") {
  if (folder.empty() || !fs::exists(folder)) DSNS_SKIP("DSNS_TEST_DATA_DIR has no OBJ sequences");
  const Mapped first = mapped(horse);
  SymmetricOptions options;
  options.registration.spatial.search = RotationSearch::upright;
  options.registration.spatial_times = 3;
  options.registration.spatial.latitudes = 16;
  options.registration.spatial.refinement = {{10, 12, 0.0, 0.5}};
  for (const Animal& animal : {cow, wolf}) {
    const Mapped second = mapped(animal);
    const SpatialResult r = register_symmetrically(first.surface, second.surface, options).there;
    const std::array<double, 6> errors = missed(first, second, r.gamma),
                                unregistered = missed(first, second, SphereDiffeomorphism());
    double sum = 0, before = 0;
    for (std::size_t k = 0; k < 6; ++k) {
      INFO(animal.name << ", tip " << k << ": " << errors[k] << " %, not registered " << unregistered[k]);
      CHECK(errors[k] < 8);
      sum += errors[k] / 6;
      before += unregistered[k] / 6;
    }
    INFO(animal.name << ": mean " << sum << " %, not registered " << before);
    CHECK(sum < 4);
    CHECK(sum < 0.1 * before);
  }
}

}  // namespace quadrupeds_test
