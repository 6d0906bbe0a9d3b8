// Compiled by the benchmark, for the time that it takes.
#include "../workloads.hpp"

#include <ceres/jet.h>

using D = ceres::Jet<double, 3>;
std::array<D, 3> surface(const D& u, const D& v, const D& t) { return workloads::moving_surface(u, v, t); }
