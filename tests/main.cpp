// Only for a Catch2 v2 that comes without its compiled main.
#define CATCH_CONFIG_MAIN
#include "catch.hpp"
