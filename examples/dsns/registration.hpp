#pragma once
/// Bodies brought into correspondence with one another, as the subcommands do it.
#include "group.hpp"

#include <dsns/stats/moving_mean.hpp>

namespace dsns::program {

/// With a mask where holes of the first body are closed.
RegistrationOptions registration_options(const Body& first, const Settings& settings);
MovingRegistration register_bodies(const Body& first, const Body& second, const Settings& settings,
                                   const Progress& progress, const SphereLandmarks& landmarks = {});
/// What the registration did, and where its figures say that the result is doubtful.
void report_registration(const MovingRegistration& registration, Report& report);
void say_not_written(Report& report, const std::string& option = "-o FILE.glb");
void say_units(Report& report);

/// A body as it is, on its own triangles, with its own motion.
MeshSequence as_represented(const Body& body, int frames);
/// Frames of the body on another's sphere mesh and clock. The sphere's points are moved once for all times.
std::vector<Mat3X> registered_frames(const Body& body, const MovingRegistration& registration, const Mat3X& sphere,
                                     int frames);
/// Where the body's root goes along the registered times, from its place at the first of them; another pass goes on where the
/// last ended.
Mat3X registered_trajectory(const Body& body, const MovingRegistration& registration, int frames);
/// The same as a mesh with size and motion.
MeshSequence registered(const Body& body, const MovingRegistration& registration, const TriangleMesh& sphere,
                        int frames);

/// The mean of a group with what the sizes and the ways of the roots are in the mean.
struct BodiesMean {
  MovingMean moving;
  Body chosen;  ///< the member whose triangles the mean has
  Mat3X way;    ///< in units of the scale, one column a frame
  double scale = 0, duration = 0;

  const Faces& faces() const { return moving.sphere.faces; }
  /// From the mean's sphere to that of the chosen member.
  const SphereDiffeomorphism& of_chosen() const;
  /// On the sphere of the chosen member, which its triangles cover once; moved to the mean's sphere some may turn over where the
  /// map is steep.
  AnyAnimatedSurface surface() const;
  /// A colour for each vertex: where it lies on the chosen member.
  Mat3X colors() const;
  /// Points of a curve in the mean's components, as an animation of the mean's size and way.
  MeshSequence animation(const Eigen::MatrixXd& points, const std::string& name) const;
  /// The mean's own.
  MeshSequence animation(const std::string& name) const;
};

/// Says in the report what the registrations and the mean are.
BodiesMean mean_of_bodies(const Group& group, const Settings& settings, Report& report);

}  // namespace dsns::program
