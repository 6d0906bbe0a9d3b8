// benchmark of the geometry: microseconds a point for values, first and second derivatives of surfaces, timed in turns with
// a plain evaluation (networks), code written by hand (ellipsoid) or a straightforward implementation (harmonics).
//   geometry [--json FILE]        {surface: {order: ratio}}
#include "harmonics_reference.hpp"
#include "ratios.hpp"

#include <dsns/nn/neural_surface.hpp>
#include <dsns/sphere/harmonics.hpp>
#include <dsns/sphere/quadrature.hpp>
#include <dsns/surface/analytic.hpp>

#include <cstdio>
#include <cstring>
#include <string>

namespace {

using namespace dsns;

/// What keeps the compiler from leaving a computation out.
volatile double sink;

Results results;

template <class A, class B>
void measure(const char* surface, const char* order, const char* against, Index points, const A& a, const B& b) {
  const Timing t = side_by_side(a, b);
  std::printf("%-24s %-8s %9.4f us a point %8.3f x %s\n", surface, order, t.microseconds / double(points), t.ratio,
              against);
  std::fflush(stdout);
  results[surface][order] = t.ratio;
}

struct ByHand {
  Vec3d axes;

  void value(const ChartBatch& c, SurfaceJets& out) const {
    for (Index i = 0; i < c.size(); ++i) out.f.col(i) = axes.cwiseProduct(c.s.col(i));
  }
  void first(const ChartBatch& c, SurfaceJets& out) const {
    value(c, out);
    for (Index i = 0; i < c.size(); ++i) {
      out.fu.col(i) = axes.cwiseProduct(c.e1.col(i));
      out.fv.col(i) = axes.cwiseProduct(c.e2.col(i));
    }
  }
  void second(const ChartBatch& c, SurfaceJets& out) const {
    first(c, out);
    for (Index i = 0; i < c.size(); ++i) out.fuu.col(i) = out.fvv.col(i) = -out.f.col(i);
    out.fuv.setZero();
  }
};

void ellipsoid() {
  const ChartBatch c = charts_at(fibonacci_sphere(4096).points);
  const Ellipsoid e{1, 2, 5};
  const ByHand hand{{1, 2, 5}};
  const auto by_hand = [&](auto order) {
    return [&, order] {
      SurfaceJets out(c.size());
      (hand.*order)(c, out);
      sink = out.f(0, 0);
    };
  };
  measure(
      "ellipsoid", "value", "by hand", c.size(), [&] { sink = positions(e, c.s)(0, 0); }, by_hand(&ByHand::value));
  measure(
      "ellipsoid", "first", "by hand", c.size(), [&] { sink = tangents(e, c).f(0, 0); }, by_hand(&ByHand::first));
  measure(
      "ellipsoid", "second", "by hand", c.size(), [&] { sink = jets(e, c).f(0, 0); }, by_hand(&ByHand::second));
}

template <class T>
void network(const char* name, const SurfaceEncoding& encoding, int width, int blocks, Activation activation,
             int points) {
  const MlpShape shape{static_cast<int>(encoding.features()), width, blocks, 3, activation};
  const BasicNeuralSurface<T> surface(encoding, Mlp<T>(shape, 1));
  const ChartBatch c = charts_at(fibonacci_sphere(points).points);
  const auto plain = [&] { sink = surface.positions(c.s, 0.5)(0, 0); };
  measure(name, "value", "plain evaluation", points, plain, plain);
  measure(
      name, "first", "plain evaluation", points, [&] { sink = surface.tangents(c, 0.5).f(0, 0); }, plain);
  measure(
      name, "second", "plain evaluation", points, [&] { sink = surface.jets(c, 0.5).f(0, 0); }, plain);
}

void harmonic_basis(int degree) {
  const ChartBatch c = charts_at(fibonacci_sphere(1024).points);
  const std::string name = "harmonics_" + std::to_string(degree);
  const auto reference = [&](Index first) {
    sink = reference::harmonic_jets(c.s.middleCols(first, 32), degree).y(0, 0);
  };
  const auto tiles = [&](const auto& body) {
    return [&] {
      for (Index first = 0; first < c.size(); first += 32) body(first);
    };
  };
  HarmonicJets storage;
  const auto ours = [&](Index first) {
    const ChartBatch tile{c.s.middleCols(first, 32), c.e1.middleCols(first, 32), c.e2.middleCols(first, 32)};
    storage = harmonic_jets(tile, degree, std::move(storage));
    sink = storage.y(0, 0);
  };
  measure(name.c_str(), "second", "straightforward", c.size(), tiles(ours), tiles(reference));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 1 && (argc != 3 || std::strcmp(argv[1], "--json") != 0)) {
    std::fprintf(stderr, "usage: %s [--json FILE]\n", argv[0]);
    return 2;
  }
  ellipsoid();
  network<double>("network_64x2", {}, 64, 2, Activation::silu, 4096);
  network<float>("network_64x2_float", {}, 64, 2, Activation::silu, 4096);
  network<double>("network_128x2", {}, 128, 2, Activation::silu, 2048);
  network<float>("network_128x2_float", {}, 128, 2, Activation::silu, 2048);
  network<float>("network_paper_float", paper_encoding(), 1024, 6, Activation::softplus, 96);
  network<double>("network_paper", paper_encoding(), 1024, 6, Activation::softplus, 96);
  harmonic_basis(30);
  return argc < 3 || write_json(results, argv[2]) ? 0 : 1;
}
