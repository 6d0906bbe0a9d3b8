// ADOL-C's reverse mode on its tape, recorded anew for every gradient, as ours is.
#include "methods.hpp"

#ifdef DSNS_WITH_ADOLC
#include <adolc/adolc.h>

#include <array>

namespace {

/// Value, gradient and Hessian over adouble, as far as the network needs it: ADOL-C has no second order by types.
struct SecondOrder {
  adouble f;
  std::array<adouble, 2> g;
  std::array<adouble, 3> h;

  SecondOrder() = default;
  SecondOrder(const adouble& x) : f(x) { clear(); }
  SecondOrder(double x) : f(x) { clear(); }
  void clear() {
    for (adouble& x : g) x = 0.0;
    for (adouble& x : h) x = 0.0;
  }
  SecondOrder& operator+=(const SecondOrder& x) {
    f += x.f;
    for (std::size_t i = 0; i < 2; ++i) g[i] += x.g[i];
    for (std::size_t i = 0; i < 3; ++i) h[i] += x.h[i];
    return *this;
  }
  friend SecondOrder operator*(const adouble& c, const SecondOrder& x) {
    SecondOrder r;
    r.f = c * x.f;
    for (std::size_t i = 0; i < 2; ++i) r.g[i] = c * x.g[i];
    for (std::size_t i = 0; i < 3; ++i) r.h[i] = c * x.h[i];
    return r;
  }
  friend SecondOrder operator+(double c, SecondOrder x) {
    x.f += c;
    return x;
  }
  SecondOrder chain(const adouble& w, const adouble& d, const adouble& d2) const {
    SecondOrder r;
    r.f = w;
    for (std::size_t i = 0, m = 0; i < 2; ++i) {
      r.g[i] = d * g[i];
      const adouble bend = d2 * g[i];
      for (std::size_t j = i; j < 2; ++j, ++m) r.h[m] = d * h[m] + bend * g[j];
    }
    return r;
  }
  friend SecondOrder exp(const SecondOrder& x) {
    const adouble e = exp(x.f);
    return x.chain(e, e, e);
  }
  friend SecondOrder log(const SecondOrder& x) {
    const adouble d = 1.0 / x.f;
    return x.chain(log(x.f), d, -d * d);
  }
};

template <class F>
Method::Gradient taped(const F& f) {
  return [f](const std::vector<double>& x, std::vector<double>& g) {
    constexpr short tag = 1;
    trace_on(tag);
    double value = 0;
    {
      std::vector<adouble> v(x.size());
      for (std::size_t i = 0; i < x.size(); ++i) v[i] <<= x[i];
      adouble y = f(v);
      y >>= value;
    }
    trace_off();
    ::gradient(tag, int(x.size()), x.data(), g.data());
    return value;
  };
}

/// What the last tape holds: an operation's code, its places and its constants.
std::size_t tape_bytes() {
  std::size_t counts[STAT_SIZE];
  tapestats(1, counts);
  return counts[NUM_OPERATIONS] + sizeof(locint) * counts[NUM_LOCATIONS] + sizeof(double) * counts[NUM_VALUES] +
         sizeof(double) * counts[TAY_STACK_SIZE];
}

Method tapes() {
  using V = adouble;
  Method m{"ADOL-C"};
  m.rosenbrock = taped([](const std::vector<V>& x) { return workloads::rosenbrock(x); });
  m.arrow = taped([](const std::vector<V>& x) { return workloads::arrow(x); });
  m.log_cosh = taped([](const std::vector<V>& x) { return workloads::log_cosh(x, data().rows); });
  m.network = taped([](const std::vector<V>& p) { return workloads::network_loss(p, data().samples); });
  m.curvature = taped([](const std::vector<V>& p) {
    const auto input = [](const auto& s, const auto& e1, const auto& e2) {
      std::array<SecondOrder, 3> x;
      for (std::size_t c = 0; c < 3; ++c) {
        x[c] = SecondOrder(s[c]);
        x[c].g[0] = e1[c];
        x[c].g[1] = e2[c];
        x[c].h[0] = -s[c];
        x[c].h[2] = -s[c];
      }
      return x;
    };
    const auto second = [](const auto& y, std::size_t k) { return k < 2 ? y.g[k] : y.h[k - 2]; };
    return workloads::curvature_loss<SecondOrder>(p, data().charts, input, second);
  });
  m.network_tape_bytes = [network = m.network] {
    std::vector<double> g(data().parameters.size());
    network(data().parameters, g);
    return tape_bytes();
  };
  return m;
}

}  // namespace

std::vector<Method> adolc_methods() { return {tapes()}; }
#else
std::vector<Method> adolc_methods() { return {}; }
#endif
