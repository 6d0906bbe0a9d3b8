#pragma once
/// A moving mesh as a moving surface F(s, t): linear on its triangles, a cubic spline in time.
#include <dsns/core/spline.hpp>
#include <dsns/mesh/sphere_location.hpp>
#include <dsns/mesh/triangle_mesh.hpp>
#include <dsns/surface/jets.hpp>

#include <utility>
#include <vector>

namespace dsns {

/// F(s, t) = sum_k b_k(s) x_k(t) with b the barycentrics of s in its triangle (central projection), x_k(t) the spline
/// through the frames. Continuous in s and smooth inside a triangle; twice continuously differentiable in t.
/// Many queries at the same points: locate() them once and pass the hits.
///
///   const SampledSurface body(sequence, spherical_parameterization(sequence).sphere);
///   const auto hits = body.locate(s);                       // s: 3 x n unit vectors
///   const Mat3X x = body.positions(hits, 0.5), v = body.velocities(hits, 0.5);
///
/// accuracy  its own vertices at its own frames 1e-12, linear fields and cubics in time exact, jets against central
///           differences 1e-7, interpolated normals of the sphere 1e-12 at its vertices [surface/sampled_test]
class SampledSurface {
 public:
  using Hits = std::vector<SphereHit>;

  /// sphere   3 x n, the images of the vertices on the unit sphere
  /// throws   InvalidArgument where sizes differ, UnusableMesh where the sphere map is not one to one
  SampledSurface(const MeshSequence& sequence, const Mat3X& sphere)
      : SampledSurface(sequence, sphere, equidistant_times(sequence.frame_count())) {}
  /// times    of the frames, increasing, for frames that are not equidistant
  SampledSurface(const MeshSequence& sequence, const Mat3X& sphere, std::vector<double> times)
      : location_(sphere, sequence.faces),
        spline_(std::move(times)),
        frames_(3 * sphere.cols(), sequence.frame_count()),
        own_faces_(sequence.faces.cols() - sequence.cap_faces) {
    require(spline_.knots() == frames_.cols(), "SampledSurface: ", spline_.knots(), " times for ", frames_.cols(),
            " frames");
    for (Index k = 0; k < frames_.cols(); ++k) {
      const Mat3X& frame = sequence.frames[static_cast<std::size_t>(k)];
      require(frame.cols() == sphere.cols(), "SampledSurface: frame ", k, " has ", frame.cols(),
              " vertices, the sphere map ", sphere.cols());
      frames_.col(k) = frame.reshaped();
    }
  }

  const SphereLocation& location() const { return location_; }
  /// Whether a point lies on a face that closes a hole.
  bool on_cap(const SphereHit& hit) const { return hit.face >= own_faces_; }
  Hits locate(const Mat3X& s) const { return location_.hits(s); }

  Vec3d operator()(const Vec3d& s, double t) const {
    const SphereHit hit = location_(s);
    const Eigen::VectorXd w = spline_.weights(t);
    Vec3d sum = Vec3d::Zero();
    for (int k = 0; k < 3; ++k)
      sum += hit.barycentric[k] * (frames_.middleRows<3>(3 * location_.faces()(k, hit.face)) * w);
    return sum;
  }

  /// F(s, t) at n points, 3 x n. The vertices are blended once a call: O(vertices x frames + n).
  Mat3X positions(const Hits& hits, double t) const { return interpolate(hits, spline_.weights(t)); }
  Mat3X positions(const Mat3X& s, double t) const { return positions(locate(s), t); }

  /// dF/dt at n points, 3 x n, length unit per clip.
  Mat3X velocities(const Hits& hits, double t) const { return interpolate(hits, spline_.derivative_weights(t)); }
  Mat3X velocities(const Mat3X& s, double t) const { return velocities(locate(s), t); }

  /// Unit normals at n points, 3 x n, interpolated as renderers do: the vertices' normals, area-weighted means over their
  /// faces without those that close holes, blended by the barycentrics. Zero where no corner has a face of its own.
  Mat3X normals(const Hits& hits, double t) const {
    const Mat3X of_vertices = vertex_normals(blend(spline_.weights(t)), location_.faces().leftCols(own_faces_));
    Mat3X out = at(hits, of_vertices);
    for (Index i = 0; i < out.cols(); ++i) out.col(i).stableNormalize();
    return out;
  }
  Mat3X normals(const Mat3X& s, double t) const { return normals(locate(s), t); }

  /// The exact 2-jets inside each point's triangle; on an edge those of one side.
  SurfaceJets jets(const ChartBatch& charts, double t) const { return jets(locate(charts.s), charts, t); }
  SurfaceJets jets(const Hits& hits, const ChartBatch& charts, double t) const {
    check(hits, charts);
    const Mat3X vertices = blend(spline_.weights(t));
    SurfaceJets out(charts.size());
    for (Index i = 0; i < charts.size(); ++i) {
      const TriangleJet j = triangle_jet(hits[static_cast<std::size_t>(i)], charts, i, vertices);
      out.f.col(i) = j.f;
      out.fu.col(i) = j.fu;
      out.fv.col(i) = j.fv;
      out.fuu.col(i) = -2 * j.mu * j.fu;
      out.fuv.col(i) = -j.mv * j.fu - j.mu * j.fv;
      out.fvv.col(i) = -2 * j.mv * j.fv;
    }
    return out;
  }

  MotionJets motion_jets(const ChartBatch& charts, double t) const { return motion_jets(locate(charts.s), charts, t); }
  MotionJets motion_jets(const Hits& hits, const ChartBatch& charts, double t) const {
    check(hits, charts);
    const Mat3X vertices = blend(spline_.weights(t)), rates = blend(spline_.derivative_weights(t));
    MotionJets out(charts.size());
    for (Index i = 0; i < charts.size(); ++i) {
      const SphereHit& hit = hits[static_cast<std::size_t>(i)];
      const TriangleJet j = triangle_jet(hit, charts, i, vertices), rate = triangle_jet(hit, charts, i, rates);
      out.f.col(i) = j.f;
      out.fu.col(i) = j.fu;
      out.fv.col(i) = j.fv;
      out.ft.col(i) = rate.f;
      out.ftu.col(i) = rate.fu;
      out.ftv.col(i) = rate.fv;
    }
    return out;
  }

 private:
  Mat3X blend(const Eigen::VectorXd& weights) const {
    Mat3X vertices(3, frames_.rows() / 3);
    vertices.reshaped().noalias() = frames_ * weights;
    return vertices;
  }

  Mat3X interpolate(const Hits& hits, const Eigen::VectorXd& weights) const { return at(hits, blend(weights)); }

  /// A field of the vertices, 3 x n, at points.
  Mat3X at(const Hits& hits, const Mat3X& vertices) const {
    Mat3X out(3, static_cast<Index>(hits.size()));
    for (Index i = 0; i < out.cols(); ++i) {
      const SphereHit& hit = hits[static_cast<std::size_t>(i)];
      out.col(i) = corners(vertices, hit.face) * hit.barycentric;
    }
    return out;
  }

  Mat3 corners(const Mat3X& field, Index face) const {
    Mat3 out;
    for (int k = 0; k < 3; ++k) out.col(k) = field.col(location_.faces()(k, face));
    return out;
  }

  void check(const Hits& hits, const ChartBatch& charts) const {
    require(static_cast<Index>(hits.size()) == charts.size(), "SampledSurface: ", hits.size(), " hits for ",
            charts.size(), " charts");
  }

  /// What is linear on a triangle, in the chart of point i:
  /// F = g / m with g = X P^-1 s and m = 1 . P^-1 s linear in s, so that g_uu = -g, m_uu = -m, g_uv = m_uv = 0 and
  ///   F_u = (g_u - F m_u) / m,   F_uu = -2 F_u m_u / m,   F_uv = -(F_u m_v + F_v m_u) / m.
  struct TriangleJet {
    Vec3d f, fu, fv;
    double mu, mv;  // m_u / m, m_v / m
  };
  TriangleJet triangle_jet(const SphereHit& hit, const ChartBatch& charts, Index i, const Mat3X& vertices) const {
    const Mat3 p = corners(location_.sphere(), hit.face), x = corners(vertices, hit.face);
    const Vec3d a = p.col(0), b = p.col(1), c = p.col(2);
    Mat3 adjugate;  // det(P) P^-1; the determinant cancels
    adjugate << b.cross(c - b).transpose(), c.cross(a - c).transpose(), a.cross(b - a).transpose();
    const Vec3d bu = adjugate * charts.e1.col(i), bv = adjugate * charts.e2.col(i);
    const double m = (adjugate * charts.s.col(i)).sum(), mu = bu.sum() / m, mv = bv.sum() / m;
    const Vec3d f = x * hit.barycentric, origin = x.col(0);
    const Mat3 edges = x.colwise() - origin;  // F - x_0 has the same form, and no large offset
    const Vec3d local = f - origin;
    return {f, edges * bu / m - local * mu, edges * bv / m - local * mv, mu, mv};
  }

  SphereLocation location_;
  CubicSpline spline_;
  Eigen::MatrixXd frames_;  // 3 n x frames
  Index own_faces_;         // the faces before those that close holes
};

static_assert(AnimatedSurface<SampledSurface>);

}  // namespace dsns
