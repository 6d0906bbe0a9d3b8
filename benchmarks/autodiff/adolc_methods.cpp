#include "methods.hpp"
std::vector<Method> adolc_methods() { return {}; }
