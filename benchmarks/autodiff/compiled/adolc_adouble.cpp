// Compiled by the benchmark, for the time that it takes.
#include "../workloads.hpp"

#include <adolc/adouble.h>

std::array<adouble, 3> surface(const adouble& u, const adouble& v, const adouble& t) {
  return workloads::moving_surface(u, v, t);
}
