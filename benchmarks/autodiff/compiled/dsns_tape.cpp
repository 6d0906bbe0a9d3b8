// Compiled by the benchmark, for the time that it takes.
#include "../workloads.hpp"

#include <dsns/autodiff/tape.hpp>

using V = dsns::Var<double>;
std::array<V, 3> surface(const V& u, const V& v, const V& t) { return workloads::moving_surface(u, v, t); }
