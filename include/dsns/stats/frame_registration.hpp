#pragma once
/// Frames that do not share their triangles, such as scans, as one moving mesh: each is mapped to the sphere by itself, and registered
/// to the one before it, both ways: one way alone drifts further.
///
///   const FrameRegistration r = register_frames(meshes, seconds);
///   r.sequence;                                                      // on the triangles of the first
#include <dsns/elastic/normalization.hpp>
#include <dsns/mesh/sphere_mask.hpp>
#include <dsns/mesh/spherical_parameterization.hpp>
#include <dsns/stats/symmetric_registration.hpp>
#include <dsns/surface/any_surface.hpp>
#include <dsns/surface/sampled.hpp>

namespace dsns {

/// Bodies move little from one frame to the next, so that they stand alike.
struct FrameRegistrationOptions {
  SpatialOptions spatial;  ///< its search is upright and its mask that of the frames, whatever it says
  int views =
      1;  ///< of a step, see SymmetricOptions; 0: of the later frame to the former alone, in a third of the time
  ParameterizationOptions parameterization;
};

struct FrameRegistration {
  MeshSequence sequence;               ///< all frames on the triangles of the first
  Mat3X sphere;                        ///< of its vertices
  std::vector<SpatialSummary> frames;  ///< of each but the first, against the one before it; of bodies of area 1
};

namespace detail {

/// A frame in its own units: its centroid in the origin, its area 1.
struct MappedFrame {
  NormalizedSequence still;
  Mat3X sphere;
  AnyAnimatedSurface surface;

  /// In the units of the file.
  Mat3X positions(const Mat3X& s) const {
    return (still.scale * dsns::positions(surface, s, 0.0)).colwise() + Vec3d(still.trajectory.col(0));
  }
  std::function<Eigen::VectorXd(const Mat3X&)> mask() const {
    if (still.sequence.cap_faces == 0) return {};
    return SphereMask(still.sequence, sphere);
  }
};
inline MappedFrame mapped_frame(const MeshSequence& frame, const ParameterizationOptions& options) {
  require(frame.frame_count() == 1, "register_frames: ", frame.name, " has ", frame.frame_count(),
          " frames, give meshes of one frame");
  NormalizedSequence still = normalize(frame);
  Mat3X sphere = spherical_parameterization(still.sequence, options).sphere;
  AnyAnimatedSurface surface(SampledSurface(still.sequence, sphere));
  return {std::move(still), std::move(sphere), std::move(surface)};
}

}  // namespace detail

/// frames   of one frame each, closed, of genus 0; their caps are left out of what is compared
/// duration of the whole, seconds
/// accuracy of a body of three limbs that moves by 2.8 % of its size, each frame on triangles of its own, points of the third frame
///          are 1.4 % of the size from the truth in the root mean square [stats/frame_registration_test]
/// throws   InvalidArgument without frames; UnusableMesh where one cannot be mapped
inline FrameRegistration register_frames(const std::vector<MeshSequence>& frames, double duration,
                                         const FrameRegistrationOptions& options = {}, const Progress& progress = {}) {
  require(!frames.empty(), "register_frames: no meshes, give at least one");
  SymmetricOptions steps;
  steps.views = options.views;
  steps.registration.spatial = options.spatial;
  steps.registration.spatial.search = RotationSearch::upright;
  steps.registration.spatial_times = 1;
  FrameRegistration out;
  out.sequence = frames.front();
  out.sequence.duration = duration;
  report(progress, "frame to frame", 0);
  detail::MappedFrame former = detail::mapped_frame(frames.front(), options.parameterization);
  out.sphere = former.sphere;
  Mat3X images = former.sphere;  // of the first frame's vertices, on the sphere of the frame reached
  for (std::size_t k = 1; k < frames.size(); ++k) {
    report(progress, "frame to frame", double(k) / double(frames.size()));
    detail::MappedFrame next = detail::mapped_frame(frames[k], options.parameterization);
    steps.registration.spatial.mask = former.mask();
    steps.second_mask = next.mask();
    SpatialResult step = options.views > 0 ? register_symmetrically(former.surface, next.surface, steps).there
                                           : register_in_space(former.surface, next.surface, steps.registration);
    images = step.gamma(images);
    out.sequence.frames.push_back(next.positions(images));
    out.frames.push_back(std::move(step.summary));
    former = std::move(next);
  }
  return out;
}

/// The same of meshes without caps.
inline FrameRegistration register_frames(const std::vector<TriangleMesh>& meshes, double duration,
                                         const FrameRegistrationOptions& options = {}, const Progress& progress = {}) {
  std::vector<MeshSequence> frames;
  for (const TriangleMesh& mesh : meshes) {
    MeshSequence& frame = frames.emplace_back();
    frame.frames = {mesh.vertices};
    frame.faces = mesh.faces;
  }
  return register_frames(frames, duration, options, progress);
}

}  // namespace dsns
