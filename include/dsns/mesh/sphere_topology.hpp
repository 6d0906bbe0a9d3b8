#pragma once
/// Is a triangulation one closed surface of genus 0? The sphere map exists for these and no others.
#include <dsns/mesh/diagnosis.hpp>

namespace dsns {

/// Passes exactly the triangulations of a sphere:
/// closed, oriented alike, manifold, one piece, genus 0, no vertex unused.
/// throws   UnusableMesh with one sentence on what is wrong [mesh/spherical_parameterization_test]
///          InvalidArgument where a face names a vertex that does not exist
inline void require_sphere_topology(const Faces& faces, Index vertex_count) {
  const MeshDiagnosis found = diagnose(faces, vertex_count);
  const auto check = [](bool ok, const auto&... what) {
    require<UnusableMesh>(ok, "a sphere map needs one closed surface without handles, but the mesh has ", what...);
  };
  check(found.faces >= 4, found.faces, " faces");
  check(found.vertices == vertex_count, vertex_count - found.vertices, " vertices without a face: drop them");
  check(found.nonmanifold_edges == 0, found.nonmanifold_edges, " edges with more than two faces: repair it");
  check(found.boundary_edges == 0, found.boundary_loops, " holes (", found.boundary_edges,
        " edges with one face): repair closes them");
  check(found.components == 1, found.components, " pieces: keep one");
  check(found.consistently_oriented, "neighbouring faces that are oriented differently: repair turns them");
  check(found.nonmanifold_vertices == 0, found.nonmanifold_vertices, " vertices where two sheets touch: split them");
  check(found.genus == 0, found.genus.value_or(-1), " handles: cut them");
}

}  // namespace dsns
