// register --spatial-only: in space alone, from a search over rotations or from a correspondence.
#include "evaluations.hpp"
#include "scene.hpp"

#include <dsns/mesh/sphere_mask.hpp>
#if defined(DSNS_WITH_SPECTRA)
#include <dsns/stats/matched_registration.hpp>
#else
#include <dsns/stats/co_registration.hpp>
#endif

namespace dsns::program {

namespace {

#if defined(DSNS_WITH_SPECTRA)
SpatialResult from_correspondence(const Body& a, const Body& b, const RegistrationOptions& options, Report& report,
                                  const Progress& progress) {
  MatchedRegistrationOptions matched;
  matched.registration = options;
  matched.landmarks = options.spatial.landmarks;
  const MatchedRegistration r =
      register_matched(a.surface, MatchingBody(a.normalized.sequence, a.sphere.vertices), b.surface,
                       MatchingBody(b.normalized.sequence, b.sphere.vertices), matched, progress);
  report.figure("correspondence.orientation", "orientation of the correspondence, 1: kept",
                r.correspondence.orientation);
  report.figure("correspondence.refined", "refined in the elastic metric", r.refined);
  return r.spatial;
}
#else
SpatialResult from_correspondence(const Body&, const Body&, const RegistrationOptions&, Report&, const Progress&) {
  fail<Error>(
      "this program was built without Spectra, on which correspondences rest; install it (Debian: libspectra-dev) and "
      "build again, or give --start rotation");
}
#endif

MeshSequence shown(const Body& body, const std::vector<Mat3X>& frames, const Faces& faces) {
  const MeshSequence& own = body.normalized.sequence;
  return denormalize(frames, faces, Mat3X::Zero(3, Index(frames.size())), body.normalized.scale, own.duration,
                     own.name);
}

}  // namespace

SpatialResult register_spatial(const AnyAnimatedSurface& first, const AnyAnimatedSurface& second,
                               const SymmetricOptions& options, const Progress& progress) {
  return options.views > 0 ? register_symmetrically(first, second, options, progress).there
                           : register_in_space(first, second, options.registration, progress);
}

void register_spatial_only(const Body& a, const Body& b, const std::filesystem::path& out, SpatialBeginning beginning,
                           const LandmarkFile& landmarks, const Settings& settings, Report& report) {
  ProgressLine line;
  const BodyLandmarks marks = landmarks_on(landmarks, a, b);
  SymmetricOptions symmetric;
  RegistrationOptions& options = symmetric.registration;
  if (a.normalized.sequence.cap_faces > 0) options.spatial.mask = SphereMask(a.normalized.sequence, a.sphere.vertices);
  if (b.normalized.sequence.cap_faces > 0) symmetric.second_mask = SphereMask(b.normalized.sequence, b.sphere.vertices);
  options.spatial.search = settings.search;
  options.spatial.threads = settings.threads;
  options.spatial.landmarks = marks.used;
  symmetric.views = settings.views;
  symmetric.seed = settings.seed;
  const SpatialResult r = beginning == SpatialBeginning::correspondence
                              ? from_correspondence(a, b, options, report, std::ref(line))
                              : register_spatial(a.surface, b.surface, symmetric, std::ref(line));
  const SpatialSummary& s = r.summary;
  report.figure("spatial.energy_before", "spatial energy before", s.energy_before);
  report.figure("spatial.energy_after", "spatial energy after", s.energy_after);
  report.figure("spatial.norm", "squared norm of the first's field", s.norm);
  report.figure("spatial.min_jacobian", "smallest Jacobian of the sphere map", s.min_jacobian);
  report.figure("spatial.rotation_deg", "rotation of the body, degrees", rotation_angle(r.rotation) * 180 / pi);
  report.figure("spatial.steps", "spatial steps", s.steps);
  report.figure("spatial.stop", "stopped because", s.stop);
  report_landmarks(marks, b, r, report);
  if (out.empty()) return;
  Scene scene;
  const int frames = settings.frames > 0 ? settings.frames : 32;
  const Mat3X colors = place_colors(a, a.sphere.vertices), y = r.gamma(a.sphere.vertices);
  std::vector<Mat3X> registered = frames_of(b.surface, y, frames);
  for (Mat3X& x : registered) x = r.rotation * x;
  scene.add(shown(a, frames_of(a.surface, a.sphere.vertices, frames), a.sphere.faces), colors);
  scene.add(shown(b, frames_of(b.surface, b.sphere.vertices, frames), b.sphere.faces),
            place_colors(a, r.gamma.inverse(b.sphere.vertices)));
  scene.add(shown(b, registered, a.sphere.faces), colors);
  scene.write(out);
  report.say("  Side by side: the first, the second, the second on the first's triangles. Colours correspond.");
  report.wrote("registered", out);
}

}  // namespace dsns::program
