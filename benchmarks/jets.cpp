// What derivatives cost: microseconds a point for values and for second-order jets, and their ratio.
#include <dsns/nn/neural_surface.hpp>
#include <dsns/sphere/quadrature.hpp>
#include <dsns/surface/analytic.hpp>
#include <dsns/surface/harmonic.hpp>

#include <benchmark/benchmark.h>

namespace {

using namespace dsns;

const ChartBatch& charts() {
  static const ChartBatch c = charts_at(fibonacci_sphere(4096).points);
  return c;
}

template <class S>
void values(benchmark::State& state, const S& surface) {
  for (auto _ : state) benchmark::DoNotOptimize(positions(surface, charts().s));
  state.counters["us/point"] = benchmark::Counter(double(state.iterations()) * 4096e-6,
                                                  benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
template <class S>
void second_order(benchmark::State& state, const S& surface) {
  for (auto _ : state) benchmark::DoNotOptimize(jets(surface, charts()));
  state.counters["us/point"] = benchmark::Counter(double(state.iterations()) * 4096e-6,
                                                  benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

const HarmonicSurface& harmonic() {
  static const HarmonicSurface f(Eigen::MatrixX3d::Random(harmonic_count(16), 3));
  return f;
}
const NeuralSurface& network() {
  static const NeuralSurface f({}, Mlp<double>({static_cast<int>(SurfaceEncoding{}.features()), 64, 2, 3}, 1));
  return f;
}

}  // namespace

BENCHMARK_CAPTURE(values, ellipsoid, Ellipsoid{1, 2, 5});
BENCHMARK_CAPTURE(second_order, ellipsoid, Ellipsoid{1, 2, 5});
BENCHMARK_CAPTURE(values, harmonics_of_degree_16, harmonic());
BENCHMARK_CAPTURE(second_order, harmonics_of_degree_16, harmonic());
BENCHMARK_CAPTURE(values, network_64x2, at_time(network(), 0.5));
BENCHMARK_CAPTURE(second_order, network_64x2, at_time(network(), 0.5));
BENCHMARK_MAIN();
