#pragma once
/// A moving surface seen through a registration: O F(gamma(s), zeta(t)).
#include <dsns/elastic/time_warp.hpp>
#include <dsns/sphere/diffeomorphism.hpp>
#include <dsns/surface/jets.hpp>

namespace dsns {

/// Refers to the moving surface, which must outlive it.
template <AnimatedSurface F>
class RegisteredSurface {
 public:
  RegisteredSurface(const F& surface, const Mat3& rotation, SphereDiffeomorphism gamma, TimeWarp zeta = {})
      : surface_(&surface), rotation_(rotation), gamma_(std::move(gamma)), zeta_(std::move(zeta)) {}

  Vec3d operator()(const Vec3d& s, double t) const { return rotation_ * (*surface_)(gamma_(s).normalized(), zeta_(t)); }
  Mat3X positions(const Mat3X& s, double t) const {
    return rotation_ * dsns::positions(*surface_, gamma_(s), zeta_(t));
  }
  Mat3X velocities(const Mat3X& s, double t) const {
    return zeta_.slope(t) * rotation_ * dsns::velocities(*surface_, gamma_(s), zeta_(t));
  }

  /// With y = gamma(s(u, v)) written in the chart of y as p e1 + q e2: p_u = e1 . y_u and p_uu = e1 . y_uu, because the
  /// chart's second derivatives have no tangential part.
  SurfaceJets jets(const ChartBatch& c, double t) const {
    const Index n = c.size();
    std::vector<Vec3<detail::SpatialJet>> image;
    Mat3X y(3, n);
    for (Index i = 0; i < n; ++i) {
      image.push_back(gamma_(detail::chart_jet(c, i)));
      for (int k = 0; k < 3; ++k) y(k, i) = image.back()[k].f;
      y.col(i).normalize();
    }
    const ChartBatch there = charts_at(y);
    const SurfaceJets f = dsns::jets(*surface_, there, zeta_(t));
    SurfaceJets out(n);
    for (Index i = 0; i < n; ++i) {
      const auto& g = image[std::size_t(i)];
      const auto part = [&](const auto& pick) -> Eigen::Vector2d {
        const Vec3d d(pick(g[0]), pick(g[1]), pick(g[2]));
        return {there.e1.col(i).dot(d), there.e2.col(i).dot(d)};
      };
      const auto first = [&](const Eigen::Vector2d& p) -> Vec3d { return f.fu.col(i) * p[0] + f.fv.col(i) * p[1]; };
      const auto second = [&](const Eigen::Vector2d& p, const Eigen::Vector2d& q) -> Vec3d {
        return f.fuu.col(i) * (p[0] * q[0]) + f.fuv.col(i) * (p[0] * q[1] + p[1] * q[0]) + f.fvv.col(i) * (p[1] * q[1]);
      };
      const Eigen::Vector2d u = part([](const auto&x) { return x.g[0]; }),
                            v = part([](const auto&x) { return x.g[1]; });
      out.f.col(i) = rotation_ * f.f.col(i);
      out.fu.col(i) = rotation_ * first(u);
      out.fv.col(i) = rotation_ * first(v);
      out.fuu.col(i) = rotation_ * (second(u, u) + first(part([](const auto& x) { return x.h[0]; })));
      out.fuv.col(i) = rotation_ * (second(u, v) + first(part([](const auto& x) { return x.h[1]; })));
      out.fvv.col(i) = rotation_ * (second(v, v) + first(part([](const auto& x) { return x.h[2]; })));
    }
    return out;
  }

 private:
  const F* surface_;
  Mat3 rotation_;
  SphereDiffeomorphism gamma_;
  TimeWarp zeta_;
};

}  // namespace dsns
