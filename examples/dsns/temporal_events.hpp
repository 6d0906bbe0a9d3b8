#pragma once
/// When a body does something that another does too, from its mesh alone.
#include "bodies.hpp"

#include <array>
#include <optional>

namespace dsns::program {

/// Times in [0, 1], or nothing where the body does not do it.
using Landmarks = std::array<std::optional<double>, 2>;

/// Of a body that goes somewhere, strikes of the left and the right foot; of one that opens its jaw, the opening and the
/// closing. y is up.
Landmarks landmarks(const Body& body);

}  // namespace dsns::program
