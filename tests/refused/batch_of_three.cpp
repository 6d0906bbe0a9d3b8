// expect: the number of lanes is a power of two
#include <dsns/autodiff/batch.hpp>

dsns::Batch<double, 3> x;
