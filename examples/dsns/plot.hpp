#pragma once
/// Pictures by gnuplot, where there is one.
#include <filesystem>

namespace dsns::program {

/// Runs gnuplot on a script, in its folder.
/// returns  whether there is a picture now
bool draw(const std::filesystem::path& script);

}  // namespace dsns::program
