#pragma once
/// Moving surfaces made of resting ones, and of moving ones whose time runs otherwise.
///
///   const auto breathing = animated([]<class T>(const T& t) { return EllipsoidOf<T>{1.0 + 0.2 * t, T(1), 1.0 - 0.2 * t}; });
///   const auto blend = sum(modulated(first, [](auto t) { return 1.0 - t; }), modulated(second, [](auto t) { return 1.0 * t; }));
///
/// As with the adapters of surface/adapters.hpp, a surface that has a name is referred to, a temporary is kept.
/// accuracy 1e-12 against the composed formula [surface/motion_test]
#include <dsns/surface/adapters.hpp>

namespace dsns {

namespace detail {

template <class W>
concept HasSlope = requires(const W& w, double t) {
  { w.slope(t) } -> std::same_as<double>;
};
template <class W>
concept ScalarTimeFunction = requires(const W& w, const TimeDual& t) {
  { w(t) } -> std::same_as<TimeDual>;
};
template <class W>
double slope(const W& w, double t) {
  if constexpr (HasSlope<W>)
    return w.slope(t);
  else
    return w(TimeDual::variable(t, 0)).g[0];
}

}  // namespace detail

/// A function of time and its derivative: has slope(t), or takes a differentiating scalar.
template <class W>
concept TimeFunction = requires(const W& w, double t) {
  { w(t) } -> std::same_as<double>;
  requires detail::HasSlope<W> || detail::ScalarTimeFunction<W>;
};

/// F(s, zeta(t)).
template <class F, TimeFunction Warp>
class TimeWarped {
 public:
  TimeWarped(F surface, Warp zeta) : surface_(std::forward<F>(surface)), zeta_(std::move(zeta)) {}

  Vec3d operator()(const Vec3d& s, double t) const { return (*surface_)(s, zeta_(t)); }
  Mat3X positions(const Mat3X& s, double t) const { return dsns::positions(*surface_, s, zeta_(t)); }
  SurfaceTangents tangents(const ChartBatch& c, double t) const { return dsns::tangents(*surface_, c, zeta_(t)); }
  SurfaceJets jets(const ChartBatch& c, double t) const { return dsns::jets(*surface_, c, zeta_(t)); }
  Mat3X velocities(const Mat3X& s, double t) const {
    return detail::slope(zeta_, t) * dsns::velocities(*surface_, s, zeta_(t));
  }
  MotionJets motion_jets(const ChartBatch& c, double t) const {
    MotionJets m = dsns::motion_jets(*surface_, c, zeta_(t));
    const double rate = detail::slope(zeta_, t);
    for (Mat3X* field : {&m.ft, &m.ftu, &m.ftv}) *field *= rate;
    return m;
  }

 private:
  detail::Held<F> surface_;
  Warp zeta_;
};

/// Keeps a copy of zeta.
template <class F, TimeFunction Warp>
requires AnimatedSurface<std::remove_cvref_t<F>> TimeWarped<detail::HeldAs<F>, Warp> time_warped(F&& surface,
                                                                                                 Warp zeta) {
  return {std::forward<F>(surface), std::move(zeta)};
}

/// weight(t) f(s) of a resting surface f: sums of them are all separable motions.
template <class S, TimeFunction Weight>
class Modulated {
 public:
  Modulated(S surface, Weight weight) : surface_(std::forward<S>(surface)), weight_(std::move(weight)) {}

  Vec3d operator()(const Vec3d& s, double t) const { return weight_(t) * (*surface_)(s); }
  Mat3X positions(const Mat3X& s, double t) const { return weight_(t) * dsns::positions(*surface_, s); }
  Mat3X velocities(const Mat3X& s, double t) const { return detail::slope(weight_, t) * dsns::positions(*surface_, s); }
  SurfaceTangents tangents(const ChartBatch& c, double t) const {
    return weighted(dsns::tangents(*surface_, c), weight_(t));
  }
  SurfaceJets jets(const ChartBatch& c, double t) const { return weighted(dsns::jets(*surface_, c), weight_(t)); }
  MotionJets motion_jets(const ChartBatch& c, double t) const {
    const SurfaceTangents f = dsns::tangents(*surface_, c);
    const double w = weight_(t), rate = detail::slope(weight_, t);
    MotionJets m(c.size());
    m.f = w * f.f;
    m.fu = w * f.fu;
    m.fv = w * f.fv;
    m.ft = rate * f.f;
    m.ftu = rate * f.fu;
    m.ftv = rate * f.fv;
    return m;
  }

 private:
  template <class J>
  static J weighted(J j, double weight) {
    for (Mat3X* field : detail::fields(j)) *field *= weight;
    return j;
  }

  detail::Held<S> surface_;
  Weight weight_;
};

template <class S, TimeFunction Weight>
requires Surface<std::remove_cvref_t<S>> Modulated<detail::HeldAs<S>, Weight> modulated(S&& surface, Weight weight) {
  return {std::forward<S>(surface), std::move(weight)};
}

namespace detail {

struct AlwaysOne {
  double operator()(double) const { return 1; }
  double slope(double) const { return 0; }
};

}  // namespace detail

/// A moving surface that does not move.
template <class S>
requires Surface<std::remove_cvref_t<S>>
auto resting(S&& surface) { return modulated(std::forward<S>(surface), detail::AlwaysOne{}); }

/// build(t)(s): a family of resting surfaces run through in time. The family is a functor of any scalar T that makes a surface
/// whose parameters are T, so that velocities are exact.
template <class Build>
class Animated {
 public:
  static constexpr bool works_in_lanes = requires {
    requires std::invoke_result_t<const Build&, double>::works_in_lanes;
  };

  explicit Animated(Build build) : build_(std::move(build)) {}

  /// The surface at time t, with all its closed forms.
  auto at(double t) const { return build_(t); }

  template <class T>
  requires std::invocable<const Build&, const T&> Vec3<T>
  operator()(const Vec3<T>& s, const T& t) const { return build_(t)(s); }

 private:
  Build build_;
};

template <class Build>
Animated<Build> animated(Build build) {
  static_assert(Surface<std::invoke_result_t<const Build&, double>>,
                "animated: give a functor that makes a surface of a time t of any scalar type, such as EllipsoidOf<T>");
  return Animated<Build>(std::move(build));
}

}  // namespace dsns
