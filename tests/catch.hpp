#pragma once
/// Catch2, version 3 or 2: what they share.
#if __has_include(<catch2/catch_all.hpp>)
#include <catch2/catch_all.hpp>
using Catch::Approx;
#else
#include <catch2/catch.hpp>  // brings its own global Approx
#endif

/// Leaves a test case that cannot run here; ctest counts it as skipped, not as passed.
#define DSNS_SKIP(reason)        \
  do {                           \
    WARN("skipped: " << reason); \
    return;                      \
  } while (false)
