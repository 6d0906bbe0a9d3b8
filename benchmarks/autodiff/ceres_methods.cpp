// Ceres' forward mode: Jet, and for second order a Jet of Jets.
#include "methods.hpp"

#ifdef DSNS_WITH_CERES
#include <ceres/jet.h>

namespace {

using workloads::FirstOrder, workloads::SecondOrder, workloads::SurfacePoints;

Method jets() {
  Method m{"Ceres Jet"};
  m.first_order = [](const SurfacePoints& p, std::vector<FirstOrder>& out) {
    using J = ceres::Jet<double, 3>;
    for (std::size_t i = 0; i < p.size(); ++i) {
      const auto f = workloads::moving_surface(J(p.u[i], 0), J(p.v[i], 1), J(p.t[i], 2));
      for (std::size_t c = 0; c < 3; ++c) {
        out[i].f[c] = f[c].a;
        for (std::size_t k = 0; k < 3; ++k) out[i].jacobian[c][k] = f[c].v[Eigen::Index(k)];
      }
    }
  };
  m.second_order = [](const SurfacePoints& p, std::vector<SecondOrder>& out) {
    using J = ceres::Jet<double, 2>;
    using JJ = ceres::Jet<J, 2>;
    const auto variable = [](double x, int k) {
      JJ r(J(x, k));
      r.v[k] = J(1.0);
      return r;
    };
    for (std::size_t i = 0; i < p.size(); ++i) {
      // Ceres does not mix a Jet of Jets with doubles: constants and the time are Jets.
      const auto f = workloads::moving_surface<J>(variable(p.u[i], 0), variable(p.v[i], 1), J(p.t[i]));
      for (std::size_t c = 0; c < 3; ++c) {
        out[i].f[c] = f[c].a.a;
        out[i].f_u[c] = f[c].a.v[0];
        out[i].f_v[c] = f[c].a.v[1];
        out[i].f_uu[c] = f[c].v[0].v[0];
        out[i].f_uv[c] = f[c].v[0].v[1];
        out[i].f_vv[c] = f[c].v[1].v[1];
      }
    }
  };
  return m;
}

}  // namespace

std::vector<Method> ceres_methods() { return {jets()}; }
#else
std::vector<Method> ceres_methods() { return {}; }
#endif
