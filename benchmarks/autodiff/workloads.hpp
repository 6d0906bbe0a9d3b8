#pragma once
// What the methods of differentiation are compared on, written once for every scalar type T.
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace workloads {

// --- a moving surface in closed form: (u, v, t) -> R^3 -------------------------------------------------------------

inline constexpr double pi = 3.14159265358979323846;

/// A stretched sphere with a harmonic bump and a wave that comes and goes. U is the scalar of the angles, T that of time,
/// C a constant that U's arithmetic takes.
template <class C = double, class U, class T>
std::array<U, 3> moving_surface(const U& u, const U& v, const T& t) {
  using std::cos, std::exp, std::sin;
  const U sin_u = sin(u);
  const U x = sin_u * cos(v), y = sin_u * sin(v), z = cos(u);
  const U dx = x - C(0.6), dy = y - C(0.5), dz = z - C(0.4);
  const U bump = exp(C(-4.0) * (dx * dx + dy * dy + dz * dz));
  const U harmonic = (x * x - y * y) * z;
  const T a = 1.0 + 0.3 * t, b = 1.0 - 0.2 * t * t, c = 1.0 / (a * b);
  const T kt = 0.2 * t, ks = 0.1 * sin(2 * pi * t);
  const U radius = C(1.0) + kt * harmonic + ks * bump;
  return {U(a * (radius * x)), U(b * (radius * y)), U(c * (radius * z))};
}

struct SurfacePoints {
  std::vector<double> u, v, t;
  std::size_t size() const { return u.size(); }
};
/// J3: values and the 3 x 3 Jacobian in (u, v, t).
struct FirstOrder {
  std::array<double, 3> f;
  std::array<std::array<double, 3>, 3> jacobian;  // component by component
};
/// H2: values, first and second derivatives in (u, v).
struct SecondOrder {
  std::array<double, 3> f, f_u, f_v, f_uu, f_uv, f_vv;
};

// --- scalar functions of many variables ----------------------------------------------------------------------------

/// R
template <class T>
T rosenbrock(const std::vector<T>& x) {
  T sum = 0.0;
  for (std::size_t i = 0; i + 1 < x.size(); ++i) {
    const T a = x[i + 1] - x[i] * x[i];
    const T b = 1.0 - x[i];
    sum += 100.0 * a * a + b * b;
  }
  return sum;
}

/// A: the last variable meets all others.
template <class T>
T arrow(const std::vector<T>& x) {
  T sum = 0.0;
  const T& last = x.back();
  for (std::size_t i = 0; i + 1 < x.size(); ++i) {
    const T a = x[i] * x[i] + last * last;
    sum += a * a - 4.0 * x[i] + 3.0;
  }
  return sum;
}

/// L: the sum of log cosh over the rows of a product with a constant matrix (row-major).
struct Rows {
  std::size_t count;
  std::vector<double> entries;
};
template <class T>
T log_cosh(const std::vector<T>& x, const Rows& a) {
  using std::cosh, std::log;
  T sum = 0.0;
  const std::size_t n = x.size();
  for (std::size_t j = 0; j < a.count; ++j) {
    const double* row = &a.entries[j * n];
    T s = 0.0;
    for (std::size_t i = 0; i < n; ++i) s += row[i] * x[i];
    sum += log(cosh(s));
  }
  return sum;
}

// --- a network 3-64-64-3 -------------------------------------------------------------------------------------------

/// Where weights (row-major) and biases stand in the vector of parameters.
struct NetworkShape {
  static constexpr std::size_t inputs = 3, width = 64, outputs = 3;
  static constexpr std::size_t w1 = 0, b1 = w1 + width * inputs, w2 = b1 + width, b2 = w2 + width * width,
                               w3 = b2 + width, b3 = w3 + outputs * width, parameters = b3 + outputs;
};

template <class T>
T plain_softplus(const T& z) {
  using std::exp, std::log;
  return log(1.0 + exp(z));
}

/// The network at one input. P is the scalar of the parameters, X that of the input, Y that of both together.
template <class Y, class P, class X>
std::array<Y, 3> network(const std::vector<P>& p, const std::array<X, 3>& input) {
  using S = NetworkShape;
  std::array<Y, S::width> h1, h2;
  std::array<Y, 3> out;
  for (std::size_t j = 0; j < S::width; ++j) {
    Y s = p[S::b1 + j];
    for (std::size_t i = 0; i < S::inputs; ++i) s += p[S::w1 + j * S::inputs + i] * input[i];
    h1[j] = plain_softplus(s);
  }
  for (std::size_t j = 0; j < S::width; ++j) {
    Y s = p[S::b2 + j];
    for (std::size_t i = 0; i < S::width; ++i) s += p[S::w2 + j * S::width + i] * h1[i];
    h2[j] = plain_softplus(s);
  }
  for (std::size_t k = 0; k < S::outputs; ++k) {
    Y s = p[S::b3 + k];
    for (std::size_t i = 0; i < S::width; ++i) s += p[S::w3 + k * S::width + i] * h2[i];
    out[k] = s;
  }
  return out;
}

struct Samples {
  std::vector<std::array<double, 3>> inputs, targets;
};
/// MLP: mean squared error.
template <class P>
P network_loss(const std::vector<P>& p, const Samples& samples) {
  P loss = 0.0;
  for (std::size_t i = 0; i < samples.inputs.size(); ++i) {
    const std::array<P, 3> y = network<P>(p, samples.inputs[i]);
    for (std::size_t k = 0; k < 3; ++k) {
      const P d = y[k] - samples.targets[i][k];
      loss += d * d;
    }
  }
  return loss * (1.0 / double(3 * samples.inputs.size()));
}

// --- a curvature loss through the network --------------------------------------------------------------------------

/// Points of the sphere with orthonormal tangents e1, e2; along great circles s_uu = s_vv = -s and s_uv = 0.
struct Charts {
  std::vector<std::array<double, 3>> s, e1, e2;
};
inline constexpr double network_share = 0.2;

/// The squared distance of the mean curvature from 1, from a surface's first and second derivatives.
template <class T>
T curvature_error(const std::array<T, 3>& fu, const std::array<T, 3>& fv, const std::array<T, 3>& fuu,
                  const std::array<T, 3>& fuv, const std::array<T, 3>& fvv) {
  using std::sqrt;
  const auto dot = [](const auto& a, const auto& b) -> T { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };
  const std::array<T, 3> n{fu[1] * fv[2] - fu[2] * fv[1], fu[2] * fv[0] - fu[0] * fv[2], fu[0] * fv[1] - fu[1] * fv[0]};
  const T E = dot(fu, fu), F = dot(fu, fv), G = dot(fv, fv);
  const T area = E * G - F * F;  // of the parallelogram, squared
  const T d = -0.5 * (E * dot(fvv, n) - 2.0 * F * dot(fuv, n) + G * dot(fuu, n)) / (area * sqrt(area)) - 1.0;
  return d * d;
}

/// iv: the mean over the points, of the surface s + share network(s). Y is a second-order scalar in (u, v) over P, made
/// by the method: input(point, k) is the k-th coordinate of the point with its derivatives, second(y, k) picks
/// u, v, uu, uv, vv for k = 0 ... 4.
template <class Y, class P, class Input, class Second>
P curvature_loss(const std::vector<P>& p, const Charts& charts, const Input& input, const Second& second) {
  P loss = 0.0;
  for (std::size_t i = 0; i < charts.s.size(); ++i) {
    const auto s = input(charts.s[i], charts.e1[i], charts.e2[i]);
    const std::array<Y, 3> y = network<Y>(p, s);
    std::array<std::array<P, 3>, 5> d;
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t k = 0; k < 5; ++k) d[k][c] = network_share * second(y[c], k) + second(s[c], k);
    loss += curvature_error(d[0], d[1], d[2], d[3], d[4]);
  }
  return loss * (1.0 / double(charts.s.size()));
}

}  // namespace workloads
