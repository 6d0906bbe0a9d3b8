#include "catch.hpp"

#include <dsns/core/natural_order.hpp>

namespace natural_order_test {

using namespace dsns;

TEST_CASE("names are compared as people do", "[core]") {
  using detail::natural_less;
  CHECK(natural_less("f2", "f10"));
  CHECK_FALSE(natural_less("f10", "f2"));
  CHECK(natural_less("f002", "f10"));
  CHECK(natural_less("a1b2", "a1b10"));
  CHECK(natural_less("a", "b"));
  CHECK(natural_less("f", "f0"));
  CHECK(natural_less("f01", "f1") != natural_less("f1", "f01"));  // a strict order needs a winner
  CHECK_FALSE(natural_less("f1", "f1"));
}

}  // namespace natural_order_test
