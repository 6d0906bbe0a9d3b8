// expect: use select\(condition, a, b\)
#include <dsns/autodiff/batch.hpp>
#include <dsns/autodiff/dual.hpp>

double f(const dsns::Dual<dsns::Batch<double, 2>, 1>& x) { return x < 0 ? 1 : 2; }
