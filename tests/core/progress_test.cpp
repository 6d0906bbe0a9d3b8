#include <dsns/core/progress.hpp>

#include <string>

#include "catch.hpp"

namespace progress_test {

TEST_CASE("progress reaches the callback and an empty one is skipped", "[progress]") {
  std::string heard;
  dsns::report([&](std::string_view stage, double fraction) { heard = std::string(stage) + std::to_string(fraction); },
               "fit", 0.5);
  CHECK(heard == "fit0.500000");
  CHECK_NOTHROW(dsns::report({}, "fit", 1));
}

}  // namespace progress_test
