#include <dsns/core/errors.hpp>

#include <string>
#include <type_traits>

#include "catch.hpp"

namespace errors_test {

using namespace dsns;

TEST_CASE("a message is its parts, one after the other", "[errors]") {
  CHECK(message("integrate: ", 7, " weights for ", 8.5, " points") == "integrate: 7 weights for 8.5 points");
}

TEST_CASE("require throws the asked type with the whole message", "[errors]") {
  CHECK_NOTHROW(require(true, "never built"));
  CHECK_THROWS_AS(require(false, "frames: ", 1), InvalidArgument);
  CHECK_THROWS_AS(require<FileError>(false, "horse.glb is missing"), FileError);
  try {
    require<UnusableMesh>(false, "horse.glb has genus ", 1, ", give a closed surface of genus 0");
    FAIL("require(false) returned");
  } catch (const UnusableMesh& error) {
    CHECK(std::string(error.what()) == "horse.glb has genus 1, give a closed surface of genus 0");
  }
}

TEMPLATE_TEST_CASE("every exception is a dsns::Error and a std::runtime_error", "[errors]", InvalidArgument, FileError,
                   UnusableMesh, DegenerateSurface) {
  STATIC_REQUIRE(std::is_base_of_v<Error, TestType>);
  CHECK_THROWS_AS(require<TestType>(false, "x"), Error);
  CHECK_THROWS_AS(require<TestType>(false, "x"), std::runtime_error);
}

}  // namespace errors_test
