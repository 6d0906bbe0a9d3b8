#include <dsns/core/types.hpp>

#include <cmath>
#include <type_traits>

#include "catch.hpp"

namespace types_test {

TEST_CASE("points are columns and pi is pi", "[types]") {
  STATIC_REQUIRE(dsns::Mat3X::RowsAtCompileTime == 3);
  STATIC_REQUIRE(dsns::Faces::RowsAtCompileTime == 3);
  STATIC_REQUIRE(std::is_same_v<dsns::Faces::Scalar, int>);
  CHECK(dsns::pi == std::acos(-1.0));
}

}  // namespace types_test
