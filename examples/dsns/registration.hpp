#pragma once
/// Bodies brought into correspondence with one another, as the subcommands do it.
#include "bodies.hpp"

#include <dsns/stats/moving_mean.hpp>

namespace dsns::program {

MovingRegistration register_bodies(const Body& first, const Body& second, const Settings& settings,
                                   const Progress& progress);

/// The mean of bodies with what the sizes and the ways of their roots are in the mean.
struct BodiesMean {
  MovingMean moving;
  Mat3X way;  ///< in units of the scale, one column a frame
  double scale = 0, duration = 0;

  /// Points of a curve in the mean's components, as an animation of the mean's size and way.
  MeshSequence animation(const Eigen::MatrixXd& points, const Faces& faces, const std::string& name) const;
};

/// Says in the report what the registrations and the mean are.
BodiesMean mean_of_bodies(const std::vector<Body>& bodies, const Settings& settings, Report& report);

}  // namespace dsns::program
