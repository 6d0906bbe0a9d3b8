#pragma once
/// Any moving surface behind one type, for programs that choose the representation at run time.
#include <dsns/surface/jets.hpp>

#include <memory>
#include <type_traits>
#include <utility>

namespace dsns {

/// Owns a moving surface; copies share it. Every call is one virtual call a batch.
class AnyAnimatedSurface {
 public:
  template <class F>
  requires(AnimatedSurface<F> && !std::is_same_v<F, AnyAnimatedSurface>) explicit AnyAnimatedSurface(F surface)
      : surface_(std::make_shared<Model<F>>(std::move(surface))) {}

  Vec3d operator()(const Vec3d& s, double t) const { return surface_->value(s, t); }
  Mat3X positions(const Mat3X& s, double t) const { return surface_->positions(s, t); }
  Mat3X velocities(const Mat3X& s, double t) const { return surface_->velocities(s, t); }
  SurfaceJets jets(const ChartBatch& c, double t) const { return surface_->jets(c, t); }
  SurfaceTangents tangents(const ChartBatch& c, double t) const { return surface_->tangents(c, t); }
  MotionJets motion_jets(const ChartBatch& c, double t) const { return surface_->motion_jets(c, t); }

 private:
  struct Interface {
    virtual ~Interface() = default;
    virtual Vec3d value(const Vec3d& s, double t) const = 0;
    virtual Mat3X positions(const Mat3X& s, double t) const = 0;
    virtual Mat3X velocities(const Mat3X& s, double t) const = 0;
    virtual SurfaceJets jets(const ChartBatch& c, double t) const = 0;
    virtual SurfaceTangents tangents(const ChartBatch& c, double t) const = 0;
    virtual MotionJets motion_jets(const ChartBatch& c, double t) const = 0;
  };
  template <class F>
  struct Model final : Interface {
    explicit Model(F f) : surface(std::move(f)) {}
    Vec3d value(const Vec3d& s, double t) const override { return surface(s, t); }
    Mat3X positions(const Mat3X& s, double t) const override { return dsns::positions(surface, s, t); }
    Mat3X velocities(const Mat3X& s, double t) const override { return dsns::velocities(surface, s, t); }
    SurfaceJets jets(const ChartBatch& c, double t) const override { return dsns::jets(surface, c, t); }
    SurfaceTangents tangents(const ChartBatch& c, double t) const override { return dsns::tangents(surface, c, t); }
    MotionJets motion_jets(const ChartBatch& c, double t) const override { return dsns::motion_jets(surface, c, t); }
    F surface;
  };

  std::shared_ptr<const Interface> surface_;
};

static_assert(AnimatedSurface<AnyAnimatedSurface>);

}  // namespace dsns
