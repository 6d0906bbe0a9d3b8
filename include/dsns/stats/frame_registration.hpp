#pragma once
/// Frames that do not share their triangles, such as scans, as one moving mesh: each is mapped to the sphere by itself, and registered
/// to the one before it.
///
///   const FrameRegistration r = register_frames(meshes, seconds);
///   r.sequence;                                                      // on the triangles of the first
#include <dsns/mesh/spherical_parameterization.hpp>
#include <dsns/stats/co_registration.hpp>
#include <dsns/surface/any_surface.hpp>
#include <dsns/surface/sampled.hpp>

namespace dsns {

/// Bodies move little from one frame to the next, so that they stand alike.
struct FrameRegistrationOptions {
  SpatialOptions spatial;  ///< its search is upright whatever it says
  ParameterizationOptions parameterization;
};

struct FrameRegistration {
  MeshSequence sequence;               ///< all frames on the triangles of the first
  Mat3X sphere;                        ///< of its vertices
  std::vector<SpatialSummary> frames;  ///< of each but the first, against the one before it
};

namespace detail {

struct MappedFrame {
  AnyAnimatedSurface surface;
  Mat3X sphere;
};
inline MappedFrame mapped_frame(const TriangleMesh& mesh, const ParameterizationOptions& options) {
  MeshSequence still;
  still.frames = {mesh.vertices};
  still.faces = mesh.faces;
  Mat3X sphere = spherical_parameterization(still, options).sphere;
  AnyAnimatedSurface surface(SampledSurface(std::move(still), sphere));
  return {std::move(surface), std::move(sphere)};
}

}  // namespace detail

/// meshes   closed, of genus 0
/// accuracy of a body of three limbs that moves by 2.8 % of its size, each frame on triangles of its own, points of the third frame
///          are 1.4 % of the size from the truth in the root mean square [stats/frame_registration_test]
/// throws   InvalidArgument without meshes; UnusableMesh where one cannot be mapped
inline FrameRegistration register_frames(const std::vector<TriangleMesh>& meshes, double duration,
                                         const FrameRegistrationOptions& options = {}, const Progress& progress = {}) {
  require(!meshes.empty(), "register_frames: no meshes, give at least one");
  RegistrationOptions one_time;
  one_time.spatial = options.spatial;
  one_time.spatial.search = RotationSearch::upright;
  one_time.spatial_times = 1;
  FrameRegistration out;
  out.sequence.faces = meshes.front().faces;
  out.sequence.duration = duration;
  detail::MappedFrame former = detail::mapped_frame(meshes.front(), options.parameterization);
  out.sphere = former.sphere;
  out.sequence.frames = {meshes.front().vertices};
  Mat3X images = former.sphere;  // of the first frame's vertices, on the sphere of the frame reached
  for (std::size_t k = 1; k < meshes.size(); ++k) {
    report(progress, "frame to frame", double(k) / double(meshes.size()));
    detail::MappedFrame next = detail::mapped_frame(meshes[k], options.parameterization);
    SpatialResult step = register_in_space(former.surface, next.surface, one_time);
    images = step.gamma(images);
    out.sequence.frames.push_back(positions(next.surface, images, 0.0));
    out.frames.push_back(std::move(step.summary));
    former = std::move(next);
  }
  return out;
}

}  // namespace dsns
