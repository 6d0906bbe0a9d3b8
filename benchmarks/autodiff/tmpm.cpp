// Ours.
#include "methods.hpp"

#include <dsns/autodiff/dual.hpp>
#include <dsns/autodiff/jet2.hpp>




namespace {

using namespace dsns;
using workloads::FirstOrder, workloads::SecondOrder, workloads::SurfacePoints;

Method forward() {
  Method m{"dsns Dual, Jet2"};
  m.first_order = [](const SurfacePoints& p, std::vector<FirstOrder>& out) {
    using D = Dual<double, 3>;
    for (std::size_t i = 0; i < p.size(); ++i) {
      const auto f = workloads::moving_surface(D::variable(p.u[i], 0), D::variable(p.v[i], 1), D::variable(p.t[i], 2));
      for (std::size_t c = 0; c < 3; ++c) {
        out[i].f[c] = f[c].f;
        for (int k=0;k<3;++k) out[i].jacobian[c][k] = f[c].g[k];
      }
    }
  };
  m.second_order = [](const SurfacePoints& p, std::vector<SecondOrder>& out) {
    using J = Jet2<double, 2>;
    for (std::size_t i = 0; i < p.size(); ++i) {
      const auto f = workloads::moving_surface(J::variable(p.u[i], 0), J::variable(p.v[i], 1), p.t[i]);
      for (std::size_t c = 0; c < 3; ++c) {
        out[i].f[c] = f[c].f;
        out[i].f_u[c] = f[c].g[0];
        out[i].f_v[c] = f[c].g[1];
        out[i].f_uu[c] = f[c].h[0];
        out[i].f_uv[c] = f[c].h[1];
        out[i].f_vv[c] = f[c].h[2];
      }
    }
  };
  return m;
}

}  // namespace

std::vector<Method> dsns_methods() { return {forward()}; }
