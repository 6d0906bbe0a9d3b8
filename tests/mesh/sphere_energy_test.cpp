#include <dsns/mesh/sphere_energy.hpp>

#include <cmath>

#include "catch.hpp"

namespace sphere_energy_test {

using namespace dsns;

TEST_CASE("the energy's derivatives are those of its value", "[sphere_energy]") {
  const Vec3d p = Vec3d(0.2, 0.1, 1).normalized(), b = Vec3d(1, 0.2, 0.4).normalized();
  const detail::MovingFace face{p, b, Vec3d(-0.1, 1, 0.3).normalized(), Vec3d(0.4, 0.9, 0.3), 0.02};
  detail::TangentModel model(p);
  model.add(face);
  CHECK(model.energy == Approx(face.energy()));
  const auto at = [&](double u, double v) {
    detail::MovingFace moved = face;
    const Vec3d step = u * model.e1 + v * model.e2;
    if (step.norm() > 0) moved.p = std::cos(step.norm()) * p + std::sin(step.norm()) * step.normalized();
    return moved.energy();
  };
  const double h = 1e-4;
  CHECK(model.gradient[0] == Approx((at(h, 0) - at(-h, 0)) / (2 * h)).epsilon(1e-6));
  CHECK(model.gradient[1] == Approx((at(0, h) - at(0, -h)) / (2 * h)).epsilon(1e-6));
  CHECK(model.hessian(0, 0) == Approx((at(h, 0) - 2 * at(0, 0) + at(-h, 0)) / (h * h)).epsilon(1e-5));
  CHECK(model.hessian(1, 1) == Approx((at(0, h) - 2 * at(0, 0) + at(0, -h)) / (h * h)).epsilon(1e-5));
  CHECK(model.hessian(0, 1) == Approx((at(h, h) - at(h, -h) - at(-h, h) + at(-h, -h)) / (4 * h * h)).epsilon(1e-5));
}

}  // namespace sphere_energy_test
