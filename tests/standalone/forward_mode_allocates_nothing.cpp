// Counts what the forward scalars take from the heap: nothing. Fails by its exit status.
#include <dsns/autodiff/batch.hpp>
#include <dsns/autodiff/dual.hpp>
#include <dsns/autodiff/jet2.hpp>
#include <dsns/autodiff/tape.hpp>

#include <cstdio>
#include <cstdlib>
#include <new>

namespace {
std::size_t allocations = 0;
}

void* operator new(std::size_t size) {
  ++allocations;
  if (void* p = std::malloc(size)) return p;
  throw std::bad_alloc();
}
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }

template <class X>
X everything(const X& x) {
  using namespace dsns;
  return sin(x) * exp(x) / (1 + x * x) + pow(x, 3) - hypot(x, 2 * x) + atan2(x, x + 1) + softplus(x) * sqrt(x) -
         min(x, log(x)) + pow(x, x) + abs(-x) + erf(tanh(x));
}

int main() {
  using namespace dsns;
  double sum = 0;
  const std::size_t before = allocations;
  sum += everything(Dual<double, 3>::variable(0.7, 1)).g[1];
  sum += double(everything(Dual<float, 7>::variable(0.7f, 1)).g[1]);
  sum += everything(Jet2<double, 2>::variable(0.7, 0)).h[0];
  sum += everything(Jet2<double, 5>::variable(0.7, 4)).h[14];
  sum += everything(Dual<Dual<double, 2>, 2>::variable(Dual<double, 2>::variable(0.7, 0), 0)).g[0].g[0];
  sum += everything(Jet2<Batch<double, 2>, 2>::variable(Batch<double, 2>(0.7), 0)).h[0][1];
  const std::size_t forward = allocations - before;

  // A tape keeps its memory: the second recording of the same size takes none either.
  Tape<double> tape;
  std::size_t second = 0;
  for (int repeat = 0; repeat < 2; ++repeat) {
    const std::size_t start = allocations;
    const auto recording = tape.record();
    const auto x = tape.variable(0.7);
    Var<double> y = x;
    for (int i = 0; i < 1000; ++i) y = everything(y * 0.5 + 0.1) * 0.01 + x;
    for (int i = 0; i < 1000; ++i) y += x * x;
    tape.backward(y);
    sum += tape.adjoint(x);
    second = allocations - start;
  }
  std::printf("%zu allocations in forward mode, %zu in a second recording (sum %g)\n", forward, second, sum);
  return forward == 0 && second == 0 ? 0 : 1;
}
