// Curvatures of an ellipsoid: a formula for any scalar is a surface, and its derivatives are exact.
#include <dsns/geometry/integrals.hpp>
#include <iostream>

int main() {
  const auto ellipsoid = [](const auto& s) {
    auto p = s;
    p[1] = 2.0 * s[1];
    p[2] = 3.0 * s[2];
    return p;
  };
  const auto tip = dsns::principal_curvatures(ellipsoid, dsns::Vec3d::UnitZ());  // 3/1 along x, 3/4 along y
  const auto m = dsns::measure(ellipsoid, dsns::sphere_quadrature(40));
  std::cout << "at the tip " << tip.k1[0] << " along " << tip.t1.col(0).transpose() << " and " << tip.k2[0] << " along "
            << tip.t2.col(0).transpose() << "\narea " << m.area << ", volume " << m.volume
            << ", total curvature / 4 pi = " << m.total_curvature / (4 * dsns::pi) << '\n';
}
