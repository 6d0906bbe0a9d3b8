#pragma once
/// Diffeomorphisms of the sphere that are linear on each triangle of an icosphere, up to normalisation: the model for maps
/// too uneven for smooth fields. That they are one to one is proven, not sampled.
///
///   const PiecewiseLinearDiffeomorphism gamma(icosphere(5), images);       // throws where the images fold
///   const auto [map, error] = piecewise_linear(smooth, icosphere(5));      // from any other map; what was lost
///
/// Continuous everywhere and smooth inside of triangles, where derivatives are exact; those across edges jump. What needs
/// them continuous, an SRNF, takes smoothed(gamma) of <dsns/sphere/fit_diffeomorphism.hpp>.
#include <dsns/mesh/sphere_location.hpp>
#include <dsns/mesh/sphere_mesh.hpp>
#include <dsns/sphere/sphere_map.hpp>

#include <memory>

namespace dsns {

/// With P the corners of a face and Y their images, gamma(s) = A s / |A s|, A = Y P^-1: normalised barycentric interpolation.
class PiecewiseLinearDiffeomorphism {
 public:
  /// The identity on an icosphere.
  explicit PiecewiseLinearDiffeomorphism(int level = 5) : PiecewiseLinearDiffeomorphism(icosphere(level)) {}
  /// The identity on a triangulation of the sphere.
  explicit PiecewiseLinearDiffeomorphism(const TriangleMesh& sphere)
      : from_(std::make_shared<const SphereLocation>(sphere.vertices, sphere.faces)), to_(from_) {}
  /// images   of the sphere's vertices, unit columns
  /// throws   UnusableMesh where either is not one to one, by the exact certificate
  PiecewiseLinearDiffeomorphism(const TriangleMesh& sphere, Mat3X images)
      : from_(std::make_shared<const SphereLocation>(sphere.vertices, sphere.faces)), to_(located(std::move(images))) {}
  /// Other images of the same vertices, whose triangulation is shared. Throws as above.
  PiecewiseLinearDiffeomorphism with_images(Mat3X images) const { return {from_, located(std::move(images))}; }

  const Mat3X& vertices() const { return from_->sphere(); }
  const Faces& faces() const { return from_->faces(); }
  const Mat3X& images() const { return to_->sphere(); }

  /// gamma(s); T any scalar, derivatives are those inside of the triangle that holds s.
  template <class T>
  Vec3<T> operator()(const Vec3<T>& s) const {
    if constexpr (std::is_same_v<T, double>) {
      return carried(*from_, *to_, s);
    } else {
      using dsns::value, std::sqrt;
      const Mat3 A = linear_part((*from_)(Vec3d(value(s[0]), value(s[1]), value(s[2])).normalized()).face);
      Vec3<T> y;
      for (int k = 0; k < 3; ++k) y[k] = A(k, 0) * s[0] + A(k, 1) * s[1] + A(k, 2) * s[2];
      const T length = sqrt(y[0] * y[0] + y[1] * y[1] + y[2] * y[2]);
      return {y[0] / length, y[1] / length, y[2] / length};
    }
  }

  /// gamma at the unit columns of s, 3 x n.
  /// accuracy of a smooth map sampled on icospheres: falls as the square of the edge [mesh/piecewise_linear_diffeomorphism_test]
  Mat3X operator()(const Mat3X& s) const { return carried(*from_, *to_, s); }

  /// The points that gamma sends to the unit columns of y: located among the images, then back by the same barycentrics.
  /// accuracy 1e-12 radians where Jacobians are 0.1 to 10 [mesh/piecewise_linear_diffeomorphism_test]
  Mat3X inverse(const Mat3X& y) const { return carried(*to_, *from_, y); }
  /// The inverse as a map of its own: linear on the triangulation by the images.
  PiecewiseLinearDiffeomorphism inverse() const { return {to_, from_}; }

  /// gamma at the columns of s with its differential on the charts' frames and its Jacobian:
  ///   d gamma (e) = (1 - y y^T) A e / |A s|,   J = det A / |A s|^3.
  SphereDisplacement displacement(const ChartBatch& charts) const;

  /// A bound that the Jacobian keeps above everywhere on a face, and touches where the faces are small: there |A s| <= 1 / d,
  /// with d the distance of the corners' plane from the centre of the sphere.
  double jacobian_bound(Index face) const {
    const Mat3 P = corners(vertices(), face), Y = corners(images(), face);
    const double det = detail::determinant(P.col(0), P.col(1), P.col(2));
    const double distance = det / (P.col(1) - P.col(0)).cross(P.col(2) - P.col(0)).norm();
    return detail::determinant(Y.col(0), Y.col(1), Y.col(2)) / det * distance * distance * distance;
  }

 private:
  using Location = std::shared_ptr<const SphereLocation>;
  PiecewiseLinearDiffeomorphism(Location from, Location to) : from_(std::move(from)), to_(std::move(to)) {}
  Location located(Mat3X images) const {
    require(images.cols() == vertices().cols(), "PiecewiseLinearDiffeomorphism: ", images.cols(), " images of ",
            vertices().cols(), " vertices");
    return std::make_shared<const SphereLocation>(std::move(images), faces());
  }

  static Vec3d carried(const SphereLocation& from, const SphereLocation& to, const Vec3d& s) {
    const SphereHit hit = from(s);
    return (corners(to.sphere(), hit.face, from.faces()) * hit.barycentric).normalized();
  }
  static Mat3X carried(const SphereLocation& from, const SphereLocation& to, const Mat3X& s) {
    Mat3X y(3, s.cols());
    for (Index i = 0; i < s.cols(); ++i) y.col(i) = carried(from, to, Vec3d(s.col(i)));
    return y;
  }

  static Mat3 corners(const Mat3X& field, Index face, const Faces& faces) {
    Mat3 out;
    for (int k = 0; k < 3; ++k) out.col(k) = field.col(faces(k, face));
    return out;
  }
  Mat3 corners(const Mat3X& field, Index face) const { return corners(field, face, faces()); }
  Mat3 linear_part(Index face) const { return corners(images(), face) * corners(vertices(), face).inverse(); }

  Location from_, to_;
};

inline SphereDisplacement PiecewiseLinearDiffeomorphism::displacement(const ChartBatch& charts) const {
  const Index n = charts.size();
  SphereDisplacement out{Mat3X(3, n), Mat3X(3, n), Mat3X(3, n), Eigen::VectorXd(n)};
  for (Index i = 0; i < n; ++i) {
    const Vec3d s = charts.s.col(i);
    const Mat3 A = linear_part((*from_)(s).face);
    const Vec3d image = A * s;
    const double length = image.norm();
    const Vec3d y = image / length;
    const auto along = [&](const Vec3d& e) -> Vec3d {
      const Vec3d moved = A * e / length;
      return moved - y * y.dot(moved);
    };
    out.y.col(i) = y;
    out.y1.col(i) = along(charts.e1.col(i));
    out.y2.col(i) = along(charts.e2.col(i));
    out.J[i] = A.determinant() / (length * length * length);
    out.longest_step = std::max(out.longest_step, angle_between(s, y));
  }
  return out;
}

/// Proof that gamma is a diffeomorphism: a bound of the Jacobian that holds at every point of all its faces, which are the
/// `points`.
inline DiffeomorphismCertificate certify(const PiecewiseLinearDiffeomorphism& gamma) {
  DiffeomorphismCertificate certificate{std::numeric_limits<double>::infinity(), gamma.faces().cols()};
  for (Index f = 0; f < gamma.faces().cols(); ++f)
    certificate.min_jacobian = std::min(certificate.min_jacobian, gamma.jacobian_bound(f));
  return certificate;
}

/// The map at time t between the identity and gamma: the rotation nearest to gamma grows with t, and each vertex goes from
/// there along its great circle.
/// throws   InvalidArgument unless 0 <= t <= 1; UnusableMesh where the map folds on the way
inline PiecewiseLinearDiffeomorphism interpolated(const PiecewiseLinearDiffeomorphism& gamma, double t) {
  require(t >= 0 && t <= 1, "interpolated: t is ", t, ", give one from 0 to 1");
  const Mat3X& s = gamma.vertices();
  const Eigen::VectorXd areas = vertex_areas(s, gamma.faces());
  const Mat3 R = nearest_rotation(gamma.images() * areas.asDiagonal() * s.transpose());
  const Mat3 turn = rotation_exp(t * rotation_log(R));
  Mat3X y(3, s.cols());
  for (Index i = 0; i < s.cols(); ++i) {
    const Vec3d from = s.col(i), to = R.transpose() * gamma.images().col(i);
    const double angle = angle_between(from, to);
    const Vec3d across = to - from * from.dot(to);
    const Vec3d between = std::cos(t * angle) * from + std::sin(t * angle) * across.stableNormalized();
    y.col(i) = (turn * between).normalized();
  }
  return gamma.with_images(std::move(y));
}

static_assert(SphereMap<PiecewiseLinearDiffeomorphism>);

/// A map sampled on the vertices of a triangulation, and how far it is from its source at the centres of the faces, where
/// linear interpolation misses most.
struct SampledSphereMap {
  PiecewiseLinearDiffeomorphism map;
  AngularDistance error;
};

namespace detail {

template <class Evaluate>
SampledSphereMap sampled_sphere_map(const PiecewiseLinearDiffeomorphism& on, const Evaluate& gamma) {
  PiecewiseLinearDiffeomorphism map = on.with_images(gamma(on.vertices()));
  Mat3X centres(3, on.faces().cols());
  for (Index f = 0; f < centres.cols(); ++f)
    centres.col(f) = (on.vertices().col(on.faces()(0, f)) + on.vertices().col(on.faces()(1, f)) +
                      on.vertices().col(on.faces()(2, f)))
                         .normalized();
  const AngularDistance error =
      angular_distance(map(centres), gamma(centres), face_normals(on.vertices(), on.faces()).colwise().norm());
  return {std::move(map), error};
}

}  // namespace detail

/// gamma on the vertices of a triangulation of the sphere.
/// throws   UnusableMesh where they are too few for gamma: the samples fold
template <SphereMap G>
SampledSphereMap piecewise_linear(const G& gamma, const TriangleMesh& sphere) {
  return detail::sampled_sphere_map(PiecewiseLinearDiffeomorphism(sphere), [&](const Mat3X& s) { return gamma(s); });
}

/// outer(inner(s)) sampled on inner's vertices; of two smooth maps there is an exact composition, compose().
/// throws   UnusableMesh where the samples fold
template <SphereMap Outer>
SampledSphereMap compose(const Outer& outer, const PiecewiseLinearDiffeomorphism& inner) {
  return detail::sampled_sphere_map(inner, [&](const Mat3X& s) { return outer(inner(s)); });
}
/// The same on outer's vertices.
inline SampledSphereMap compose(const PiecewiseLinearDiffeomorphism& outer, const SphereDiffeomorphism& inner) {
  const PiecewiseLinearDiffeomorphism on = outer.with_images(outer.vertices());
  return detail::sampled_sphere_map(on, [&](const Mat3X& s) { return outer(inner(s)); });
}

}  // namespace dsns
