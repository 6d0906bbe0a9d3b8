#include "methods.hpp"
std::vector<Method> eigen_methods() { return {}; }
