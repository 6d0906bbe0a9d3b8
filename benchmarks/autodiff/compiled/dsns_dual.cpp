// Compiled by the benchmark, for the time that it takes.
#include "../workloads.hpp"

#include <dsns/autodiff/dual.hpp>

using D = dsns::Dual<double, 3>;
std::array<D, 3> surface(const D& u, const D& v, const D& t) { return workloads::moving_surface(u, v, t); }
