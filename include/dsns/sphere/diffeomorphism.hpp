#pragma once
/// Diffeomorphisms of the sphere as gamma = exp(v_n) o ... o exp(v_1) o R: a rotation, then smooth fields. An increment may also
/// be the inverse of such an exponential, so that inverses and compositions are of the same kind.
#include <dsns/sphere/increment.hpp>
#include <dsns/sphere/quadrature.hpp>
#include <dsns/sphere/rotations.hpp>

#include <random>
#include <vector>

namespace dsns {

class SphereDiffeomorphism {
 public:
  /// The identity.
  SphereDiffeomorphism() : SphereDiffeomorphism(Mat3::Identity()) {}
  explicit SphereDiffeomorphism(const Mat3& rotation) : rotation_(rotation) {}

  const Mat3& rotation() const { return rotation_; }
  const std::vector<SphereVectorField>& increments() const { return increments_; }
  /// Composes exp(v) on the left: gamma becomes exp(v) o gamma.
  void append(SphereVectorField v) { increments_.push_back(std::move(v)); }

  /// gamma(s); T any scalar, so derivatives of every order are exact.
  template <class T>
  Vec3<T> operator()(const Vec3<T>& s) const {
    Vec3<T> y;
    for (int k = 0; k < 3; ++k) y[k] = rotation_(k, 0) * s[0] + rotation_(k, 1) * s[1] + rotation_(k, 2) * s[2];
    for (const auto& v : increments_) y = increment(v, y);
    return y;
  }

  /// gamma at the columns of s with its differential on the charts' frames and its Jacobian.
  SphereDisplacement displacement(const ChartBatch& charts) const;

  /// gamma at the unit columns of s, 3 x n.
  Mat3X operator()(const Mat3X& s) const;

  /// The points that gamma sends to the unit columns of y: Newton's method for each increment in turn.
  /// accuracy 1e-12 radians [sphere/diffeomorphism_test]
  /// throws   Error where Newton's method does not converge, which a diffeomorphism with J > 0 does not show
  Mat3X inverse(const Mat3X& y) const;

 private:
  Mat3 rotation_;
  std::vector<SphereVectorField> increments_;
};

inline SphereDisplacement SphereDiffeomorphism::displacement(const ChartBatch& charts) const {
  constexpr Index tile = 64;  // points that go through all increments together, so that their charts stay in cache
  const Index n = charts.size();
  SphereDisplacement total{(rotation_ * charts.s).colwise().normalized(), rotation_ * charts.e1, rotation_ * charts.e2,
                           Eigen::VectorXd::Ones(n)};
  for (Index first = 0; first < n; first += tile) {
    const Index count = std::min(tile, n - first);
    for (const auto& v : increments_) {
      const ChartBatch here = charts_at(total.y.middleCols(first, count));
      const SphereDisplacement step = increment(v, here);
      for (Index i = 0; i < count; ++i)
        for (Mat3X* image : {&total.y1, &total.y2}) {
          const Vec3d t = image->col(first + i);
          image->col(first + i) = here.e1.col(i).dot(t) * step.y1.col(i) + here.e2.col(i).dot(t) * step.y2.col(i);
        }
      total.y.middleCols(first, count) = step.y;
      total.J.segment(first, count).array() *= step.J.array();
      total.longest_step = std::max(total.longest_step, step.longest_step);
    }
  }
  return total;
}

inline Mat3X SphereDiffeomorphism::operator()(const Mat3X& s) const {
  Mat3X y(3, s.cols());
  for (Index i = 0; i < s.cols(); ++i) y.col(i) = (*this)(Vec3d(s.col(i))).normalized();
  return y;
}

inline Mat3X SphereDiffeomorphism::inverse(const Mat3X& y) const {
  Mat3X s = y;
  for (auto v = increments_.rbegin(); v != increments_.rend(); ++v) s = increment_inverse(*v, s);
  return (rotation_.transpose() * s).colwise().normalized();
}

/// The field R v(R^T s), exactly: harmonics of one degree turn into each other.
inline SphereVectorField rotated(const SphereVectorField& v, const Mat3& R) {
  const SphereQuadrature q = sphere_quadrature(v.degree + 1);
  const HarmonicCoefficients<2> turned = harmonic_coefficients<2>(
      harmonic_sum<2>(detail::potentials(v), (R.transpose() * q.points).colwise().normalized()), q, v.degree);
  return {v.degree, turned.col(0), turned.col(1), v.step};
}

/// outer(inner(s)).
/// accuracy 1e-12 radians [sphere/diffeomorphism_test]
inline SphereDiffeomorphism compose(const SphereDiffeomorphism& outer, const SphereDiffeomorphism& inner) {
  SphereDiffeomorphism both(outer.rotation() * inner.rotation());
  for (const auto& v : inner.increments()) both.append(rotated(v, outer.rotation()));
  for (const auto& v : outer.increments()) both.append(v);
  return both;
}

/// The inverse as a map of its own.
/// accuracy 1e-12 radians [sphere/diffeomorphism_test]
inline SphereDiffeomorphism inverted(const SphereDiffeomorphism& gamma) {
  const Mat3 back = gamma.rotation().transpose();
  SphereDiffeomorphism out(back);
  for (auto v = gamma.increments().rbegin(); v != gamma.increments().rend(); ++v) {
    SphereVectorField turned = rotated(*v, back);
    turned.step = v->step == FieldStep::forward ? FieldStep::inverse : FieldStep::forward;
    out.append(std::move(turned));
  }
  return out;
}

/// Proof on a grid that gamma is a diffeomorphism: four times finer than the fields' bandwidth.
struct DiffeomorphismCertificate {
  double min_jacobian = 0;
  Index points = 0;
  bool holds() const { return min_jacobian > 0; }
};

inline DiffeomorphismCertificate certify(const SphereDiffeomorphism& gamma) {
  int degree = 4;
  for (const auto& v : gamma.increments()) degree = std::max(degree, v.degree);
  const SphereQuadrature grid = sphere_quadrature(4 * degree);
  return {gamma.displacement(charts_at(grid.points)).J.minCoeff(), grid.size()};
}

/// A random smooth diffeomorphism of three increments of degree up to `degree`, which moves points by `size` radians in the
/// root mean square over the sphere.
/// throws   InvalidArgument unless degree >= 1 and 0 <= size <= 0.5; Error where a map of that size folds, as large ones of
///          high degree do
inline SphereDiffeomorphism random_diffeomorphism(std::uint64_t seed, int degree, double size) {
  require(degree >= 1 && size >= 0 && size <= 0.5, "random_diffeomorphism: degree ", degree, " and size ", size,
          " radians, give at least 1 and 0 to 0.5");
  constexpr int increments = 3;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const SphereQuadrature q = sphere_quadrature(degree + 8);
  const Eigen::ArrayXd l = harmonic_degrees(degree);
  std::vector<SphereVectorField> fields;
  for (int k = 0; k < increments; ++k) {
    SphereVectorField v = SphereVectorField::zero(degree);
    for (Index i = 1; i < v.a.size(); ++i) {  // decay faster than the degree keeps the fields smooth
      v.a[i] = normal(random) * std::pow(l[i], -2.5);
      v.b[i] = normal(random) * std::pow(l[i], -2.5);
    }
    fields.push_back(std::move(v));
  }
  const auto scaled = [&](double factor) {
    SphereDiffeomorphism gamma;
    for (const SphereVectorField& v : fields) gamma.append({v.degree, factor * v.a, factor * v.b});
    return gamma;
  };
  double factor = 0.01;  // the displacement grows nearly in proportion
  for (int round = 0; round < 8 && size > 0; ++round) {
    const Mat3X y = scaled(factor)(q.points);
    double square = 0;
    for (Index i = 0; i < q.size(); ++i) square += q.weights[i] * std::pow(angle_between(q.points.col(i), y.col(i)), 2);
    factor *= size / std::sqrt(square / (4 * pi));
  }
  SphereDiffeomorphism gamma = scaled(size > 0 ? factor : 0);
  const DiffeomorphismCertificate certificate = certify(gamma);
  require<Error>(certificate.holds(), "random_diffeomorphism: the map of seed ", seed, " and degree ", degree,
                 " folds before it moves points by ", size, " radians: give a smaller size or another seed");
  return gamma;
}

}  // namespace dsns
