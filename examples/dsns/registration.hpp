#pragma once
/// One body brought into correspondence with another, as the subcommands do it.
#include "bodies.hpp"

#include <dsns/stats/co_registration.hpp>

namespace dsns::program {

MovingRegistration register_bodies(const Body& first, const Body& second, const Settings& settings,
                                   const Progress& progress);

}  // namespace dsns::program
