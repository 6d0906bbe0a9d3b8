#pragma once
/// A body as matching sees it: a moving mesh with its sphere map, lengths and areas averaged over the frames, in units in
/// which the mean area is 1.
#include <dsns/mesh/sampling.hpp>
#include <dsns/mesh/sphere_location.hpp>
#include <dsns/mesh/sphere_mesh.hpp>
#include <dsns/surface/jets.hpp>

namespace dsns {

/// Averages over the frames are of lengths, not of positions: the metric of a limb that swings is that of the limb, whatever
/// the pose. A mean of lengths obeys the triangle inequality, as each frame does.
class MatchingBody {
 public:
  using Hits = std::vector<SphereHit>;

  /// sphere   3 x n, the images of the vertices on the unit sphere
  /// throws   UnusableMesh where the sphere map is not one to one or the surface has no area
  MatchingBody(MeshSequence sequence, const Mat3X& sphere)
      : sequence_(std::move(sequence)),
        location_(sphere, sequence_.faces),
        masses_(Eigen::VectorXd::Zero(sphere.cols())),
        edge_lengths_(Mat3X::Zero(3, sequence_.faces.cols())) {
    require(sequence_.frame_count() >= 1 && sequence_.vertex_count() == sphere.cols(),
            "MatchingBody: ", sequence_.frame_count(), " frames of ", sequence_.vertex_count(),
            " vertices, the sphere map has ", sphere.cols());
    const Faces surface = sequence_.faces.leftCols(sequence_.faces.cols() - sequence_.cap_faces);
    const double share = 1.0 / sequence_.frame_count();
    for (const Mat3X& x : sequence_.frames) {
      masses_ += share * vertex_areas(x, surface);
      for (Index f = 0; f < faces().cols(); ++f)
        for (int k = 0; k < 3; ++k)
          edge_lengths_(k, f) += share * (x.col(faces()((k + 1) % 3, f)) - x.col(faces()((k + 2) % 3, f))).norm();
    }
    const double area = masses_.sum();
    require<UnusableMesh>(area > 0 && std::isfinite(area), "MatchingBody: the surface's mean area is ", area,
                          ", it must be positive");
    masses_ /= area;
    edge_lengths_ /= std::sqrt(area);
  }

  const MeshSequence& sequence() const { return sequence_; }
  const SphereLocation& location() const { return location_; }
  const Mat3X& sphere() const { return location_.sphere(); }
  const Faces& faces() const { return location_.faces(); }
  Index vertex_count() const { return masses_.size(); }
  /// A third of the area around each vertex, sum 1; faces that close holes have none.
  const Eigen::VectorXd& masses() const { return masses_; }
  /// Of the edge opposite to corner k of each face, 3 x m.
  const Mat3X& edge_lengths() const { return edge_lengths_; }

  /// n points of the sphere spread by the surface's area, none on faces that close holes.
  Mat3X sample(int n, std::uint64_t seed) const {
    std::mt19937_64 random(seed);
    return sample_faces(sequence_, sphere(), n, random);
  }

  /// Functions of the vertices, a column each, at points of the sphere: a row for each point.
  Eigen::MatrixXd interpolate(const Eigen::MatrixXd& functions, const Hits& hits) const {
    require(functions.rows() == vertex_count(), "MatchingBody: functions with ", functions.rows(), " values on ",
            vertex_count(), " vertices");
    Eigen::MatrixXd out(static_cast<Index>(hits.size()), functions.cols());
    for (Index i = 0; i < out.rows(); ++i) {
      const SphereHit& hit = hits[std::size_t(i)];
      const Eigen::Vector3i corner = faces().col(hit.face);
      out.row(i) = hit.barycentric[0] * functions.row(corner[0]) + hit.barycentric[1] * functions.row(corner[1]) +
                   hit.barycentric[2] * functions.row(corner[2]);
    }
    return out;
  }

  /// Area on the surface that stands for each of n points of a mesh of the sphere, sum 1: the weights of sums over them.
  Eigen::VectorXd area_weights(const TriangleMesh& grid) const {
    const Eigen::VectorXd density = masses_.cwiseQuotient(vertex_areas(sphere(), faces()));
    const Eigen::VectorXd weights =
        interpolate(density, location_.hits(grid.vertices)).cwiseProduct(vertex_areas(grid.vertices, grid.faces));
    return weights / weights.sum();
  }

 private:
  MeshSequence sequence_;
  SphereLocation location_;
  Eigen::VectorXd masses_;
  Mat3X edge_lengths_;
};

/// A surface of any kind, sampled on an icosphere; a moving one at `frames` equidistant times.
/// level    5: 10 242 vertices
template <AnimatedSurface F>
MatchingBody matching_body(const F& surface, int level = 5, int frames = 8) {
  const TriangleMesh sphere = icosphere(level);
  return {sequence_of(surface, sphere, frames), sphere.vertices};
}
template <Surface S>
MatchingBody matching_body(const S& surface, int level = 5) {
  const TriangleMesh sphere = icosphere(level);
  MeshSequence sequence;
  sequence.faces = sphere.faces;
  sequence.frames = {positions(surface, sphere.vertices)};
  return {std::move(sequence), sphere.vertices};
}

}  // namespace dsns
