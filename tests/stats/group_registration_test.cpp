#include "catch.hpp"

#include <dsns/mesh/sphere_mesh.hpp>
#include <dsns/stats/moving_mean.hpp>
#include <dsns/surface/analytic.hpp>
#include <dsns/surface/any_surface.hpp>

#include <map>
#include <utility>

namespace group_registration_test {

using namespace dsns;

namespace {

const LimbedBody& original() {
  static const LimbedBody body = [] {
    LimbedBody b;
    b.axes = 0.3 * Vec3d(1, 0.8, 0.6);
    b.limbs = {{Vec3d(1, 0.3, 0.2).normalized(), 4, 0.3 * Vec3d(0.7, 0.2, 0.1), 0.3 * Vec3d(0, 0.3, 0.1)},
               {Vec3d(-1, 0.5, 0.4).normalized(), 3, 0.3 * Vec3d(-0.5, 0.3, 0.3), 0.3 * Vec3d(0, 0.2, 0.3), 0.3}};
    return b;
  }();
  return body;
}

TimeWarp clock_of(std::size_t i) { return random_warp(i + 1, 0.2); }

std::vector<AnyAnimatedSurface> copies(std::size_t n) {
  std::vector<AnyAnimatedSurface> out;
  for (std::size_t i = 0; i < n; ++i) {
    const Mat3 turn = rotation_exp(0.05 * Vec3d(double(i), 1, -double(i)));
    out.emplace_back(RegisteredSurface(original(), turn, random_diffeomorphism(i + 1, 2, 3 * pi / 180), clock_of(i)));
  }
  return out;
}

MovingMeanOptions fine() {
  MovingMeanOptions o;
  RegistrationOptions& r = o.registration;
  r.spatial.search = RotationSearch::upright;
  r.spatial.levels = {{1, 6, 0.02, 0.5}, {2, 8, 0.0, 0.5}, {4, 10, 0.0, 0.5}};
  r.spatial.refinement = {{6, 12, 0.0, 0.5}};
  r.spatial.latitudes = 14;
  r.spatial.rotations = 50;
  r.spatial.refined = 1;
  r.spatial_times = 2;
  r.temporal.grid = 60;
  r.temporal.cosines = {8, 16};
  r.snapshots = 12;
  r.velocities = 48;
  o.karcher.temporal = r.temporal;
  return o;
}

}  // namespace

TEST_CASE("copies of a motion, warped in space and time, have it as their mean, in whatever order they come",
          "[stats]") {
  const auto surfaces = copies(3);
  const MovingMeanOptions options = fine();
  const TriangleMesh sphere = icosphere(2);
  const auto load = [&](std::size_t i) -> const AnyAnimatedSurface& { return surfaces[i]; };
  const GroupTemplate chosen = choose_template(load, 3);
  std::map<std::string, Archive> kept;
  int writes = 0;
  const ResultStore store{[&](const std::string& name) -> std::optional<Archive> {
                            const auto found = kept.find(name);
                            return found == kept.end() ? std::nullopt : std::optional(found->second);
                          },
                          [&](const std::string& name, const Archive& archive) {
                            ++writes;
                            kept.insert_or_assign(name, archive);
                          }};
  const MovingMean m = mean_of_group(load, chosen, sphere, options, store);
  const GroupSummary& space = m.group.summary;
  const KarcherSummary& time = m.curves.summary;
  for (std::size_t k = 1; k < space.energy.size(); ++k) CHECK(space.energy[k] <= space.energy[k - 1]);
  for (std::size_t k = 1; k < time.energy.size(); ++k) CHECK(time.energy[k] <= time.energy[k - 1]);
  CHECK((space.converged && time.converged));
  CHECK((space.energy.size() <= 11 && time.energy.size() <= 11));
  CHECK(space.energy.back() < 1e-3 * space.energy_unregistered);
  CHECK(time.energy.back() < 1e-3 * time.energy.front());
  CHECK(space.min_jacobian > 0);
  CHECK(space.gauge < 1e-4);

  const std::vector<Mat3X> mean = m.frames(9);
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    const MovingRegistration& r = m.group.members[i];
    const RegisteredSurface back(surfaces[i], r.spatial.rotation, r.spatial.gamma, m.curves.warps[i]);
    double square = 0, size = 0;
    for (std::size_t k = 0; k < mean.size(); ++k) {
      const Mat3X x = positions(back, m.sphere.vertices, double(k) / 8);
      square += (x - mean[k]).squaredNorm();
      size += x.squaredNorm();
    }
    INFO("copy " << i);
    CHECK(std::sqrt(square / size) < 1e-3);
    CHECK(distance(compose(clock_of(i), m.curves.warps[i]), compose(clock_of(0), m.curves.warps[0])) < 1e-3);
  }

  const std::vector<AnyAnimatedSurface> turned{surfaces[2], surfaces[0], surfaces[1]};
  const std::vector<Mat3X> other = mean_of_moving(turned, sphere, options).frames(9);
  for (std::size_t k = 0; k < mean.size(); ++k) CHECK((mean[k] - other[k]).norm() < 1e-6);

  const int registered = std::exchange(writes, 0);
  GroupOptions group;
  group.registration = options.registration;
  const GroupRegistration again = register_group(load, chosen, sphere, group, store);
  CHECK(registered >= 2);
  CHECK(writes == 0);
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK((again.members[i].spatial.rotation - m.group.members[i].spatial.rotation).norm() == 0);
    CHECK(
        (again.members[i].spatial.gamma(sphere.vertices) - m.group.members[i].spatial.gamma(sphere.vertices)).norm() ==
        0);
    CHECK(distance(again.members[i].temporal.warp, m.group.members[i].temporal.warp) == 0);
  }
}

TEST_CASE("the mean of turns about one axis is the turn by their mean angle", "[stats]") {
  const Vec3d axis = Vec3d(1, 2, -1).normalized();
  const std::vector<Mat3> turns{rotation_exp(0.1 * axis), rotation_exp(0.5 * axis), rotation_exp(1.2 * axis)};
  CHECK((karcher_mean(turns) - rotation_exp(0.6 * axis)).norm() < 1e-12);
}

TEST_CASE("maps that share a warp lose it when they are centred, and stay as they are to one another", "[stats]") {
  const SphereDiffeomorphism common = random_diffeomorphism(5, 3, 5 * pi / 180);
  const SphereDiffeomorphism own = random_diffeomorphism(6, 3, 2 * pi / 180), turn(rotation_exp(Vec3d(1, 2, 0.5)));
  const CentredMaps maps = centred({common, compose(own, common), compose(turn, common)});
  CHECK(maps.before > 2.5 * pi / 180);
  CHECK(maps.after < 1e-4);
  const Mat3X s = fibonacci_sphere(200).points;
  CHECK((own(maps.maps[0](s)) - maps.maps[1](s)).norm() < 1e-10);
  CHECK((turn(maps.maps[0](s)) - maps.maps[2](s)).norm() < 1e-10);
}

TEST_CASE("a template and an order are those of the members, not of their order", "[stats]") {
  const std::vector<Eigen::VectorXd> d{Eigen::Vector2d(3, 0), Eigen::Vector2d(1, 1), Eigen::Vector2d(0, 0),
                                       Eigen::Vector2d(1, 0)};
  const GroupTemplate chosen = choose_template(d);
  CHECK(chosen.member == 3);
  CHECK(chosen.order == std::vector<std::size_t>{2, 3, 1, 0});
  const GroupTemplate other = choose_template(std::vector<Eigen::VectorXd>{d[3], d[2], d[0], d[1]});
  CHECK(other.member == 0);
  CHECK(other.order == std::vector<std::size_t>{1, 0, 3, 2});
  // Size and form count, the parametrisation does not.
  const Eigen::VectorXd a = motion_descriptor(original(), 3);
  const RegisteredSurface moved(original(), rotation_exp(Vec3d(1, 2, 3)), random_diffeomorphism(1, 2, 0.1));
  CHECK((motion_descriptor(moved, 3) - a).norm() < 1e-6);
  LimbedBody large = original();
  large.axes *= 1.1;
  CHECK((motion_descriptor(large, 3) - a).norm() > 0.01);
}

TEST_CASE("a damaged registration is refused", "[stats]") {
  Archive archive("kept.dsns");
  store_registration(archive, {});
  CHECK(registration_from(archive).temporal.warp(0.3) == Approx(0.3));
  archive.set("registration.warp", Eigen::MatrixXd(Eigen::MatrixXd::Zero(5, 2)));
  CHECK_THROWS_AS(registration_from(archive), FileError);
  CHECK_THROWS_AS(registration_from(Archive("other.dsns")), FileError);
}

}  // namespace group_registration_test
