#pragma once
/// How fairly a sphere map shares the sphere out: what starves of area can be neither sampled nor fitted.
#include <dsns/mesh/spherical_parameterization.hpp>

#include <algorithm>
#include <vector>

namespace dsns {

/// (Share of the sphere) / (share of the surface) of the faces; 1 everywhere keeps areas. Faces that close holes, and
/// those below 2 % of the mean area, have no ratio.
struct AreaRatios {
  double least = 0, percentile_1 = 0, percentile_99 = 0;  ///< against the area of all frames together
  double worst_frame_least = 0;                           ///< the least against any one frame's area
};

namespace detail {

/// Ratios in rising order, with up to `frames` frames as one mesh.
inline std::vector<double> sorted_area_ratios(const MeshSequence& sequence, const Eigen::VectorXd& sphere_areas,
                                              int frames, double cap_share) {
  const Eigen::VectorXd areas = capped_areas(concatenate(sequence, frames), sequence, cap_share);
  const double total = areas.sum();
  const Index kept = areas.size() - sequence.cap_faces;
  const double least = 0.02 * areas.head(kept).mean();
  std::vector<double> ratios;
  for (Index f = 0; f < kept; ++f)
    if (areas[f] > least) ratios.push_back(sphere_areas[f] / (4 * pi) * total / areas[f]);
  std::sort(ratios.begin(), ratios.end());
  return ratios;
}

}  // namespace detail

/// sequence  the one that was mapped, with `sphere`
/// options   those of the map: how many frames shaped it, and what caps may weigh
/// throws    InvalidArgument where sizes differ
inline AreaRatios area_ratios(const MeshSequence& sequence, const Mat3X& sphere,
                              const ParameterizationOptions& options = {}) {
  require(sphere.cols() == sequence.vertex_count(), "area_ratios: ", sphere.cols(), " points of the sphere for ",
          sequence.vertex_count(), " vertices");
  Eigen::VectorXd on_sphere(sequence.faces.cols());
  for (Index f = 0; f < on_sphere.size(); ++f)
    on_sphere[f] = spherical_area(sphere.col(sequence.faces(0, f)), sphere.col(sequence.faces(1, f)),
                                  sphere.col(sequence.faces(2, f)));
  const auto all = detail::sorted_area_ratios(sequence, on_sphere, options.frames, options.cap_share);
  const auto percentile = [&](double p) { return all[static_cast<std::size_t>(p * double(all.size() - 1))]; };
  AreaRatios result{all.front(), percentile(0.01), percentile(0.99), all.front()};
  MeshSequence still;
  still.faces = sequence.faces;
  still.cap_faces = sequence.cap_faces;
  for (const Mat3X& frame : sequence.frames) {
    still.frames = {frame};
    result.worst_frame_least =
        std::min(result.worst_frame_least, detail::sorted_area_ratios(still, on_sphere, 1, options.cap_share).front());
  }
  return result;
}

}  // namespace dsns
