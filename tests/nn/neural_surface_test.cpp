#include "catch.hpp"

#include <dsns/nn/neural_surface.hpp>

#include <random>

namespace neural_surface_test {

using namespace dsns;

namespace {

/// The same surface without its batch members: the generic scalar path.
struct ScalarOnly {
  NeuralSurface surface;
  template <class T>
  Vec3<T> operator()(const Vec3<T>& s, const T& t) const {
    return surface(s, t);
  }
};
static_assert(AnimatedSurface<ScalarOnly>);

NeuralSurface small_surface(const SurfaceEncoding& encoding) {
  MlpShape shape;
  shape.inputs = static_cast<int>(encoding.features());
  shape.width = 16;
  return {encoding, Mlp<double>(shape, 9), Vec3d(1, -2, 3), 2.5};
}

ChartBatch charts() {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  Mat3X s(3, 70);  // more than two tiles of jets
  for (double& x : s.reshaped()) x = normal(random);
  s.colwise().normalize();
  s.col(0) = Vec3d::UnitZ();
  s.col(1) = -Vec3d::UnitZ();
  return charts_at(s);
}

double distance(const Mat3X& a, const Mat3X& b) { return (a - b).cwiseAbs().maxCoeff(); }

}  // namespace

TEST_CASE("neural surface: batches equal the scalar path, poles included", "[nn]") {
  SurfaceEncoding mixed;
  mixed.harmonic_degree = 4;
  mixed.space_octaves = 2;
  mixed.time_octaves = 3;
  const auto encoding = GENERATE_COPY(SurfaceEncoding(), mixed);
  const ScalarOnly oracle{small_surface(encoding)};
  const NeuralSurface& surface = oracle.surface;
  const ChartBatch c = charts();
  const double t = 0.37;
  CHECK(distance(surface.positions(c.s, t), positions(oracle, c.s, t)) < 1e-12);
  CHECK(distance(surface.velocities(c.s, t), velocities(oracle, c.s, t)) < 1e-11);
  const SurfaceJets a = surface.jets(c, t), b = jets(oracle, c, t);
  CHECK(distance(a.f, b.f) < 1e-12);
  CHECK(distance(a.fu, b.fu) < 1e-11);
  CHECK(distance(a.fv, b.fv) < 1e-11);
  CHECK(distance(a.fuu, b.fuu) < 1e-10);
  CHECK(distance(a.fuv, b.fuv) < 1e-10);
  CHECK(distance(a.fvv, b.fvv) < 1e-10);
  const SurfaceTangents first = surface.tangents(c, t);
  CHECK(distance(first.f, b.f) < 1e-12);
  CHECK(distance(first.fu, b.fu) < 1e-11);
  CHECK(distance(first.fv, b.fv) < 1e-11);
  const MotionJets m = surface.motion_jets(c, t), n = motion_jets(oracle, c, t);
  CHECK(distance(m.fv, n.fv) < 1e-11);
  CHECK(distance(m.ft, n.ft) < 1e-11);
  CHECK(distance(m.ftu, n.ftu) < 1e-10);
  CHECK(distance(m.ftv, n.ftv) < 1e-10);
}

TEST_CASE("neural surface: single precision keeps five digits of values and tangents", "[nn]") {
  const NeuralSurface exact = small_surface(SurfaceEncoding());
  const BasicNeuralSurface<float> surface(exact.encoding(), exact.network().cast<float>(), exact.translation(),
                                          exact.scale());
  const ChartBatch c = charts();
  const SurfaceJets a = surface.jets(c, 0.37), b = exact.jets(c, 0.37);
  const double unit = exact.scale();
  CHECK(distance(a.f, b.f) < 2e-5 * unit);
  CHECK(distance(surface.tangents(c, 0.37).fu, b.fu) < 2e-5 * b.fu.cwiseAbs().maxCoeff());
  CHECK(distance(a.fuv, b.fuv) < 2e-5 * b.fuv.cwiseAbs().maxCoeff());
  CHECK(distance(a.f, b.f) > 1e-9 * unit);  // it is single precision
}

TEST_CASE("neural surface: jets and velocities against central differences along great circles", "[nn]") {
  const NeuralSurface surface = small_surface(SurfaceEncoding());
  const ChartBatch c = charts();
  const double t = 0.6, h = 1e-4;
  const auto moved = [&](double u, double v) {
    const double angle = std::hypot(u, v);
    const Mat3X direction = angle > 0 ? Mat3X((u * c.e1 + v * c.e2) / angle) : c.e1;
    return surface.positions(std::cos(angle) * c.s + std::sin(angle) * direction, t);
  };
  const SurfaceJets jet = surface.jets(c, t);
  const double size = jet.fuu.cwiseAbs().maxCoeff();
  CHECK(distance(jet.fu, (moved(h, 0) - moved(-h, 0)) / (2 * h)) < 1e-5 * size);
  CHECK(distance(jet.fvv, (moved(0, h) - 2 * moved(0, 0) + moved(0, -h)) / (h * h)) < 1e-4 * size);
  CHECK(distance(jet.fuv, (moved(h, h) - moved(h, -h) - moved(-h, h) + moved(-h, -h)) / (4 * h * h)) < 1e-4 * size);
  const Mat3X slope = (surface.positions(c.s, t + h) - surface.positions(c.s, t - h)) / (2 * h);
  CHECK(distance(surface.velocities(c.s, t), slope) < 1e-4 * slope.cwiseAbs().maxCoeff());
}

TEST_CASE("neural surface: a network of other inputs is refused", "[nn]") {
  CHECK_THROWS_AS(NeuralSurface(SurfaceEncoding(), Mlp<double>(MlpShape())), InvalidArgument);
}

}  // namespace neural_surface_test
