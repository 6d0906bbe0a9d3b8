#include "methods.hpp"
std::vector<Method> ceres_methods() { return {}; }
