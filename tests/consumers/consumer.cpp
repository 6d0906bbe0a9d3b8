// What both consumers build: one call into a module, and the version they were given.
#include <dsns/mesh/sphere_mesh.hpp>
#include <dsns/version.hpp>

#include <cmath>
#include <string_view>

int main() {
  const double area = dsns::area(dsns::icosphere(3));
  const bool right = std::abs(area - 4 * dsns::pi) < 0.1 && std::string_view(dsns::version) == EXPECTED_VERSION;
  return right ? 0 : 1;
}
