#pragma once
/// What a surface is, and the one place where its derivatives come from.
///
/// A surface is a functor f(s) on the unit sphere, a moving surface a functor F(s, t) with t in [0, 1]. Algorithms ask for
///   positions(f, s)      positions(F, s, t)       values at the columns of s, 3 x n
///   tangents(f, charts)  tangents(F, charts, t)   values with first derivatives in the charts
///   jets(f, charts)      jets(F, charts, t)       values with first and second derivatives in the charts
///                        velocities(F, s, t)      dF/dt, 3 x n
///                        motion_jets(F, charts, t) values and velocities with first derivatives in the charts
/// Each takes the member function of that name where the surface has one (the way of batches: networks, sampled meshes),
/// else a free function found by argument-dependent lookup (jets only), else the call operator with a differentiating
/// scalar: f(Vec3<Jet2<double>>), F(Vec3<Dual<double, 1>>, Dual<double, 1>).
#include <dsns/surface/held.hpp>
#include <dsns/surface/scalar_jets.hpp>

#include <concepts>
#include <utility>

namespace dsns {

namespace detail::jets_lookup {

void jets() = delete;  // poison pill: below, only argument-dependent lookup may find an overload

// Each asks for the exact return type: Eigen's constructors would let a double-only functor pass as convertible.
template <class S>
concept MemberJets = requires(const S& f, const ChartBatch& c) {
  { f.jets(c) } -> std::same_as<SurfaceJets>;
};
template <class S>
concept FreeJets = requires(const S& f, const ChartBatch& c) {
  { jets(f, c) } -> std::same_as<SurfaceJets>;
};
template <class S>
concept ScalarJets = requires(const S& f, const Vec3<SpatialJet>& s) {
  { f(s) } -> std::same_as<Vec3<SpatialJet>>;
};
template <class F>
concept MovingMemberJets = requires(const F& f, const ChartBatch& c, double t) {
  { f.jets(c, t) } -> std::same_as<SurfaceJets>;
};
template <class F>
concept MovingFreeJets = requires(const F& f, const ChartBatch& c, double t) {
  { jets(f, c, t) } -> std::same_as<SurfaceJets>;
};
template <class F>
concept MovingScalarJets = requires(const F& f, const Vec3<SpatialJet>& s, SpatialJet t) {
  { f(s, t) } -> std::same_as<Vec3<SpatialJet>>;
};

struct JetsFunction {
  template <class S>
  requires MemberJets<S> || FreeJets<S> || ScalarJets<S>
  [[nodiscard]] SurfaceJets operator()(const S& f, const ChartBatch& c) const {
    if constexpr (MemberJets<S>)
      return f.jets(c);
    else if constexpr (FreeJets<S>)
      return jets(f, c);
    else
      return jets_by_scalars<LanesOf<S>>(c, f);
  }
  template <class F>
  requires MovingMemberJets<F> || MovingFreeJets<F> || MovingScalarJets<F>
  [[nodiscard]] SurfaceJets operator()(const F& f, const ChartBatch& c, double t) const {
    if constexpr (MovingMemberJets<F>) {
      return f.jets(c, t);
    } else if constexpr (MovingFreeJets<F>) {
      return jets(f, c, t);
    } else {
      using T = SpatialJetOf<LanesOf<F>>;
      return jets_by_scalars<LanesOf<F>>(c, [&](const Vec3<T>& s) { return f(s, T(t)); });
    }
  }
};

}  // namespace detail::jets_lookup

/// Second-order jets of a surface, or of a moving surface at time t, at n charts.
inline constexpr detail::jets_lookup::JetsFunction jets{};

/// Sends unit vectors to R^3 and has 2-jets.
template <class S>
concept Surface = requires(const S& f, const Vec3d& s, const ChartBatch& c) {
  { f(s) } -> std::same_as<Vec3d>;
  { dsns::jets(f, c) } -> std::same_as<SurfaceJets>;
};

namespace detail {

template <class S>
concept MemberTangents = requires(const S& f, const ChartBatch& c) {
  { f.tangents(c) } -> std::same_as<SurfaceTangents>;
};
template <class S>
concept ScalarTangents = requires(const S& f, const Vec3<SpatialDual>& s) {
  { f(s) } -> std::same_as<Vec3<SpatialDual>>;
};
template <class F>
concept MovingMemberTangents = requires(const F& f, const ChartBatch& c, double t) {
  { f.tangents(c, t) } -> std::same_as<SurfaceTangents>;
};
template <class F>
concept MovingScalarTangents = requires(const F& f, const Vec3<SpatialDual>& s, SpatialDual t) {
  { f(s, t) } -> std::same_as<Vec3<SpatialDual>>;
};
template <class F>
concept MemberVelocities = requires(const F& f, const Mat3X& s, double t) {
  { f.velocities(s, t) } -> std::same_as<Mat3X>;
};
template <class F>
concept ScalarVelocities = requires(const F& f, const Vec3<TimeDual>& s, TimeDual t) {
  { f(s, t) } -> std::same_as<Vec3<TimeDual>>;
};
template <class F>
concept MemberMotionJets = requires(const F& f, const ChartBatch& c, double t) {
  { f.motion_jets(c, t) } -> std::same_as<MotionJets>;
};
template <class F>
concept ScalarMotionJets = requires(const F& f, const Vec3<MotionDual>& s, MotionDual t) {
  { f(s, t) } -> std::same_as<Vec3<MotionDual>>;
};

}  // namespace detail

/// Sends a unit vector and a time in [0, 1] to R^3, has 2-jets in space and a derivative in time, which has first
/// derivatives in space.
template <class F>
concept AnimatedSurface = requires(const F& f, const Vec3d& s, const ChartBatch& c, double t) {
  { f(s, t) } -> std::same_as<Vec3d>;
  { dsns::jets(f, c, t) } -> std::same_as<SurfaceJets>;
  requires detail::MemberVelocities<F> || detail::ScalarVelocities<F>;
  requires detail::MemberMotionJets<F> || detail::ScalarMotionJets<F>;
};

/// Values of a surface at the n columns of s.
template <Surface S>
Mat3X positions(const S& f, const Mat3X& s) {
  if constexpr (requires {
                  { f.positions(s) } -> std::same_as<Mat3X>;
                }) {
    return f.positions(s);
  } else {
    Mat3X out(3, s.cols());
    for (Index i = 0; i < s.cols(); ++i) out.col(i) = f(Vec3d(s.col(i)));
    return out;
  }
}

/// Values of a moving surface at the n columns of s and time t.
template <AnimatedSurface F>
Mat3X positions(const F& f, const Mat3X& s, double t) {
  if constexpr (requires {
                  { f.positions(s, t) } -> std::same_as<Mat3X>;
                }) {
    return f.positions(s, t);
  } else {
    Mat3X out(3, s.cols());
    for (Index i = 0; i < s.cols(); ++i) out.col(i) = f(Vec3d(s.col(i)), t);
    return out;
  }
}

/// Values and first derivatives of a surface at n charts: what normals, areas and SRNFs need.
template <Surface S>
SurfaceTangents tangents(const S& f, const ChartBatch& c) {
  if constexpr (detail::MemberTangents<S>)
    return f.tangents(c);
  else if constexpr (detail::ScalarTangents<S> && !detail::jets_lookup::MemberJets<S>)
    return detail::tangents_by_scalars<detail::LanesOf<S>>(c, f);
  else
    return SurfaceTangents(jets(f, c));
}

/// The same of a moving surface at time t.
template <AnimatedSurface F>
SurfaceTangents tangents(const F& f, const ChartBatch& c, double t) {
  if constexpr (detail::MovingMemberTangents<F>) {
    return f.tangents(c, t);
  } else if constexpr (detail::MovingScalarTangents<F> && !detail::jets_lookup::MovingMemberJets<F>) {
    using T = detail::SpatialDualOf<detail::LanesOf<F>>;
    return detail::tangents_by_scalars<detail::LanesOf<F>>(c, [&](const Vec3<T>& s) { return f(s, T(t)); });
  } else {
    return SurfaceTangents(jets(f, c, t));
  }
}

/// dF/dt at the n columns of s and time t: length unit per clip.
template <AnimatedSurface F>
Mat3X velocities(const F& f, const Mat3X& s, double t) {
  if constexpr (detail::MemberVelocities<F>) {
    return f.velocities(s, t);
  } else {
    Mat3X out(3, s.cols());
    const auto time = detail::TimeDual::variable(t, 0);
    for (Index i = 0; i < s.cols(); ++i) {
      const Vec3<detail::TimeDual> p = f(Vec3<detail::TimeDual>(s.col(i).template cast<detail::TimeDual>()), time);
      for (int k = 0; k < 3; ++k) out(k, i) = p[k].g[0];
    }
    return out;
  }
}

/// Values and velocities with their first derivatives in n charts at time t: what rates of area and of the metric need.
template <AnimatedSurface F>
MotionJets motion_jets(const F& f, const ChartBatch& c, double t) {
  if constexpr (detail::MemberMotionJets<F>)
    return f.motion_jets(c, t);
  else
    return detail::motion_by_scalars<detail::LanesOf<F>>(f, c, t);
}

/// A moving surface frozen at one time: a Surface. F is as detail::HeldAs says.
template <class F>
class AtTime {
 public:
  AtTime(F surface, double t) : surface_(std::forward<F>(surface)), t_(t) {}

  Vec3d operator()(const Vec3d& s) const { return (*surface_)(s, t_); }
  SurfaceJets jets(const ChartBatch& c) const { return dsns::jets(*surface_, c, t_); }
  SurfaceTangents tangents(const ChartBatch& c) const { return dsns::tangents(*surface_, c, t_); }
  Mat3X positions(const Mat3X& s) const { return dsns::positions(*surface_, s, t_); }

 private:
  detail::Held<F> surface_;
  double t_;
};

/// Refers to a surface that has a name, which must outlive the result; keeps a temporary.
template <class F>
requires AnimatedSurface<std::remove_cvref_t<F>> AtTime<detail::HeldAs<F>> at_time(F&& surface, double t) {
  return {std::forward<F>(surface), t};
}

}  // namespace dsns
