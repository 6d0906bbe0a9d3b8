// benchmark of a training step: forward, loss, backward and RMSProp on one batch in single precision, in turns with libtorch
// on the same network and batch, on one thread and on two. Beside each: what the processor's fused multiply-adds could do
// at most, and what a plain matrix product of Eigen's does.
//   training_step [--json FILE]        {width: {threads: how many times as fast as libtorch}}, softplus
#include "../ratios.hpp"
#include "step.hpp"

#include <dsns/autodiff/batch.hpp>
#include <dsns/nn/encodings.hpp>
#include <dsns/nn/trainer.hpp>
#include <dsns/sphere/quadrature.hpp>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <functional>
#include <span>
#include <string>
#include <thread>
#include <vector>

namespace {

using namespace dsns;
using training_step::Workload;

/// One thread is timed by the process's time on the processor, several by the clock on the wall.
double clock_of(int threads) {
  if (threads == 1) return double(std::clock()) / CLOCKS_PER_SEC;
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double median(std::vector<double> v) {
  std::nth_element(v.begin(), v.begin() + std::ptrdiff_t(v.size() / 2), v.end());
  return v[v.size() / 2];
}

/// Seconds a call of each, in turns: medians over at least five turns and `budget` seconds.
std::vector<double> in_turns(int threads, double budget, const std::vector<std::function<void()>>& pieces) {
  std::vector<std::vector<double>> times(pieces.size());
  std::vector<int> calls;
  for (const auto& piece : pieces) {
    piece();
    const double start = clock_of(threads);
    piece();
    calls.push_back(std::max(1, int(0.05 / std::max(clock_of(threads) - start, 1e-9))));
  }
  const double stop = clock_of(threads) + budget;
  while (times[0].size() < 5 || clock_of(threads) < stop)
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      const double start = clock_of(threads);
      for (int i = 0; i < calls[k]; ++i) pieces[k]();
      times[k].push_back((clock_of(threads) - start) / calls[k]);
      // OpenBLAS's threads wait for more work in a loop, up to 2^26 clock cycles, and would take a core from the next piece.
      if (threads > 1) std::this_thread::sleep_for(std::chrono::milliseconds(60));
    }
  std::vector<double> medians;
  for (auto& t : times) medians.push_back(median(std::move(t)));
  return medians;
}

/// The batch of a step: the paper's embedding of points at times, and a position for each.
Workload workload(int width, int blocks, Activation activation, int batch) {
  const SurfaceEncoding encoding = paper_encoding();
  Workload w{{static_cast<int>(encoding.features()), width, blocks, 3, activation}, {}, {}, {}};
  w.parameters = Mlp<float>(w.shape, 1).parameters();
  const Mat3X points = fibonacci_sphere(batch).points;
  w.inputs.resize(encoding.features(), batch);
  w.targets.resize(3, batch);
  for (Index i = 0; i < batch; ++i) {
    const double t = double(i * 37 % batch) / batch;
    const Vec3d s = points.col(i);
    w.inputs.col(i) << encoding.space<double>(s).cast<float>(), encoding.time<double>(t).cast<float>();
    w.targets.col(i) = (s * (1 + 0.2 * std::sin(3 * s[0] + 6 * t))).cast<float>();
  }
  return w;
}

/// The workload as the trainer wants it.
struct Problem {
  static constexpr JetLayout layout = jet_layouts::value;
  const Workload* w;

  Index samples() const { return w->inputs.cols(); }
  void fill(std::span<const Index> samples, Eigen::MatrixXf& inputs) const {
    for (std::size_t j = 0; j < samples.size(); ++j) inputs.col(Index(j)) = w->inputs.col(samples[j]);
  }
  TileLoss<float> loss(MatrixTape<float>& tape, MatrixTape<float>::Node y, std::span<const Index> samples) const {
    Eigen::MatrixXf target(3, Index(samples.size()));
    for (std::size_t j = 0; j < samples.size(); ++j) target.col(Index(j)) = w->targets.col(samples[j]);
    const auto node = tape.scale(tape.squared_error(y, target), 1.0f / 3);
    return {node, double(tape.value(node)(0, 0))};
  }
};

/// Multiply-adds of a step count twice. The inputs need no gradient.
double operations(const MlpShape& shape, Index batch) {
  double weights = 0;
  for (int l = 0; l < shape.layers(); ++l) weights += double(shape.rows(l)) * shape.cols(l);
  return 2 * double(batch) * (3 * weights - double(shape.rows(0)) * shape.cols(0));
}

/// Fused multiply-adds in registers alone, a million times those of a register.
void multiply_add() {
  using B = Batch<float>;
  constexpr int chains = 12;
  B sums[chains];
  for (int k = 0; k < chains; ++k) sums[k] = B(float(k));
  B factor(0.999f), term(1e-3f);
  asm volatile("" : "+m"(factor), "+m"(term));
  for (int i = 0; i < 1000000 / chains; ++i)
    for (B& s : sums) s = s * factor + term;
  for (B& s : sums) asm volatile("" : : "m"(s));
}
constexpr double multiply_add_operations = 2.0 * (1000000 / 12) * 12 * native_lanes<float>;

Results results;

void measure(int width, int blocks, Activation activation, int batch, int threads, double budget) {
  const Workload w = workload(width, blocks, activation, batch);
  const Problem problem{&w};
  TrainerOptions options;
  options.batch = batch;
  options.threads = threads;
  options.optimizer.kind = OptimizerKind::rmsprop;
  Trainer<float, Problem> trainer(problem, Mlp<float>(w.shape, w.parameters), options);
  training_step::set_libtorch_threads(threads);
  const std::function<double()> libtorch = training_step::libtorch_step(w);
  const double loss = trainer.step(w.rate);
  if (libtorch) {
    const double theirs = libtorch();
    if (!(std::abs(loss - theirs) < 1e-5 * theirs)) std::printf("the losses differ: %.9g and %.9g\n", loss, theirs);
  }

  constexpr Index columns = 512;
  const Eigen::MatrixXf a = Eigen::MatrixXf::Random(width, width), b = Eigen::MatrixXf::Random(width, columns);
  std::vector<Eigen::MatrixXf> products(std::size_t(threads), Eigen::MatrixXf(width, columns));
  const auto on_all = [&](const auto& body) { return [&, body] { parallel_for(threads, threads, body); }; };
  std::vector<std::function<void()>> pieces = {[&] { trainer.step(w.rate); }, on_all([&](int k) {
                                                 auto& product = products[std::size_t(k)];
                                                 for (int i = 0; i < (1 << 22) / (width * width) + 1; ++i)
                                                   product.noalias() = a * b;
                                               }),
                                               on_all([](int) { multiply_add(); })};
  if (libtorch) pieces.push_back([&] { libtorch(); });
  const std::vector<double> t = in_turns(threads, budget, pieces);

  const double speed = 1e-9 * operations(w.shape, batch) / t[0];
  const double product = 1e-9 * threads * 2.0 * width * width * columns * ((1 << 22) / (width * width) + 1) / t[1];
  const double peak = 1e-9 * threads * multiply_add_operations / t[2];
  const char* const name = activation == Activation::silu ? "silu" : "softplus";
  std::printf(
      "%5d x %d %-8s batch %5d, %d threads: %9.2f ms, %6.1f GFLOP/s, %4.2f of the peak of %.0f, %4.2f of a product's",
      width, blocks, name, batch, threads, 1e3 * t[0], speed, speed / peak, peak, speed / product);
  if (libtorch) std::printf("; libtorch %9.2f ms: %.2f x", 1e3 * t[3], t[3] / t[0]);
  std::printf("\n");
  std::fflush(stdout);
  if (libtorch && activation == Activation::softplus)
    results[std::to_string(width)][std::to_string(threads)] = t[3] / t[0];
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 1 && (argc != 3 || std::strcmp(argv[1], "--json") != 0)) {
    std::fprintf(stderr, "usage: %s [--json FILE]\n", argv[0]);
    return 2;
  }
  for (const Activation activation : {Activation::softplus, Activation::silu})
    for (const int width : {64, 128, 256})
      for (const int threads : {1, 2}) measure(width, 2, activation, 8192, threads, 2);
  for (const int threads : {1, 2}) measure(1024, 6, Activation::softplus, 2048, threads, 5);
  return argc < 3 || write_json(results, argv[2]) ? 0 : 1;
}
