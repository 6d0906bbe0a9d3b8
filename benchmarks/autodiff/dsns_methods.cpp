// Ours.
#include "methods.hpp"

#include <dsns/autodiff/batch.hpp>
#include <dsns/autodiff/dual.hpp>
#include <dsns/autodiff/element_sum.hpp>
#include <dsns/autodiff/functions_on_tape.hpp>
#include <dsns/autodiff/jet2.hpp>
#include <dsns/autodiff/matrix.hpp>
#include <dsns/autodiff/matrix_jets.hpp>
#include <dsns/autodiff/tape.hpp>

namespace {

using namespace dsns;
using workloads::FirstOrder, workloads::SecondOrder, workloads::SurfacePoints;

Method forward() {
  Method m{"dsns Dual, Jet2"};
  m.first_order = [](const SurfacePoints& p, std::vector<FirstOrder>& out) {
    using D = Dual<double, 3>;
    for (std::size_t i = 0; i < p.size(); ++i) {
      const auto f = workloads::moving_surface(D::variable(p.u[i], 0), D::variable(p.v[i], 1), D::variable(p.t[i], 2));
      for (std::size_t c = 0; c < 3; ++c) {
        out[i].f[c] = f[c].f;
        out[i].jacobian[c] = f[c].g;
      }
    }
  };
  m.second_order = [](const SurfacePoints& p, std::vector<SecondOrder>& out) {
    using J = Jet2<double, 2>;
    for (std::size_t i = 0; i < p.size(); ++i) {
      const auto f = workloads::moving_surface(J::variable(p.u[i], 0), J::variable(p.v[i], 1), p.t[i]);
      for (std::size_t c = 0; c < 3; ++c) {
        out[i].f[c] = f[c].f;
        out[i].f_u[c] = f[c].g[0];
        out[i].f_v[c] = f[c].g[1];
        out[i].f_uu[c] = f[c].h[0];
        out[i].f_uv[c] = f[c].h[1];
        out[i].f_vv[c] = f[c].h[2];
      }
    }
  };
  return m;
}

Method batched() {
  Method m{"dsns Dual, Jet2 over a batch"};
  using B = Batch<double>;
  m.first_order = [](const SurfacePoints& p, std::vector<FirstOrder>& out) {
    using D = Dual<B, 3>;
    for (std::size_t i = 0; i + B::lanes <= p.size(); i += B::lanes) {
      const auto f = workloads::moving_surface(D::variable(B::load(&p.u[i]), 0), D::variable(B::load(&p.v[i]), 1),
                                               D::variable(B::load(&p.t[i]), 2));
      for (int lane = 0; lane < B::lanes; ++lane)
        for (std::size_t c = 0; c < 3; ++c) {
          FirstOrder& o = out[i + std::size_t(lane)];
          o.f[c] = f[c].f[lane];
          for (std::size_t k = 0; k < 3; ++k) o.jacobian[c][k] = f[c].g[k][lane];
        }
    }
  };
  m.second_order = [](const SurfacePoints& p, std::vector<SecondOrder>& out) {
    using J = Jet2<B, 2>;
    for (std::size_t i = 0; i + B::lanes <= p.size(); i += B::lanes) {
      const auto f = workloads::moving_surface(J::variable(B::load(&p.u[i]), 0), J::variable(B::load(&p.v[i]), 1),
                                               B::load(&p.t[i]));
      for (int lane = 0; lane < B::lanes; ++lane)
        for (std::size_t c = 0; c < 3; ++c) {
          SecondOrder& o = out[i + std::size_t(lane)];
          o.f[c] = f[c].f[lane];
          o.f_u[c] = f[c].g[0][lane];
          o.f_v[c] = f[c].g[1][lane];
          o.f_uu[c] = f[c].h[0][lane];
          o.f_uv[c] = f[c].h[1][lane];
          o.f_vv[c] = f[c].h[2][lane];
        }
    }
  };
  return m;
}

template <class F>
Method::Gradient taped(const F& f) {
  return [f](const std::vector<double>& x, std::vector<double>& g) {
    static Tape<double> tape;
    static std::vector<Var<double>> v;
    const auto recording = tape.record();
    v.clear();
    for (const double& xi : x) v.push_back(tape.variable(xi));
    const Var<double> y = f(v);
    tape.backward(y);
    for (std::size_t i = 0; i < x.size(); ++i) g[i] = tape.adjoint(v[i]);
    return y.f;
  };
}

Method reverse() {
  using V = Var<double>;
  Method m{"dsns Var"};
  m.rosenbrock = taped([](const std::vector<V>& x) { return workloads::rosenbrock(x); });
  m.arrow = taped([](const std::vector<V>& x) { return workloads::arrow(x); });
  m.log_cosh = taped([](const std::vector<V>& x) { return workloads::log_cosh(x, data().rows); });
  m.network = taped([](const std::vector<V>& p) { return workloads::network_loss(p, data().samples); });
  m.network_tape_bytes = [] {
    Tape<double> tape;
    const auto recording = tape.record();
    std::vector<V> p;
    for (const double& x : data().parameters) p.push_back(tape.variable(x));
    const V loss = workloads::network_loss(p, data().samples);
    tape.backward(loss);
    return tape.bytes();
  };
  m.curvature = taped([](const std::vector<V>& p) {
    using J = Jet2<V, 2>;
    const auto input = [](const auto& s, const auto& e1, const auto& e2) {
      std::array<J, 3> x;
      for (std::size_t c = 0; c < 3; ++c) x[c] = {s[c], {e1[c], e2[c]}, {-s[c], 0.0, -s[c]}};
      return x;
    };
    const auto second = [](const auto& y, std::size_t k) { return k < 2 ? y.g[k] : y.h[k - 2]; };
    return workloads::curvature_loss<J>(p, data().charts, input, second);
  });
  return m;
}

Method local() {
  using V = Var<double>;
  Method m{"dsns local preaccumulation"};
  m.rosenbrock = taped([](const std::vector<V>& x) {
    V sum = 0.0;
    for (std::size_t i = 0; i + 1 < x.size(); ++i)
      sum += preaccumulate(
          [](const auto& now, const auto& next) {
            const auto a = next - now * now, b = 1.0 - now;
            return 100.0 * a * a + b * b;
          },
          x[i], x[i + 1]);
    return sum;
  });
  return m;
}

Method by_element() {
  Method m{"dsns ElementSum"};
  m.sparse_hessian = [](const std::vector<double>& x, std::vector<double>& g, std::vector<double>& h) {
    static const ElementSum<2> sum = [&] {
      std::vector<ElementSum<2>::Element> pairs;
      for (int i = 0; i + 1 < int(x.size()); ++i) pairs.push_back({i, i + 1});
      return ElementSum<2>(Eigen::Index(x.size()), pairs);
    }();
    const auto element = [](const auto& v) {
      const auto a = v[1] - v[0] * v[0], b = 1.0 - v[0];
      return 100.0 * a * a + b * b;
    };
    const Eigen::VectorXd at = Eigen::Map<const Eigen::VectorXd>(x.data(), Eigen::Index(x.size()));
    static SecondOrderSum<double> r = sum.second_order(element, at);
    sum.second_order(element, at, r);
    std::copy(r.gradient.begin(), r.gradient.end(), g.begin());
    std::copy(r.hessian.valuePtr(), r.hessian.valuePtr() + r.hessian.nonZeros(), h.begin());
    return r.value;
  };
  return m;
}

using Matrix = Eigen::MatrixXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Node = MatrixTape<double>::Node;

/// The network's matrices, column by column as the tape takes them, and their gradients.
struct NetworkMatrices {
  static constexpr std::array<std::array<std::size_t, 3>, 6> places{{{workloads::NetworkShape::w1, 64, 3},
                                                                     {workloads::NetworkShape::b1, 64, 1},
                                                                     {workloads::NetworkShape::w2, 64, 64},
                                                                     {workloads::NetworkShape::b2, 64, 1},
                                                                     {workloads::NetworkShape::w3, 3, 64},
                                                                     {workloads::NetworkShape::b3, 3, 1}}};
  std::array<Matrix, 6> value, gradient;

  void read(const std::vector<double>& p) {
    for (std::size_t k = 0; k < 6; ++k) {
      const auto [begin, rows, cols] = places[k];
      value[k] = Eigen::Map<const RowMajor>(p.data() + begin, Eigen::Index(rows), Eigen::Index(cols));
      gradient[k].setZero(Eigen::Index(rows), Eigen::Index(cols));
    }
  }
  void write(std::vector<double>& g) const {
    for (std::size_t k = 0; k < 6; ++k) {
      const auto [begin, rows, cols] = places[k];
      Eigen::Map<RowMajor>(g.data() + begin, Eigen::Index(rows), Eigen::Index(cols)) = gradient[k];
    }
  }
  Node node(MatrixTape<double>& tape, std::size_t k) {
    return tape.parameter({value[k].data(), value[k].rows(), value[k].cols()},
                          {gradient[k].data(), gradient[k].rows(), gradient[k].cols()});
  }
};

Method matrix_nodes() {
  static MatrixTape<double> tape;
  static NetworkMatrices net;
  Method m{"dsns matrix nodes"};
  m.network = [](const std::vector<double>& p, std::vector<double>& g) {
    const workloads::Samples& samples = data().samples;
    const Eigen::Index n = Eigen::Index(samples.inputs.size()), tile = 64;
    const auto softplus = [](Eigen::Index k, double* y, double* slope) {
      Eigen::Map<Eigen::ArrayXd> z(y, k), s(slope, k);
      s = z.exp();
      z = (1.0 + s).log();
      s /= 1.0 + s;
    };
    net.read(p);
    double loss = 0;
    for (Eigen::Index first = 0; first < n; first += tile) {
      const Eigen::Index count = std::min(tile, n - first);
      const auto points = [&](const auto& v) {
        return Eigen::Map<const Matrix>(v[std::size_t(first)].data(), 3, count);
      };
      tape.clear();
      const Node w1 = net.node(tape, 0), b1 = net.node(tape, 1), w2 = net.node(tape, 2), b2 = net.node(tape, 3);
      const Node x = tape.constant(points(samples.inputs));
      const Node h = tape.layer(w2, b2, tape.layer(w1, b1, x, softplus), softplus);
      const Node y = tape.add(tape.product(net.node(tape, 4), h), net.node(tape, 5));
      const Node error = tape.squared_error(y, points(samples.targets));
      tape.backward(error, 1.0 / double(3 * n));
      loss += tape.value(error)(0, 0);
    }
    net.write(g);
    return loss / double(3 * n);
  };
  m.network_tape_bytes = [] { return tape.bytes(); };
  m.curvature = [](const std::vector<double>& p, std::vector<double>& g) {
    const workloads::Charts& charts = data().charts;
    const Eigen::Index n = Eigen::Index(charts.s.size()), tile = 32;
    const auto softplus = [](auto z, auto slope, auto second, auto third) {
      slope = z.exp();
      z = (1.0 + slope).log();
      slope /= 1.0 + slope;
      second = slope * (1.0 - slope);
      third = second * (1.0 - 2.0 * slope);
    };
    net.read(p);
    double loss = 0;
    for (Eigen::Index first = 0; first < n; first += tile) {
      const Eigen::Index count = std::min(tile, n - first);
      const auto points = [&](const auto& v) {
        return Eigen::Map<const Matrix>(v[std::size_t(first)].data(), 3, count);
      };
      tape.clear();
      const Node w1 = net.node(tape, 0), b1 = net.node(tape, 1), w2 = net.node(tape, 2), b2 = net.node(tape, 3);
      const Node x = tape.constant(3, 6 * count, [&](Matrix& s) {
        s << points(charts.s), points(charts.e1), points(charts.e2), -points(charts.s), Matrix::Zero(3, count),
            -points(charts.s);
      });
      const Node h = jet_layer(tape, w2, b2, jet_layer(tape, w1, b1, x, softplus), softplus);
      const Node out = jet_bias(tape, tape.product(net.node(tape, 4), h), net.node(tape, 5));
      const Node y = tape.add(tape.scale(out, workloads::network_share), x);
      const Node errors = pointwise<3, 6>(
          tape, y, [](const auto& f) { return workloads::curvature_error(f[1], f[2], f[3], f[4], f[5]); });
      const Node sum = tape.sum(errors);
      tape.backward(sum, 1.0 / double(n));
      loss += tape.value(sum)(0, 0);
    }
    net.write(g);
    return loss / double(n);
  };
  return m;
}

}  // namespace

std::vector<Method> dsns_methods() { return {forward(), batched(), reverse(), local(), by_element(), matrix_nodes()}; }
