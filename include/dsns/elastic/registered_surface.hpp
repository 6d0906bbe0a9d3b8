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

  SurfaceJets jets(const ChartBatch& c, double t) const {
    const Image image(gamma_, c);
    const SurfaceJets f = dsns::jets(*surface_, image.charts, zeta_(t));
    SurfaceJets out(c.size());
    for (Index i = 0; i < c.size(); ++i) {
      const auto first = [&](const Eigen::Vector2d& p) -> Vec3d { return f.fu.col(i) * p[0] + f.fv.col(i) * p[1]; };
      const auto second = [&](const Eigen::Vector2d& p, const Eigen::Vector2d& q) -> Vec3d {
        return f.fuu.col(i) * (p[0] * q[0]) + f.fuv.col(i) * (p[0] * q[1] + p[1] * q[0]) + f.fvv.col(i) * (p[1] * q[1]);
      };
      const Eigen::Vector2d u = image.u.col(i), v = image.v.col(i);
      out.f.col(i) = rotation_ * f.f.col(i);
      out.fu.col(i) = rotation_ * first(u);
      out.fv.col(i) = rotation_ * first(v);
      out.fuu.col(i) = rotation_ * (second(u, u) + first(image.uu.col(i)));
      out.fuv.col(i) = rotation_ * (second(u, v) + first(image.uv.col(i)));
      out.fvv.col(i) = rotation_ * (second(v, v) + first(image.vv.col(i)));
    }
    return out;
  }

  MotionJets motion_jets(const ChartBatch& c, double t) const {
    const Image image(gamma_, c);
    const MotionJets f = dsns::motion_jets(*surface_, image.charts, zeta_(t));
    const Mat3 rate = zeta_.slope(t) * rotation_;
    MotionJets out(c.size());
    for (Index i = 0; i < c.size(); ++i) {
      const Eigen::Vector2d u = image.u.col(i), v = image.v.col(i);
      out.f.col(i) = rotation_ * f.f.col(i);
      out.fu.col(i) = rotation_ * (f.fu.col(i) * u[0] + f.fv.col(i) * u[1]);
      out.fv.col(i) = rotation_ * (f.fu.col(i) * v[0] + f.fv.col(i) * v[1]);
      out.ft.col(i) = rate * f.ft.col(i);
      out.ftu.col(i) = rate * (f.ftu.col(i) * u[0] + f.ftv.col(i) * u[1]);
      out.ftv.col(i) = rate * (f.ftu.col(i) * v[0] + f.ftv.col(i) * v[1]);
    }
    return out;
  }

 private:
  /// y = gamma(s(u, v)) written in the chart of y as p e1 + q e2: p_u = e1 . y_u and p_uu = e1 . y_uu, because the chart's
  /// second derivatives have no tangential part. Each field 2 x n: the derivatives of (p, q).
  struct Image {
    ChartBatch charts;
    Eigen::Matrix2Xd u, v, uu, uv, vv;

    Image(const SphereDiffeomorphism& gamma, const ChartBatch& c)
        : u(2, c.size()), v(2, c.size()), uu(2, c.size()), uv(2, c.size()), vv(2, c.size()) {
      std::vector<Vec3<detail::SpatialJet>> image;
      Mat3X y(3, c.size());
      for (Index i = 0; i < c.size(); ++i) {
        image.push_back(gamma(detail::chart_jet(c, i)));
        for (int k = 0; k < 3; ++k) y(k, i) = image.back()[k].f;
        y.col(i).normalize();
      }
      charts = charts_at(y);
      for (Index i = 0; i < c.size(); ++i) {
        const auto& g = image[std::size_t(i)];
        const auto part = [&](const auto& pick) -> Eigen::Vector2d {
          const Vec3d d(pick(g[0]), pick(g[1]), pick(g[2]));
          return {charts.e1.col(i).dot(d), charts.e2.col(i).dot(d)};
        };
        u.col(i) = part([](const auto& x) { return x.g[0]; });
        v.col(i) = part([](const auto& x) { return x.g[1]; });
        uu.col(i) = part([](const auto& x) { return x.h[0]; });
        uv.col(i) = part([](const auto& x) { return x.h[1]; });
        vv.col(i) = part([](const auto& x) { return x.h[2]; });
      }
    }
  };

  const F* surface_;
  Mat3 rotation_;
  SphereDiffeomorphism gamma_;
  TimeWarp zeta_;
};

}  // namespace dsns
