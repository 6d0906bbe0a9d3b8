#pragma once
/// Several moving bodies in one GLB, side by side, coloured by correspondence.
#include "bodies.hpp"

#include <filesystem>

namespace dsns::program {

class Scene {
 public:
  /// `colors` 3 x n in [0, 1], or nothing for grey.
  void add(MeshSequence body, Mat3X colors = Mat3X(3, 0));
  /// Spreads the bodies along x, or along z where they move along x, and writes the file.
  void write(const std::filesystem::path& path) const;

 private:
  std::vector<MeshSequence> bodies_;
  std::vector<Mat3X> colors_;
};

/// A colour for each point: where it lies in the box of all, as red, green and blue.
Mat3X position_colors(const Mat3X& points);
/// A colour for each point of the sphere: where it lies on the body at the first time, as red, green and blue. The same
/// colour on two bodies is the same point of the sphere.
Mat3X place_colors(const Body& body, const Mat3X& sphere);

}  // namespace dsns::program
