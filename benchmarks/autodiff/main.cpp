// benchmark of differentiation: each method's time as a multiple of code written by hand, timed in turns in one process.
//   autodiff [--json FILE] [--only METHOD]
// and the compiler's seconds for one translation unit with the forward scalars of each library.
#include "../ratios.hpp"
#include "hand.hpp"
#include "methods.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <random>

const Data& data() {
  static const Data made = [] {
    Data d;
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 1024; ++i) {
      d.points.u.push_back(0.1 + 2.9 * uniform(random));
      d.points.v.push_back(2 * workloads::pi * uniform(random));
      d.points.t.push_back(uniform(random));
    }
    for (int i = 0; i < 1000; ++i) d.x.push_back(normal(random));
    d.rows.count = 256;
    for (int i = 0; i < 256 * 1000; ++i) d.rows.entries.push_back(0.02 * normal(random));
    using S = workloads::NetworkShape;
    for (std::size_t i = 0; i < S::parameters; ++i) {
      const bool bias = (i >= S::b1 && i < S::w2) || (i >= S::b2 && i < S::w3) || i >= S::b3;
      d.parameters.push_back((bias ? 0.1 : i < S::b1 ? 0.6 : 0.125) * normal(random));
    }
    for (int i = 0; i < 256; ++i) {
      d.samples.inputs.push_back({normal(random), normal(random), normal(random)});
      d.samples.targets.push_back({normal(random), normal(random), normal(random)});
      const double u = std::acos(1 - 2 * uniform(random)), v = 2 * workloads::pi * uniform(random);
      d.charts.s.push_back({std::sin(u) * std::cos(v), std::sin(u) * std::sin(v), std::cos(u)});
      d.charts.e1.push_back({std::cos(u) * std::cos(v), std::cos(u) * std::sin(v), -std::sin(u)});
      d.charts.e2.push_back({-std::sin(v), std::cos(v), 0});
    }
    return d;
  }();
  return made;
}

namespace {

/// The largest difference, in units of the largest entry.
double worst(const double* a, const double* b, std::size_t n) {
  double w = 0, largest = 0;
  for (std::size_t i = 0; i < n; ++i) {
    w = std::max(w, std::abs(a[i] - b[i]));
    largest = std::max(largest, std::abs(b[i]));
  }
  return w / largest;
}

void report(Results& results, const char* workload, const Method& method, const Timing& t, double error) {
  std::printf("%-5s %-34s %12.3f us %9.2f x hand   error %.0e%s\n", workload, method.name.c_str(), t.microseconds,
              t.ratio, error, error < 1e-8 ? "" : "   WRONG");
  std::fflush(stdout);
  results[workload][method.name] = t.ratio;
}

template <class Out, class F, class Hand>
void pointwise(Results& results, const char* workload, const Method& method, const F& f, const Hand& hand) {
  if (!f) return;
  const workloads::SurfacePoints& p = data().points;
  std::vector<Out> out(p.size()), expected(p.size());
  Timing t = side_by_side([&] { f(p, out); },
                          [&] {
                            for (std::size_t i = 0; i < p.size(); ++i) expected[i] = hand(p.u[i], p.v[i], p.t[i]);
                          });
  t.microseconds /= double(p.size());
  report(results, workload, method, t,
         worst(out[0].f.data(), expected[0].f.data(), out.size() * sizeof(Out) / sizeof(double)));
}

template <class Hand>
void gradient(Results& results, const char* workload, const Method& method, const Method::Gradient& f,
              const std::vector<double>& x, const Hand& hand) {
  if (!f) return;
  std::vector<double> g(x.size()), expected(x.size());
  double value = 0, expected_value = 0;
  const Timing t = side_by_side([&] { value = f(x, g); }, [&] { expected_value = hand(x, expected); });
  report(results, workload, method, t,
         std::max(worst(g.data(), expected.data(), g.size()), worst(&value, &expected_value, 1)));
}

void sparse_hessian(Results& results, const Method& method) {
  if (!method.sparse_hessian) return;
  const std::vector<double>& x = data().x;
  std::vector<double> g(x.size()), h(3 * x.size() - 2), expected_g(g), expected_h(h);
  double value = 0, expected = 0;
  const Timing t = side_by_side([&] { value = method.sparse_hessian(x, g, h); },
                                [&] { expected = hand::rosenbrock_hessian(x, expected_g, expected_h); });
  report(results, "RH", method, t,
         std::max({worst(&value, &expected, 1), worst(g.data(), expected_g.data(), g.size()),
                   worst(h.data(), expected_h.data(), h.size())}));
}

Method by_hand() {
  Method m{"by hand"};
  m.sparse_hessian = hand::rosenbrock_hessian;
  m.first_order = [](const workloads::SurfacePoints& p, std::vector<workloads::FirstOrder>& out) {
    for (std::size_t i = 0; i < p.size(); ++i) out[i] = hand::first_order(p.u[i], p.v[i], p.t[i]);
  };
  m.second_order = [](const workloads::SurfacePoints& p, std::vector<workloads::SecondOrder>& out) {
    for (std::size_t i = 0; i < p.size(); ++i) out[i] = hand::second_order(p.u[i], p.v[i], p.t[i]);
  };
  m.rosenbrock = hand::rosenbrock;
  m.arrow = hand::arrow;
  m.log_cosh = [](const std::vector<double>& x, std::vector<double>& g) { return hand::log_cosh(x, data().rows, g); };
  m.network = [](const std::vector<double>& x, std::vector<double>& g) {
    return hand::network_loss(x, data().samples, g);
  };
  m.curvature = [](const std::vector<double>& x, std::vector<double>& g) {
    return hand::curvature_loss(x, data().charts, g);
  };
  return m;
}

/// User seconds of the compiler for a source in compiled/, the median of three; negative if it does not compile.
double compile_seconds(const std::string& name) {
  std::vector<double> times;
  for (int repeat = 0; repeat < 3; ++repeat) {
    rusage before, after;
    getrusage(RUSAGE_CHILDREN, &before);
    const std::string command =
        std::string(DSNS_COMPILE) + " -c -o /dev/null " DSNS_COMPILED_DIR "/" + name + " 2>/dev/null";
    if (std::system(command.c_str()) != 0) return -1;
    getrusage(RUSAGE_CHILDREN, &after);
    const auto user = [](const rusage& r) { return double(r.ru_utime.tv_sec) + 1e-6 * double(r.ru_utime.tv_usec); };
    times.push_back(user(after) - user(before));
  }
  std::sort(times.begin(), times.end());
  return times[1];
}

}  // namespace

int main(int argc, char** argv) {
  std::string json, only;
  for (int i = 1; i < argc; ++i) {
    std::string* target = !std::strcmp(argv[i], "--json") ? &json : !std::strcmp(argv[i], "--only") ? &only : nullptr;
    if (target == nullptr || i + 1 == argc) {
      std::fprintf(stderr, "usage: %s [--json FILE] [--only METHOD]\n", argv[0]);
      return 2;
    }
    *target = argv[++i];
  }
  std::vector<Method> methods{by_hand()};
  for (const auto& group : {dsns_methods(), ceres_methods(), eigen_methods(), adolc_methods()})
    methods.insert(methods.end(), group.begin(), group.end());
  if (!only.empty()) std::erase_if(methods, [&](const Method& m) { return m.name.find(only) == std::string::npos; });
  if (methods.empty()) {
    std::fprintf(stderr, "no method's name holds '%s'\n", only.c_str());
    return 1;
  }

  const Method h = by_hand();
  const Data& d = data();
  Results results;
  for (const Method& m : methods) pointwise<workloads::FirstOrder>(results, "J3", m, m.first_order, hand::first_order);
  for (const Method& m : methods)
    pointwise<workloads::SecondOrder>(results, "H2", m, m.second_order, hand::second_order);
  for (const Method& m : methods) sparse_hessian(results, m);
  for (const Method& m : methods) gradient(results, "R", m, m.rosenbrock, d.x, h.rosenbrock);
  for (const Method& m : methods) gradient(results, "A", m, m.arrow, d.x, h.arrow);
  for (const Method& m : methods) gradient(results, "L", m, m.log_cosh, d.x, h.log_cosh);
  for (const Method& m : methods) gradient(results, "MLP", m, m.network, d.parameters, h.network);
  for (const Method& m : methods) gradient(results, "iv", m, m.curvature, d.parameters, h.curvature);
  std::printf("\nmemory of one recording of the network's loss\n");
  for (const Method& m : methods)
    if (m.network_tape_bytes) {
      const double bytes = double(m.network_tape_bytes());
      std::printf("%-40s %10.2f MB\n", m.name.c_str(), 1e-6 * bytes);
      results["MLP tape bytes"][m.name] = bytes;
    }

  if (only.empty()) {
    std::printf("\ncompiler's seconds for one translation unit\n");
    for (const char* name : {"dsns_dual.cpp", "dsns_tape.cpp", "ceres_jet.cpp", "adolc_adouble.cpp"})
      if (const double t = compile_seconds(name); t > 0) {
        std::printf("%-40s %10.2f s\n", name, t);
        results["compile seconds"][name] = t;
      }
  }

  return json.empty() || write_json(results, json) ? 0 : 1;
}
