#pragma once

#define DSNS_VERSION_MAJOR 0
#define DSNS_VERSION_MINOR 1
#define DSNS_VERSION_PATCH 0

namespace dsns {

inline constexpr const char* version = "0.1.0";

}  // namespace dsns
