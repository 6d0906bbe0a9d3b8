// Eigen's forward mode, of its unsupported modules.
#include "methods.hpp"

#include <Eigen/Core>
#include <unsupported/Eigen/AutoDiff>

namespace {

using workloads::FirstOrder, workloads::SecondOrder, workloads::SurfacePoints;

Method scalars() {
  Method m{"Eigen AutoDiffScalar"};
  m.first_order = [](const SurfacePoints& p, std::vector<FirstOrder>& out) {
    using A = Eigen::AutoDiffScalar<Eigen::Vector3d>;
    for (std::size_t i = 0; i < p.size(); ++i) {
      const auto f = workloads::moving_surface(A(p.u[i], 3, 0), A(p.v[i], 3, 1), A(p.t[i], 3, 2));
      for (std::size_t c = 0; c < 3; ++c) {
        out[i].f[c] = f[c].value();
        for (std::size_t k = 0; k < 3; ++k) out[i].jacobian[c][k] = f[c].derivatives()[Eigen::Index(k)];
      }
    }
  };
  return m;
}

}  // namespace

std::vector<Method> eigen_methods() { return {scalars()}; }
