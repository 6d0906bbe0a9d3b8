#pragma once
/// Taking place and size out of a sequence, and putting them back. A walk's translation is most of its variance in time and
/// would drown the shape, so the area centroid of every frame goes to the origin and is kept as a trajectory; one scale for
/// the whole sequence makes the mean area 1.
#include <dsns/mesh/triangle_mesh.hpp>

namespace dsns {

struct NormalizedSequence {
  MeshSequence sequence;
  Mat3X trajectory;  ///< centroid of each frame of the input, 3 x frames, in the input's unit
  double scale = 1;  ///< input length = scale * normalised length
};

/// Faces that close holes have no weight.
/// throws   UnusableMesh where a frame has no area
inline NormalizedSequence normalize(const MeshSequence& input) {
  NormalizedSequence out{input, Mat3X(3, input.frame_count()), 1};
  const Faces surface = input.faces.leftCols(input.faces.cols() - input.cap_faces);
  double mean_area = 0;
  for (int k = 0; k < input.frame_count(); ++k) {
    Mat3X& x = out.sequence.frames[std::size_t(k)];
    const Eigen::VectorXd areas = vertex_areas(x, surface);
    const double total = areas.sum();
    require<UnusableMesh>(total > 0 && std::isfinite(total), input.name, ": frame ", k, " has an area of ", total,
                          ", the surface must have positive area at all times");
    out.trajectory.col(k) = x * areas / total;
    x.colwise() -= Vec3d(out.trajectory.col(k));
    mean_area += total / input.frame_count();
  }
  out.scale = std::sqrt(mean_area);
  for (auto& x : out.sequence.frames) x /= out.scale;
  return out;
}

}  // namespace dsns
