#include <dsns/version.hpp>

#include <string>

#include "catch.hpp"

namespace version_test {

TEST_CASE("the version header says what CMake says", "[version]") {
  CHECK(std::string(dsns::version) == DSNS_PROJECT_VERSION);
  CHECK(std::to_string(DSNS_VERSION_MAJOR) + "." + std::to_string(DSNS_VERSION_MINOR) + "." +
            std::to_string(DSNS_VERSION_PATCH) ==
        dsns::version);
}

}  // namespace version_test
