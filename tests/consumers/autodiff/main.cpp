#include <dsns/autodiff/batch.hpp>
#include <dsns/autodiff/dual.hpp>
#include <dsns/autodiff/functions_on_tape.hpp>
#include <dsns/autodiff/jet2.hpp>
#include <dsns/autodiff/tape.hpp>

#ifdef EIGEN_WORLD_VERSION
#error "Eigen is here"
#endif

int main() {
  using namespace dsns;
  const auto f = [](const auto& x) { return x * x * x; };
  const auto jet = f(Jet2<double>::variable(2, 0));
  Tape<double> tape;
  const auto recording = tape.record();
  const auto v = tape.variable(2);
  tape.backward(preaccumulate(f, v));
  const auto batch = f(Dual<Batch<double>, 1>::variable(Batch<double>(2), 0));
  const bool right = jet.g[0] == 12 && jet.h[0] == 12 && tape.adjoint(v) == 12 && batch.g[0][1] == 12 &&
                     f(Dual<double>::variable(2, 0)).g[0] == 12;
  return right ? 0 : 1;
}
