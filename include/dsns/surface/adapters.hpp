#pragma once
/// Surfaces made of surfaces: rotated, scaled, translated, reparametrized, added. Each takes resting and moving surfaces of
/// every kind, whole batches at a time where these do, and has the exact derivatives.
///
///   const auto view = translated(rotated(reparametrized(body, gamma), R), Vec3d(0, 0, 1));   // R body(gamma(s), t) + (0, 0, 1)
///
/// A surface that has a name is referred to, and must outlive what is made of it; a temporary is kept, as in the chain above.
/// accuracy 1e-12 against the composed formula [surface/adapters_test]
#include <dsns/core/errors.hpp>
#include <dsns/surface/jets.hpp>

#include <array>
#include <cmath>
#include <concepts>
#include <tuple>
#include <type_traits>
#include <utility>

namespace dsns {

namespace detail {

/// S is a surface, asked at no time, or a moving one, asked at one.
template <class S, class... Time>
concept SurfaceAt = (sizeof...(Time) == 0 && Surface<std::remove_cvref_t<S>>) ||
                    (sizeof...(Time) == 1 && (std::convertible_to<Time, double> && ...) &&
                     AnimatedSurface<std::remove_cvref_t<S>>);
/// f(s) or f(s, t) with a scalar T.
template <class S, class T, class... Time>
concept MapsScalar = requires(const S& f, const Vec3<T>& s, const Time&... t) {
  { f(s, t...) } -> std::same_as<Vec3<T>>;
};
template <class S>
concept AnySurface = Surface<std::remove_cvref_t<S>> || AnimatedSurface<std::remove_cvref_t<S>>;

/// All that depends linearly on the surface.
inline std::array<Mat3X*, 6> fields(SurfaceJets& j) { return {&j.f, &j.fu, &j.fv, &j.fuu, &j.fuv, &j.fvv}; }
inline std::array<Mat3X*, 3> fields(SurfaceTangents& j) { return {&j.f, &j.fu, &j.fv}; }
inline std::array<Mat3X*, 6> fields(MotionJets& j) { return {&j.f, &j.fu, &j.fv, &j.ft, &j.ftu, &j.ftv}; }
inline std::array<Mat3X*, 1> fields(Mat3X& m) { return {&m}; }

inline Mat3X& values(Mat3X& positions) { return positions; }
template <class J>
Mat3X& values(J& jets) {
  return jets.f;
}

}  // namespace detail

/// linear f + shift.
template <class S>
class Transformed {
 public:
  Transformed(S surface, const Mat3& linear, const Vec3d& shift)
      : surface_(std::forward<S>(surface)), linear_(linear), shift_(shift) {}

  template <class T, class... Time>
  requires detail::MapsScalar<S, T, Time...> Vec3<T>
  operator()(const Vec3<T>& s, const Time&... t) const {
    const Vec3<T> p = (*surface_)(s, t...);
    Vec3<T> q;
    for (int k = 0; k < 3; ++k) q[k] = linear_(k, 0) * p[0] + linear_(k, 1) * p[1] + linear_(k, 2) * p[2] + shift_[k];
    return q;
  }
  template <class... Time>
  requires detail::SurfaceAt<S, Time...> Mat3X positions(const Mat3X& s, Time... t)
  const { return shifted(turned(dsns::positions(*surface_, s, t...))); }
  template <class... Time>
  requires detail::SurfaceAt<S, Time...> SurfaceTangents tangents(const ChartBatch& c, Time... t)
  const { return shifted(turned(dsns::tangents(*surface_, c, t...))); }
  template <class... Time>
  requires detail::SurfaceAt<S, Time...> SurfaceJets jets(const ChartBatch& c, Time... t)
  const { return shifted(turned(dsns::jets(*surface_, c, t...))); }
  Mat3X velocities(const Mat3X& s, double t) const requires detail::SurfaceAt<S, double> {
    return turned(dsns::velocities(*surface_, s, t));
  }
  MotionJets motion_jets(const ChartBatch& c, double t) const requires detail::SurfaceAt<S, double> {
    return shifted(turned(dsns::motion_jets(*surface_, c, t)));
  }

 private:
  template <class J>
  J turned(J j) const {
    for (Mat3X* field : detail::fields(j)) *field = linear_ * *field;
    return j;
  }
  template <class J>
  J shifted(J j) const {
    detail::values(j).colwise() += shift_;
    return j;
  }

  detail::Held<S> surface_;
  Mat3 linear_;
  Vec3d shift_;
};

template <detail::AnySurface S>
Transformed<detail::HeldAs<S>> rotated(S&& surface, const Mat3& rotation) {
  return {std::forward<S>(surface), rotation, Vec3d::Zero()};
}
template <detail::AnySurface S>
Transformed<detail::HeldAs<S>> scaled(S&& surface, double factor) {
  return {std::forward<S>(surface), factor * Mat3::Identity(), Vec3d::Zero()};
}
template <detail::AnySurface S>
Transformed<detail::HeldAs<S>> translated(S&& surface, const Vec3d& shift) {
  return {std::forward<S>(surface), Mat3::Identity(), shift};
}

/// f(gamma(s)) for a map gamma of the sphere: a surface whose points are unit vectors, so a functor of any scalar will do.
template <class S, Surface Gamma>
class Reparametrized {
 public:
  Reparametrized(S surface, Gamma gamma) : surface_(std::forward<S>(surface)), gamma_(std::move(gamma)) {}

  template <class T, class... Time>
  requires(detail::MapsScalar<S, T, Time...>&& detail::MapsScalar<Gamma, T>) Vec3<T>
  operator()(const Vec3<T>& s, const Time&... t) const {
    Vec3<T> y = gamma_(s);
    if constexpr (std::is_same_v<T, double>) y.normalize();
    return (*surface_)(y, t...);
  }
  template <class... Time>
  requires detail::SurfaceAt<S, Time...> Mat3X positions(const Mat3X& s, Time... t)
  const { return dsns::positions(*surface_, on_sphere(dsns::positions(gamma_, s)), t...); }
  Mat3X velocities(const Mat3X& s, double t) const requires detail::SurfaceAt<S, double> {
    return dsns::velocities(*surface_, on_sphere(dsns::positions(gamma_, s)), t);
  }
  template <class... Time>
  requires detail::SurfaceAt<S, Time...> SurfaceTangents tangents(const ChartBatch& c, Time... t)
  const {
    const FirstOrder y(dsns::tangents(gamma_, c));
    const SurfaceTangents f = dsns::tangents(*surface_, y.charts, t...);
    SurfaceTangents out(c.size());
    out.f = f.f;
    out.fu = along(f.fu, f.fv, y.u);
    out.fv = along(f.fu, f.fv, y.v);
    return out;
  }
  MotionJets motion_jets(const ChartBatch& c, double t) const requires detail::SurfaceAt<S, double> {
    const FirstOrder y(dsns::tangents(gamma_, c));
    const MotionJets f = dsns::motion_jets(*surface_, y.charts, t);
    MotionJets out(c.size());
    out.f = f.f;
    out.fu = along(f.fu, f.fv, y.u);
    out.fv = along(f.fu, f.fv, y.v);
    out.ft = f.ft;
    out.ftu = along(f.ftu, f.ftv, y.u);
    out.ftv = along(f.ftu, f.ftv, y.v);
    return out;
  }
  template <class... Time>
  requires detail::SurfaceAt<S, Time...> SurfaceJets jets(const ChartBatch& c, Time... t)
  const {
    const SurfaceJets image = dsns::jets(gamma_, c);
    const FirstOrder y(image);
    const SurfaceJets f = dsns::jets(*surface_, y.charts, t...);
    const auto second = [&](const Eigen::Matrix2Xd& p, const Eigen::Matrix2Xd& q, const Mat3X& bend) -> Mat3X {
      const Eigen::Matrix2Xd pull = coordinates(y.charts, bend);
      return along(along(f.fuu, f.fuv, p), along(f.fuv, f.fvv, p), q) + along(f.fu, f.fv, pull);
    };
    SurfaceJets out(c.size());
    out.f = f.f;
    out.fu = along(f.fu, f.fv, y.u);
    out.fv = along(f.fu, f.fv, y.v);
    out.fuu = second(y.u, y.u, image.fuu);
    out.fuv = second(y.u, y.v, image.fuv);
    out.fvv = second(y.v, y.v, image.fvv);
    return out;
  }

 private:
  static Mat3X on_sphere(Mat3X y) {
    for (Index i = 0; i < y.cols(); ++i) {
      const double length = y.col(i).norm();
      require(std::abs(length - 1) < 1e-9, "reparametrized: the map sends point ", i, " to a vector of length ", length,
              ", it must give unit vectors: normalise its result");
      y.col(i) /= length;
    }
    return y;
  }
  /// Components of tangent vectors. In its chart a point of the sphere is p e1 + q e2 + O(p^2 + q^2) s, so that all derivatives
  /// of (p, q) up to the second are those of the vector, projected on e1 and e2.
  static Eigen::Matrix2Xd coordinates(const ChartBatch& c, const Mat3X& vectors) {
    Eigen::Matrix2Xd p(2, c.size());
    p.row(0) = c.e1.cwiseProduct(vectors).colwise().sum();
    p.row(1) = c.e2.cwiseProduct(vectors).colwise().sum();
    return p;
  }
  /// fu p + fv q, column by column.
  static Mat3X along(const Mat3X& fu, const Mat3X& fv, const Eigen::Matrix2Xd& p) {
    return fu * p.row(0).asDiagonal() + fv * p.row(1).asDiagonal();
  }
  /// Charts at gamma's points, and its first derivatives in them.
  struct FirstOrder {
    ChartBatch charts;
    Eigen::Matrix2Xd u, v;
    template <class J>
    explicit FirstOrder(const J& y)
        : charts(charts_at(on_sphere(y.f))), u(coordinates(charts, y.fu)), v(coordinates(charts, y.fv)) {}
  };

  detail::Held<S> surface_;
  Gamma gamma_;
};

/// Keeps a copy of gamma.
/// throws   InvalidArgument, when asked for points, where gamma gives vectors whose length is not 1 to 1e-9
template <detail::AnySurface S, Surface Gamma>
Reparametrized<detail::HeldAs<S>, Gamma> reparametrized(S&& surface, Gamma gamma) {
  return {std::forward<S>(surface), std::move(gamma)};
}

/// f + g + ...
template <class... S>
class Sum {
 public:
  explicit Sum(S... surfaces) : surfaces_(detail::Held<S>(std::forward<S>(surfaces))...) {}

  template <class T, class... Time>
  Vec3<T> operator()(const Vec3<T>& s, const Time&... t) const requires(detail::MapsScalar<S, T, Time...>&&...) {
    return total([&](const auto& f) -> Vec3<T> { return f(s, t...); });
  }
  template <class... Time>
  Mat3X positions(const Mat3X& s, Time... t) const requires(detail::SurfaceAt<S, Time...>&&...) {
    return total([&](const auto& f) { return dsns::positions(f, s, t...); });
  }
  template <class... Time>
  SurfaceTangents tangents(const ChartBatch& c, Time... t) const requires(detail::SurfaceAt<S, Time...>&&...) {
    return total([&](const auto& f) { return dsns::tangents(f, c, t...); });
  }
  template <class... Time>
  SurfaceJets jets(const ChartBatch& c, Time... t) const requires(detail::SurfaceAt<S, Time...>&&...) {
    return total([&](const auto& f) { return dsns::jets(f, c, t...); });
  }
  Mat3X velocities(const Mat3X& s, double t) const requires(detail::SurfaceAt<S, double>&&...) {
    return total([&](const auto& f) { return dsns::velocities(f, s, t); });
  }
  MotionJets motion_jets(const ChartBatch& c, double t) const requires(detail::SurfaceAt<S, double>&&...) {
    return total([&](const auto& f) { return dsns::motion_jets(f, c, t); });
  }

 private:
  template <class Ask>
  auto total(const Ask& ask) const {
    return std::apply(
        [&](const auto& first, const auto&... rest) {
          auto sum = ask(*first);
          (add(sum, ask(*rest)), ...);
          return sum;
        },
        surfaces_);
  }
  template <class T>
  static void add(Vec3<T>& sum, const Vec3<T>& term) {
    sum += term;
  }
  template <class J>
  static void add(J& sum, J term) {
    const auto to = detail::fields(sum), from = detail::fields(term);
    for (std::size_t k = 0; k < to.size(); ++k) *to[k] += *from[k];
  }

  std::tuple<detail::Held<S>...> surfaces_;
};

/// All resting or all moving; weights by scaled().
template <detail::AnySurface... S>
requires(sizeof...(S) > 0) Sum<detail::HeldAs<S>...> sum(S&&... surfaces) {
  return Sum<detail::HeldAs<S>...>(std::forward<S>(surfaces)...);
}

}  // namespace dsns
