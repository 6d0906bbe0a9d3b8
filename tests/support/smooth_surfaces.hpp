#pragma once
/// Closed smooth surfaces of every kind, for laws of differential geometry.
#include <dsns/elastic/registered_surface.hpp>
#include <dsns/nn/neural_surface.hpp>
#include <dsns/surface/analytic.hpp>
#include <dsns/surface/any_surface.hpp>
#include <dsns/surface/harmonic.hpp>

#include "support/surfaces.hpp"

#include <functional>
#include <memory>
#include <stdexcept>

namespace dsns::test {

inline LimbedBody two_limbs() {
  LimbedBody body;
  body.axes = {1, 0.8, 0.6};
  body.limbs = {{Vec3d(1, 1, 0).normalized(), 5, Vec3d(0.6, 0.3, 0.2), Vec3d(0, 0.2, 0.1), 0.2},
                {Vec3d(-1, 0.2, 0.4).normalized(), 4, Vec3d(-0.4, 0.1, 0.1)}};
  body.pace = 0.3;
  return body;
}

/// A moving formula at one time, with any scalar.
struct StillBody {
  LimbedBody body = two_limbs();
  double t = 0.3;
  template <class T>
  Vec3<T> operator()(const Vec3<T>& s) const {
    return body(s, T(t));
  }
};

/// The sphere displaced by a random network: jets in tiles, and any scalar.
struct NeuralBody {
  NeuralSurface network = [] {
    SurfaceEncoding encoding;
    encoding.harmonic_degree = 2;
    encoding.time_frequencies = 1;
    MlpShape shape;
    shape.inputs = static_cast<int>(encoding.features());
    shape.width = 8;
    shape.blocks = 1;
    return NeuralSurface(encoding, Mlp<double>(shape, 5), Vec3d::Zero(), 1.5);
  }();

  template <class T>
  Vec3<T> operator()(const Vec3<T>& s) const {
    return s + network(s, T(0.4));
  }
  SurfaceJets jets(const ChartBatch& c) const {
    SurfaceJets j = network.jets(c, 0.4);
    j.f += c.s;
    j.fu += c.e1;
    j.fv += c.e2;
    j.fuu -= c.s;  // s_uu = s_vv = -s
    j.fvv -= c.s;
    return j;
  }
};

inline HarmonicSurface bumpy_harmonics() {
  Eigen::MatrixX3d c = Eigen::MatrixX3d::Zero(harmonic_count(3), 3);
  for (Index i = 0; i < c.size(); ++i) c.reshaped()[i] = 0.08 * std::sin(3.7 * double(i + 1));
  const double unit = std::sqrt(4 * pi / 3);  // Y_1 = sqrt(3 / 4 pi) (y, z, x)
  c(3, 0) += unit;
  c(1, 1) += unit;
  c(2, 2) += 1.3 * unit;
  return HarmonicSurface(c);
}

inline RegisteredSurface<LimbedBody> registered_limbs() {
  static const LimbedBody body = two_limbs();
  return {body, rotation_exp(Vec3d(0.3, 0.2, -0.9)), random_diffeomorphism(2, 3, 0.08)};
}

/// Two outer variables around two inner ones: what differentiates a metric twice.
using MetricScalar = Dual<Jet2<double>, 2>;

/// Any resting surface behind one type, so that a law is compiled once and not for each of them. Derivatives are the
/// surface's own.
class AnySurface {
 public:
  template <class S>
  requires(Surface<S> && !std::is_same_v<S, AnySurface>) explicit AnySurface(S surface)
      : surface_(std::make_shared<Model<S>>(std::move(surface))) {}

  Vec3d operator()(const Vec3d& s) const { return surface_->value(s); }
  Vec3<detail::SpatialJet> operator()(const Vec3<detail::SpatialJet>& s) const { return surface_->value(s); }
  Vec3<MetricScalar> operator()(const Vec3<MetricScalar>& s) const { return surface_->value(s); }
  SurfaceJets jets(const ChartBatch& c) const { return surface_->jets(c); }
  SurfaceTangents tangents(const ChartBatch& c) const { return surface_->tangents(c); }
  Mat3X positions(const Mat3X& s) const { return surface_->positions(s); }

 private:
  struct Interface {
    virtual ~Interface() = default;
    virtual Vec3d value(const Vec3d& s) const = 0;
    virtual Vec3<detail::SpatialJet> value(const Vec3<detail::SpatialJet>& s) const = 0;
    virtual Vec3<MetricScalar> value(const Vec3<MetricScalar>& s) const = 0;
    virtual SurfaceJets jets(const ChartBatch& c) const = 0;
    virtual SurfaceTangents tangents(const ChartBatch& c) const = 0;
    virtual Mat3X positions(const Mat3X& s) const = 0;
  };
  template <class S>
  struct Model final : Interface {
    explicit Model(S s) : surface(std::move(s)) {}
    Vec3d value(const Vec3d& s) const override { return surface(s); }
    Vec3<detail::SpatialJet> value(const Vec3<detail::SpatialJet>& s) const override { return called(s); }
    Vec3<MetricScalar> value(const Vec3<MetricScalar>& s) const override { return called(s); }
    SurfaceJets jets(const ChartBatch& c) const override { return dsns::jets(surface, c); }
    SurfaceTangents tangents(const ChartBatch& c) const override { return dsns::tangents(surface, c); }
    Mat3X positions(const Mat3X& s) const override { return dsns::positions(surface, s); }

    template <class T>
    Vec3<T> called(const Vec3<T>& s) const {
      if constexpr (requires {
                      { surface(s) } -> std::same_as<Vec3<T>>;
                    })
        return surface(s);
      else
        throw std::logic_error("this surface knows its derivatives in batches only");
    }
    S surface;
  };

  std::shared_ptr<const Interface> surface_;
};

using SurfaceVisitor = std::function<void(const std::string&, const AnySurface&)>;

/// Calls visit(name, surface) for surfaces that take the scalars of AnySurface.
inline void visit_formulas(const SurfaceVisitor& visit) {
  for_each_surface([&](const std::string& name, const auto& surface) { visit(name, AnySurface(surface)); });
  visit("two limbs", AnySurface(StillBody{}));
  visit("harmonics", AnySurface(bumpy_harmonics()));
  visit("network", AnySurface(NeuralBody{}));
}

/// Those and views of moving surfaces.
inline void visit_smooth_surfaces(const SurfaceVisitor& visit) {
  visit_formulas(visit);
  visit("at a time", AnySurface(at_time(two_limbs(), 0.6)));
  visit("registered", AnySurface(at_time(registered_limbs(), 0.6)));
}

using MotionVisitor = std::function<void(const std::string&, const AnyAnimatedSurface&)>;

/// Calls visit(name, surface) for moving surfaces of every kind, analytic and registered.
inline void visit_motions(const MotionVisitor& visit) {
  for_each_moving_surface(
      [&](const std::string& name, const auto& surface) { visit(name, AnyAnimatedSurface(surface)); });
  visit("two limbs", AnyAnimatedSurface(two_limbs()));
  visit("registered", AnyAnimatedSurface(registered_limbs()));
}

/// Charts at the same points with every frame turned by `angle`.
inline ChartBatch turned_frames(const ChartBatch& c, double angle) {
  return {c.s, std::cos(angle) * c.e1 + std::sin(angle) * c.e2, std::cos(angle) * c.e2 - std::sin(angle) * c.e1};
}

/// The largest entry of a - b, of the size of b where that is above 1.
template <class A, class B>
double difference(const A& a, const B& b) {
  return (a - b).cwiseAbs().maxCoeff() / std::max(1.0, b.cwiseAbs().maxCoeff());
}

}  // namespace dsns::test
