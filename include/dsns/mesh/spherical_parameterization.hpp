#pragma once
/// A closed genus-0 mesh, or a moving one, laid out on the unit sphere: one to one, certified, one map for all frames,
/// triangles similar in shape and in share of the area.
///
///   const ParameterizationResult map = spherical_parameterization(sequence);
///   const SampledSurface surface(sequence, map.sphere);   // F(s, t)
///
/// Half-edge collapses down to a tetrahedron, vertices put back in reverse, Newton steps on a shape and area energy at
/// every doubling (the headers included here say how). Area counts: a limb starved of it cannot be sampled or fitted.
#include <dsns/core/progress.hpp>
#include <dsns/mesh/collapse_hierarchy.hpp>
#include <dsns/mesh/sphere_embedding.hpp>

namespace dsns {

struct ParameterizationOptions {
  int frames = 8;                      ///< at most so many equidistant frames shape the map
  double mass_floor = 0.01;            ///< share of the sphere spread evenly over the faces, so that none vanishes
  double cap_share = 0.1;              ///< at most this share of the surface's area for the faces that close its holes
  double coarse_regularization = 1;    ///< of the cotangents while vertices return
  double final_regularization = 0.01;  ///< and at the end
  int level_sweeps = 40;               ///< at every doubling of the vertex count, at most
  int final_sweeps = 20;               ///< at most
  double tolerance = 1e-4;             ///< sweeps stop where (energy before - after) < tolerance * energy before
};

/// The result's energy is that of mesh/sphere_energy.hpp: 2 for a similar map that keeps areas.
struct ParameterizationResult {
  Mat3X sphere;                      ///< 3 x n unit vectors
  SphereMapCertificate certificate;  ///< its ratio is against the faces' masses, as `masses`
  Eigen::VectorXd masses;            ///< share of the sphere each face was given to aim at, sum 1
  std::vector<double> energy;        ///< before the final sweeps and after each
  bool converged = false;            ///< the final sweeps ended by the tolerance
};

namespace detail {

/// Up to `count` equidistant frames, each centred, in units of the largest coordinate.
inline ConcatenatedFrames concatenate(const MeshSequence& sequence, int count) {
  const int used = std::min(count, sequence.frame_count());
  ConcatenatedFrames frames{Eigen::MatrixXd(3 * used, sequence.vertex_count())};
  for (int k = 0; k < used; ++k) {
    const int source = used > 1 ? static_cast<int>(Index(k) * (sequence.frame_count() - 1) / (used - 1)) : 0;
    const Mat3X& vertices = sequence.frames[static_cast<std::size_t>(source)];
    frames.points.middleRows<3>(3 * k) = vertices.colwise() - Vec3d(vertices.rowwise().mean());
  }
  const double size = frames.points.cwiseAbs().maxCoeff();
  require<UnusableMesh>(std::isfinite(size) && size > 0, "the mesh has size ", size,
                        ": it needs finite vertices that are not all in one point");
  frames.points /= size;
  return frames;
}

/// Areas of the faces, those of caps held down.
inline Eigen::VectorXd capped_areas(const ConcatenatedFrames& frames, const MeshSequence& sequence, double cap_share) {
  const Faces& faces = sequence.faces;
  Eigen::VectorXd areas(faces.cols());
  for (Index f = 0; f < faces.cols(); ++f)
    areas[f] = area_from_lengths(frames.squared_lengths(faces(0, f), faces(1, f), faces(2, f)));
  auto caps = areas.tail(sequence.cap_faces);
  const double limit = cap_share * areas.head(faces.cols() - sequence.cap_faces).sum();
  if (caps.sum() > limit) caps *= limit / caps.sum();
  return areas;
}

/// Shares of the faces in the concatenated area plus the floor; then unit area for the frames too.
inline Eigen::VectorXd face_masses(ConcatenatedFrames& frames, const MeshSequence& sequence,
                                   const ParameterizationOptions& options) {
  const Eigen::VectorXd areas = capped_areas(frames, sequence, options.cap_share);
  const double total = areas.sum();
  require<UnusableMesh>(areas.head(areas.size() - sequence.cap_faces).sum() > 1e-7,
                        "the mesh has no area: all its vertices lie on one line");
  frames.points /= std::sqrt(total);
  return ((areas / total).array() + options.mass_floor / double(areas.size())) / (1 + options.mass_floor);
}

inline void require_usable(const MeshSequence& sequence, const ParameterizationOptions& options) {
  require(options.frames >= 1 && options.mass_floor > 0 && options.cap_share > 0 && options.tolerance > 0 &&
              options.final_regularization > 0 && options.coarse_regularization > 0,
          "ParameterizationOptions: frames must be at least 1 and shares, regularizations and tolerance positive");
  require<UnusableMesh>(sequence.frame_count() > 0, "the sequence has no frame");
  for (const Mat3X& frame : sequence.frames) {
    require<UnusableMesh>(frame.cols() == sequence.vertex_count(), "the frames have different numbers of vertices");
    require<UnusableMesh>(frame.allFinite(), "the mesh has a vertex that is not finite");
  }
  require<UnusableMesh>(sequence.cap_faces >= 0 && sequence.cap_faces < sequence.faces.cols(), "the mesh has ",
                        sequence.cap_faces, " cap faces of ", sequence.faces.cols());
  require_sphere_topology(sequence.faces, sequence.vertex_count());
}

}  // namespace detail

/// Maps a closed genus-0 mesh to the sphere.
/// sequence  any number of frames; the concatenated positions of some of them give lengths and areas
/// returns   a bijective map: faces keep their orientation, so counter-clockwise from outside stays so. The same input
///           gives the same bits on one machine. One to two seconds for 10 000 vertices.
/// accuracy  no triangle turned over, exactly [mesh/spherical_parameterization_test: 100:1 ellipsoid, limbs, animals]
/// throws    UnusableMesh where the mesh is not one closed genus-0 surface, or no certified map was found
inline ParameterizationResult spherical_parameterization(const MeshSequence& sequence,
                                                         const ParameterizationOptions& options = {},
                                                         const Progress& progress = {}) {
  detail::require_usable(sequence, options);
  detail::ConcatenatedFrames frames = detail::concatenate(sequence, options.frames);
  ParameterizationResult result;
  result.masses = detail::face_masses(frames, sequence, options);
  detail::CollapsibleMesh mesh(sequence.faces, sequence.vertex_count(), result.masses);
  report(progress, "sphere map", 0);
  std::vector<detail::CollapsibleMesh::Collapse> steps = detail::CollapsePlan(mesh, frames).run();

  detail::SphereEmbedding embedding(mesh, frames, options.coarse_regularization);
  for (Index level = 8; !steps.empty(); steps.pop_back()) {
    embedding.insert(steps.back());
    if (embedding.vertex_count() < level || steps.size() == 1) continue;
    const double before = embedding.energy();
    for (int sweep = 0; sweep < options.level_sweeps; ++sweep)
      if (embedding.relax_all(false) < options.tolerance * before) break;
    level *= 2;
    report(progress, "sphere map", 0.5 * double(embedding.vertex_count()) / double(sequence.vertex_count()));
  }

  embedding.regularize(options.final_regularization);
  result.energy.push_back(embedding.energy());
  for (int sweep = 0; sweep < options.final_sweeps && !result.converged; ++sweep) {
    const double gain = embedding.relax_all(sweep % 2 == 1);
    result.converged = gain < options.tolerance * result.energy.back();
    result.energy.push_back(result.energy.back() - gain);
    report(progress, "sphere map", 0.5 + 0.5 * (sweep + 1) / options.final_sweeps);
  }
  result.sphere = embedding.points();
  result.certificate = certify(result.sphere, sequence.faces, result.masses);
  require<UnusableMesh>(result.certificate.bijective(), "no certified sphere map was found: ", result.certificate.flips,
                        " triangles are turned over and the area misses the sphere's by ",
                        result.certificate.area_defect, "; remove needle triangles or coincident vertices");
  return result;
}

/// The map of one mesh.
inline ParameterizationResult spherical_parameterization(const TriangleMesh& mesh,
                                                         const ParameterizationOptions& options = {},
                                                         const Progress& progress = {}) {
  MeshSequence sequence;
  sequence.frames = {mesh.vertices};
  sequence.faces = mesh.faces;
  return spherical_parameterization(sequence, options, progress);
}

}  // namespace dsns
