#pragma once
/// Closed smooth surfaces of every kind, for laws of differential geometry.
#include <dsns/elastic/registered_surface.hpp>
#include <dsns/nn/neural_surface.hpp>
#include <dsns/surface/analytic.hpp>
#include <dsns/surface/harmonic.hpp>

#include "support/surfaces.hpp"

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

/// Calls visit(name, surface) for surfaces that take any scalar.
template <class Visit>
void visit_formulas(const Visit& visit) {
  for_each_surface(visit);
  visit("two limbs", StillBody{});
  visit("harmonics", bumpy_harmonics());
  visit("network", NeuralBody{});
}

/// Those and views of moving surfaces.
template <class Visit>
void visit_smooth_surfaces(const Visit& visit) {
  visit_formulas(visit);
  const LimbedBody body = two_limbs();
  visit("at a time", at_time(body, 0.6));
  const RegisteredSurface view(body, rotation_exp(Vec3d(0.3, 0.2, -0.9)), random_diffeomorphism(2, 3, 0.08));
  visit("registered", at_time(view, 0.6));
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
