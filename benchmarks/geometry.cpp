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

/// Keeps the compiler from leaving out what made the field.
void keep(const Eigen::Ref<const Eigen::MatrixXd>& field) { asm volatile("" : : "r"(field.data()) : "memory"); }

Results results;

template <class A, class B>
void measure(const char* surface, const char* order, const char* against, Index points, const A& a, const B& b) {
  const Timing t = side_by_side(a, b);
  std::printf("%-24s %-8s %9.4f us a point %8.3f x %s\n", surface, order, t.microseconds / double(points), t.ratio,
              against);
  std::fflush(stdout);
  results[surface][order] = t.ratio;
}

void ellipsoid() {
  const ChartBatch c = charts_at(fibonacci_sphere(4096).points);
  const Ellipsoid e{1, 2, 5};
  const Vec3d axes(1, 2, 5);
  const auto stretch = [&](const Mat3X& from, Mat3X& to) {
    for (Index i = 0; i < from.cols(); ++i) to.col(i) = axes.cwiseProduct(from.col(i));
  };
  const auto value = [&] {
    Mat3X out(3, c.size());
    stretch(c.s, out);
    keep(out);
  };
  const auto first = [&] {
    SurfaceTangents out(c.size());
    stretch(c.s, out.f);
    stretch(c.e1, out.fu);
    stretch(c.e2, out.fv);
    keep(out.f);
  };
  const auto second = [&] {
    SurfaceJets out(c.size());
    stretch(c.s, out.f);
    stretch(c.e1, out.fu);
    stretch(c.e2, out.fv);
    for (Index i = 0; i < c.size(); ++i) out.fuu.col(i) = out.fvv.col(i) = -out.f.col(i);
    out.fuv.setZero();
    keep(out.f);
  };
  measure(
      "ellipsoid", "value", "by hand", c.size(), [&] { keep(positions(e, c.s)); }, value);
  measure(
      "ellipsoid", "first", "by hand", c.size(), [&] { keep(tangents(e, c).f); }, first);
  measure(
      "ellipsoid", "second", "by hand", c.size(), [&] { keep(jets(e, c).f); }, second);
}

template <class T>
void network(const char* name, const SurfaceEncoding& encoding, int width, int blocks, Activation activation,
             int points) {
  const MlpShape shape{static_cast<int>(encoding.features()), width, blocks, 3, activation};
  const BasicNeuralSurface<T> surface(encoding, Mlp<T>(shape, 1));
  const ChartBatch c = charts_at(fibonacci_sphere(points).points);
  const auto plain = [&] { keep(surface.positions(c.s, 0.5)); };
  measure(name, "value", "plain evaluation", points, plain, plain);
  measure(
      name, "first", "plain evaluation", points, [&] { keep(surface.tangents(c, 0.5).f); }, plain);
  measure(
      name, "second", "plain evaluation", points, [&] { keep(surface.jets(c, 0.5).f); }, plain);
}

void harmonic_basis(int degree) {
  const ChartBatch c = charts_at(fibonacci_sphere(1024).points);
  const std::string name = "harmonics_" + std::to_string(degree);
  const auto reference = [&](Index first) { keep(reference::harmonic_jets(c.s.middleCols(first, 32), degree).y); };
  const auto tiles = [&](const auto& body) {
    return [&] {
      for (Index first = 0; first < c.size(); first += 32) body(first);
    };
  };
  HarmonicJets storage;
  const auto ours = [&](Index first) {
    const ChartBatch tile{c.s.middleCols(first, 32), c.e1.middleCols(first, 32), c.e2.middleCols(first, 32)};
    storage = harmonic_jets(tile, degree, std::move(storage));
    keep(storage.y);
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
