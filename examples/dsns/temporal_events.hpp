#pragma once
/// When a walking body's feet strike the ground, from its mesh alone.
#include "bodies.hpp"

#include <array>
#include <optional>

namespace dsns::program {

/// Times in [0, 1] at which the left and the right foot are farthest ahead of the body, which is when heels strike; none for a
/// foot that is so at the ends of the clip, and for bodies that do not go anywhere. y is up.
/// source   Zeni, Richards, Higginson 2008
std::array<std::optional<double>, 2> foot_strikes(const Body& body);

}  // namespace dsns::program
