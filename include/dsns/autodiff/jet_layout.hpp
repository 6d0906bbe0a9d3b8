#pragma once
/// Derivatives that ride through a network as further columns: what stands in which columns of a batch.
#include <array>
#include <cstddef>

namespace dsns {

/// A batch of n points has n columns of values, then n for the first derivative in each direction (those of space, then
/// time), then n for each second derivative.
struct JetLayout {
  int firsts = 0;                                ///< directions
  int seconds = 0;                               ///< pairs of directions
  std::array<std::array<int, 2>, 3> pairs = {};  ///< the directions of each second derivative
  int time = -1;                                 ///< which direction is time, -1 if none is

  constexpr int blocks() const { return 1 + firsts + seconds; }
  constexpr int space_directions() const { return time < 0 ? firsts : firsts - 1; }
  /// Whether second derivatives in space are among them.
  constexpr bool bends() const { return seconds > 0 && time < 0; }
};

namespace jet_layouts {
inline constexpr std::array<std::array<int, 2>, 3> in_space = {{{{0, 0}}, {{0, 1}}, {{1, 1}}}};
inline constexpr std::array<std::array<int, 2>, 3> in_space_and_time = {{{{0, 2}}, {{1, 2}}}};
inline constexpr JetLayout value{};                             ///< f
inline constexpr JetLayout rate{1, 0, {}, 0};                   ///< f, f_t
inline constexpr JetLayout tangents{2};                         ///< f, f_u, f_v
inline constexpr JetLayout second{2, 3, in_space};              ///< f, f_u, f_v, f_uu, f_uv, f_vv
inline constexpr JetLayout motion{3, 2, in_space_and_time, 2};  ///< f, f_u, f_v, f_t, f_ut, f_vt
}  // namespace jet_layouts

}  // namespace dsns
