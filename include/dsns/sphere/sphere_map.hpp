#pragma once
/// What algorithms ask of a diffeomorphism of the sphere, whatever its model: SphereDiffeomorphism (smooth) or
/// PiecewiseLinearDiffeomorphism (on a triangulation, <dsns/mesh/piecewise_linear_diffeomorphism.hpp>).
#include <dsns/sphere/diffeomorphism.hpp>

#include <concepts>

namespace dsns {

/// The map as it is at "time" t between the identity and gamma: a rotation by the t-th part of gamma's, then all increments
/// scaled by t.
/// throws   InvalidArgument unless 0 <= t <= 1; Error where the map folds on the way
inline SphereDiffeomorphism interpolated(const SphereDiffeomorphism& gamma, double t) {
  require(t >= 0 && t <= 1, "interpolated: t is ", t, ", give one from 0 to 1");
  SphereDiffeomorphism between(rotation_exp(t * rotation_log(gamma.rotation())));
  for (const SphereVectorField& v : gamma.increments()) between.append({v.degree, t * v.a, t * v.b, v.step});
  const DiffeomorphismCertificate certificate = certify(between);
  require<Error>(certificate.holds(), "interpolated: at t = ", t, " the map folds, its Jacobian falls to ",
                 certificate.min_jacobian, ": compose it of smaller increments");
  return between;
}

/// Sends unit vectors to unit vectors one to one; knows its differential, its inverse, the proof that it is a diffeomorphism,
/// and a path of diffeomorphisms to it from the identity.
template <class G>
concept SphereMap = requires(const G& gamma, const Vec3d& s, const Mat3X& points, const ChartBatch& charts, double t) {
  { gamma(s) } -> std::same_as<Vec3d>;
  { gamma(points) } -> std::same_as<Mat3X>;
  { gamma.displacement(charts) } -> std::same_as<SphereDisplacement>;
  { gamma.inverse(points) } -> std::same_as<Mat3X>;
  { certify(gamma) } -> std::same_as<DiffeomorphismCertificate>;
  { interpolated(gamma, t) } -> std::same_as<G>;
};
static_assert(SphereMap<SphereDiffeomorphism>);

/// The smallest Jacobian at unit columns that nothing else has seen: a check apart from a model's own certificate.
template <SphereMap G>
double min_jacobian(const G& gamma, const Mat3X& points) {
  return gamma.displacement(charts_at(points)).J.minCoeff();
}

/// Angles between two sets of unit vectors, radians.
struct AngularDistance {
  double rms = 0, largest = 0;
};

/// a, b     3 x n unit columns; weights n of any common factor; where all are 0, so is the root mean square
inline AngularDistance angular_distance(const Mat3X& a, const Mat3X& b, const Eigen::VectorXd& weights) {
  require(a.cols() == b.cols() && a.cols() == weights.size(), "angular_distance: ", a.cols(), " points against ",
          b.cols(), " with ", weights.size(), " weights");
  AngularDistance out;
  double square = 0;
  for (Index i = 0; i < a.cols(); ++i) {
    const double angle = angle_between(a.col(i), b.col(i));
    square += weights[i] * angle * angle;
    out.largest = std::max(out.largest, angle);
  }
  const double total = weights.sum();
  out.rms = total > 0 ? std::sqrt(square / total) : 0;
  return out;
}

/// How far apart two maps send the same points: over the sphere, by quadrature.
template <SphereMap A, SphereMap B>
AngularDistance angular_distance(const A& a, const B& b, const SphereQuadrature& q) {
  return angular_distance(a(q.points), b(q.points), q.weights);
}

}  // namespace dsns
