#pragma once
/// Derivatives of a surface from its call operator alone: the functor runs with a scalar that differentiates, a point at a
/// time or several side by side in vector registers.
///
/// A functor whose body holds for every lane at once, that is without conditions on its arguments, says so:
///   struct Mine { static constexpr bool works_in_lanes = true; template <class T> Vec3<T> operator()(const Vec3<T>& s) const; };
/// and is differentiated at four or eight points in the time of one.
#include <dsns/autodiff/dual.hpp>
#include <dsns/autodiff/eigen.hpp>
#include <dsns/autodiff/jet2.hpp>
#include <dsns/sphere/charts.hpp>
#if defined(__GNUC__)
#include <dsns/autodiff/batch.hpp>
#endif

#include <algorithm>
#include <concepts>

namespace dsns {

/// Values and derivatives of n surface points in their charts; all 3 x n.
struct SurfaceJets {
  Mat3X f, fu, fv, fuu, fuv, fvv;

  explicit SurfaceJets(Index n) : f(3, n), fu(3, n), fv(3, n), fuu(3, n), fuv(3, n), fvv(3, n) {}
  Index size() const { return f.cols(); }
};

/// Values and first derivatives of n surface points in their charts; all 3 x n.
struct SurfaceTangents {
  Mat3X f, fu, fv;

  explicit SurfaceTangents(Index n) : f(3, n), fu(3, n), fv(3, n) {}
  explicit SurfaceTangents(SurfaceJets j) : f(std::move(j.f)), fu(std::move(j.fu)), fv(std::move(j.fv)) {}
  Index size() const { return f.cols(); }
};

/// Values and velocities (length unit per clip) of n points of a moving surface with their first derivatives in the charts;
/// all 3 x n.
struct MotionJets {
  Mat3X f, fu, fv, ft, ftu, ftv;

  explicit MotionJets(Index n) : f(3, n), fu(3, n), fv(3, n), ft(3, n), ftu(3, n), ftv(3, n) {}
  Index size() const { return f.cols(); }
};

namespace detail {

/// Scalars that differentiate a surface, over double or over lanes of it.
template <class N>
using SpatialJetOf = Jet2<N, 2>;
template <class N>
using SpatialDualOf = Dual<N, 2>;
template <class N>
using MotionDualOf = Dual<Dual<N, 2>, 1>;
using SpatialJet = SpatialJetOf<double>;
using SpatialDual = SpatialDualOf<double>;
using MotionDual = MotionDualOf<double>;
using TimeDual = Dual<double, 1>;

#if defined(__GNUC__)
template <class F>
concept WorksInLanes = requires {
  requires F::works_in_lanes;
};
template <class F>
using LanesOf = std::conditional_t<WorksInLanes<F>, Batch<double>, double>;
#else
template <class F>
using LanesOf = double;
#endif

template <class N>
constexpr Index lane_count() {
  if constexpr (std::same_as<N, double>)
    return 1;
  else
    return N::lanes;
}
/// Entry k of column i, or of the columns from i on: the last column stands in for those beyond the end.
template <class N>
N load(const Mat3X& m, int k, Index i) {
  if constexpr (std::same_as<N, double>) {
    return m(k, i);
  } else {
    N x;
    for (int l = 0; l < N::lanes; ++l) x.v[l] = m(k, std::min(i + l, m.cols() - 1));
    return x;
  }
}
template <class N>
void store(Mat3X& m, int k, Index i, const N& x) {
  if constexpr (std::same_as<N, double>) {
    m(k, i) = x;
  } else {
    const Index end = std::min<Index>(N::lanes, m.cols() - i);
    for (Index l = 0; l < end; ++l) m(k, i + l) = x.v[l];
  }
}

/// The chart of point i, or of the points from i on, as a 2-jet: s_u = e1, s_v = e2, s_uu = s_vv = -s, s_uv = 0.
template <class N = double>
Vec3<SpatialJetOf<N>> chart_jet(const ChartBatch& c, Index i) {
  Vec3<SpatialJetOf<N>> s;
  for (int k = 0; k < 3; ++k) {
    const N x = load<N>(c.s, k, i);
    s[k].f = x;
    s[k].g[0] = load<N>(c.e1, k, i);
    s[k].g[1] = load<N>(c.e2, k, i);
    s[k].h[0] = s[k].h[2] = -x;
    s[k].h[1] = N(0.0);
  }
  return s;
}
/// The same to first order.
template <class N = double>
Vec3<SpatialDualOf<N>> chart_dual(const ChartBatch& c, Index i) {
  Vec3<SpatialDualOf<N>> s;
  for (int k = 0; k < 3; ++k) {
    s[k].f = load<N>(c.s, k, i);
    s[k].g[0] = load<N>(c.e1, k, i);
    s[k].g[1] = load<N>(c.e2, k, i);
  }
  return s;
}

/// Each takes `evaluate`, which sends the chart in the differentiating scalar over N to a point.
template <class N, class Evaluate>
SurfaceJets jets_by_scalars(const ChartBatch& c, const Evaluate& evaluate) {
  SurfaceJets out(c.size());
  for (Index i = 0; i < c.size(); i += lane_count<N>()) {
    const Vec3<SpatialJetOf<N>> p = evaluate(chart_jet<N>(c, i));
    for (int k = 0; k < 3; ++k) {
      store<N>(out.f, k, i, p[k].f);
      store<N>(out.fu, k, i, p[k].g[0]);
      store<N>(out.fv, k, i, p[k].g[1]);
      store<N>(out.fuu, k, i, p[k].h[0]);
      store<N>(out.fuv, k, i, p[k].h[1]);
      store<N>(out.fvv, k, i, p[k].h[2]);
    }
  }
  return out;
}
template <class N, class Evaluate>
SurfaceTangents tangents_by_scalars(const ChartBatch& c, const Evaluate& evaluate) {
  SurfaceTangents out(c.size());
  for (Index i = 0; i < c.size(); i += lane_count<N>()) {
    const Vec3<SpatialDualOf<N>> p = evaluate(chart_dual<N>(c, i));
    for (int k = 0; k < 3; ++k) {
      store<N>(out.f, k, i, p[k].f);
      store<N>(out.fu, k, i, p[k].g[0]);
      store<N>(out.fv, k, i, p[k].g[1]);
    }
  }
  return out;
}
template <class N, class F>
MotionJets motion_by_scalars(const F& surface, const ChartBatch& c, double t) {
  MotionJets out(c.size());
  const auto time = MotionDualOf<N>::variable(SpatialDualOf<N>(t), 0);
  for (Index i = 0; i < c.size(); i += lane_count<N>()) {
    const Vec3<SpatialDualOf<N>> chart = chart_dual<N>(c, i);
    const Vec3<MotionDualOf<N>> s{MotionDualOf<N>(chart[0]), MotionDualOf<N>(chart[1]), MotionDualOf<N>(chart[2])};
    const Vec3<MotionDualOf<N>> p = surface(s, time);
    for (int k = 0; k < 3; ++k) {
      store<N>(out.f, k, i, p[k].f.f);
      store<N>(out.fu, k, i, p[k].f.g[0]);
      store<N>(out.fv, k, i, p[k].f.g[1]);
      store<N>(out.ft, k, i, p[k].g[0].f);
      store<N>(out.ftu, k, i, p[k].g[0].g[0]);
      store<N>(out.ftv, k, i, p[k].g[0].g[1]);
    }
  }
  return out;
}

}  // namespace detail

}  // namespace dsns
