#pragma once
/// What a diffeomorphism is composed of: the map exp(v) of a field, or the map that undoes it. exp(-v) does not: it misses by the
/// square of the field.
#include <dsns/sphere/vector_field.hpp>

#include <Eigen/LU>

namespace dsns {

/// The points that exp(v) sends to the unit columns of y, by Newton's method.
/// accuracy 1e-12 radians [sphere/diffeomorphism_test]
/// throws   Error where Newton's method does not converge, which a diffeomorphism with J > 0 does not show
inline Mat3X exponential_inverse(const SphereVectorField& v, const Mat3X& y) {
  Mat3X s = displace({v.degree, -v.a, -v.b}, charts_at(y)).y;
  double worst = 1;
  for (int iteration = 0; iteration < 30 && worst > 1e-14; ++iteration) {
    const ChartBatch here = charts_at(s);
    const SphereDisplacement image = displace(v, here);
    worst = 0;
    for (Index i = 0; i < s.cols(); ++i) {
      const Vec3d miss = y.col(i) - image.y.col(i);
      Eigen::Matrix<double, 3, 2> D;
      D << image.y1.col(i), image.y2.col(i);
      const Eigen::Matrix2d normal = D.transpose() * D;
      Eigen::Vector2d step = normal.inverse() * (D.transpose() * miss);
      const double length = step.norm();
      if (length > 0.3) step *= 0.3 / length;  // far from the solution the linear model may overshoot
      s.col(i) = (s.col(i) + here.e1.col(i) * step[0] + here.e2.col(i) * step[1]).normalized();
      worst = std::max(worst, miss.norm());
    }
  }
  require<Error>(worst < 1e-9, "SphereDiffeomorphism::inverse: Newton's method stopped ", worst,
                 " radians away, the map is not invertible there");
  return s;
}

namespace detail {

/// With derivatives: from the solution in numbers, each chord step with their Jacobian makes one more order exact.
template <class T>
Vec3<T> exponential_inverse_jets(const SphereVectorField& v, const Vec3<T>& y) {
  constexpr int orders = 3;
  const Vec3d s = exponential_inverse(v, Vec3d(value(y[0]), value(y[1]), value(y[2])).normalized());
  const ChartBatch here = charts_at(Mat3X(s));
  const SphereDisplacement image = displace(v, here);
  Eigen::Matrix<double, 3, 2> D, frame;
  D << image.y1, image.y2;
  frame << here.e1, here.e2;
  const Mat3 back = frame * (D.transpose() * D).inverse() * D.transpose();
  Vec3<T> x{T(s[0]), T(s[1]), T(s[2])};
  for (int k = 0; k < orders; ++k) {
    const Vec3<T> miss = y - exponential(v, x);
    Vec3<T> next;
    for (int i = 0; i < 3; ++i) next[i] = x[i] + back(i, 0) * miss[0] + back(i, 1) * miss[1] + back(i, 2) * miss[2];
    using std::sqrt;
    const T length = sqrt(next.dot(next));
    for (int i = 0; i < 3; ++i) x[i] = next[i] / length;
  }
  return x;
}

}  // namespace detail

/// The image of one point under the increment; T any scalar over double.
template <class T>
Vec3<T> increment(const SphereVectorField& v, const Vec3<T>& s) {
  if (v.step == FieldStep::forward) return exponential(v, s);
  if constexpr (std::is_same_v<Passive<T>, double>)
    return detail::exponential_inverse_jets(v, s);
  else
    fail<Error>("increment: the inverse of a field is known for scalars over double alone");
}

/// The displacement of the charts' points by the increment.
/// accuracy 1e-11 against jets of increment() [sphere/diffeomorphism_test]
inline SphereDisplacement increment(const SphereVectorField& v, const ChartBatch& c) {
  if (v.step == FieldStep::forward) return displace(v, c);
  SphereDisplacement out{exponential_inverse(v, c.s), c.e1, c.e2, Eigen::VectorXd::Ones(c.size())};
  const ChartBatch there = charts_at(out.y);
  const SphereDisplacement forth = displace(v, there);
  for (Index i = 0; i < c.size(); ++i) {
    Eigen::Matrix2d D;
    D << c.e1.col(i).dot(forth.y1.col(i)), c.e1.col(i).dot(forth.y2.col(i)), c.e2.col(i).dot(forth.y1.col(i)),
        c.e2.col(i).dot(forth.y2.col(i));
    const Eigen::Matrix2d back = D.inverse();
    out.y1.col(i) = there.e1.col(i) * back(0, 0) + there.e2.col(i) * back(1, 0);
    out.y2.col(i) = there.e1.col(i) * back(0, 1) + there.e2.col(i) * back(1, 1);
    out.J[i] = 1 / forth.J[i];
  }
  out.longest_step = forth.longest_step;
  return out;
}

/// The points that the increment sends to the unit columns of y.
inline Mat3X increment_inverse(const SphereVectorField& v, const Mat3X& y) {
  return v.step == FieldStep::forward ? exponential_inverse(v, y) : displace(v, charts_at(y)).y;
}

}  // namespace dsns
