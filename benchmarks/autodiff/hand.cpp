#include "hand.hpp"

#include <Eigen/Core>

#include <algorithm>

namespace hand {

using workloads::pi;
using S = workloads::NetworkShape;

FirstOrder first_order(double u, double v, double t) {
  double su, cu, sv, cv, st, ct;
  sincos(u, &su, &cu);
  sincos(v, &sv, &cv);
  sincos(2 * pi * t, &st, &ct);
  const double x = su * cv, y = su * sv, z = cu;
  const double xu = cu * cv, xv = -y, yu = cu * sv, yv = x, zu = -su;
  const double dx = x - 0.6, dy = y - 0.5, dz = z - 0.4;
  const double bump = std::exp(-4 * (dx * dx + dy * dy + dz * dz)), slope = -8 * bump;
  const double bump_u = slope * (dx * xu + dy * yu + dz * zu), bump_v = slope * (dx * xv + dy * yv);
  const double w = x * x - y * y, harmonic = w * z;
  const double harmonic_u = 2 * (x * xu - y * yu) * z + w * zu, harmonic_v = 2 * (x * xv - y * yv) * z;
  const double ks = 0.1 * st, kt = 0.2 * t;
  const double r = 1 + kt * harmonic + ks * bump;
  const double ru = kt * harmonic_u + ks * bump_u, rv = kt * harmonic_v + ks * bump_v;
  const double rt = 0.2 * harmonic + 0.2 * pi * ct * bump;
  const double a = 1 + 0.3 * t, b = 1 - 0.2 * t * t, c = 1 / (a * b);
  const double at = 0.3, bt = -0.4 * t, c_t = -c * c * (at * b + a * bt);
  return {{a * r * x, b * r * y, c * r * z},
          {{{a * (ru * x + r * xu), a * (rv * x + r * xv), (at * r + a * rt) * x},
            {b * (ru * y + r * yu), b * (rv * y + r * yv), (bt * r + b * rt) * y},
            {c * (ru * z + r * zu), c * rv * z, (c_t * r + c * rt) * z}}}};
}

SecondOrder second_order(double u, double v, double t) {
  double su, cu, sv, cv;
  sincos(u, &su, &cu);
  sincos(v, &sv, &cv);
  const double x = su * cv, y = su * sv, z = cu;
  const double xu = cu * cv, xv = -y, yu = cu * sv, yv = x, zu = -su;
  const double xuu = -x, xuv = -yu, xvv = -x, yuu = -y, yuv = xu, yvv = -y, zuu = -z;
  const double dx = x - 0.6, dy = y - 0.5, dz = z - 0.4;
  const double e = std::exp(-4 * (dx * dx + dy * dy + dz * dz));
  const double qu = -8 * (dx * xu + dy * yu + dz * zu), qv = -8 * (dx * xv + dy * yv);
  const double quu = -8 * (xu * xu + dx * xuu + yu * yu + dy * yuu + zu * zu + dz * zuu);
  const double quv = -8 * (xu * xv + dx * xuv + yu * yv + dy * yuv);
  const double qvv = -8 * (xv * xv + dx * xvv + yv * yv + dy * yvv);
  const double eu = e * qu, ev = e * qv, euu = e * (qu * qu + quu), euv = e * (qu * qv + quv),
               evv = e * (qv * qv + qvv);
  const double w = x * x - y * y, wu = 2 * (x * xu - y * yu), wv = 2 * (x * xv - y * yv);
  const double wuu = 2 * (xu * xu + x * xuu - yu * yu - y * yuu), wuv = 2 * (xu * xv + x * xuv - yu * yv - y * yuv);
  const double wvv = 2 * (xv * xv + x * xvv - yv * yv - y * yvv);
  const double h = w * z, hu = wu * z + w * zu, hv = wv * z;
  const double huu = wuu * z + 2 * wu * zu + w * zuu, huv = wuv * z + wv * zu, hvv = wvv * z;
  const double kt = 0.2 * t, ks = 0.1 * std::sin(2 * pi * t);
  const double r = 1 + kt * h + ks * e, ru = kt * hu + ks * eu, rv = kt * hv + ks * ev;
  const double ruu = kt * huu + ks * euu, ruv = kt * huv + ks * euv, rvv = kt * hvv + ks * evv;
  const double a = 1 + 0.3 * t, b = 1 - 0.2 * t * t, c = 1 / (a * b);
  return {{a * (r * x), b * (r * y), c * (r * z)},
          {a * (ru * x + r * xu), b * (ru * y + r * yu), c * (ru * z + r * zu)},
          {a * (rv * x + r * xv), b * (rv * y + r * yv), c * (rv * z)},
          {a * (ruu * x + 2 * ru * xu + r * xuu), b * (ruu * y + 2 * ru * yu + r * yuu),
           c * (ruu * z + 2 * ru * zu + r * zuu)},
          {a * (ruv * x + ru * xv + rv * xu + r * xuv), b * (ruv * y + ru * yv + rv * yu + r * yuv),
           c * (ruv * z + rv * zu)},
          {a * (rvv * x + 2 * rv * xv + r * xvv), b * (rvv * y + 2 * rv * yv + r * yvv), c * (rvv * z)}};
}

double rosenbrock(const std::vector<double>& x, std::vector<double>& g) {
  const std::size_t n = x.size();
  static thread_local std::vector<double> a;
  a.resize(n);
  double sum = 0;
#pragma GCC ivdep
  for (std::size_t i = 0; i < n - 1; ++i) a[i] = x[i + 1] - x[i] * x[i];
  std::array<double, 8> part{};  // lets the sum vectorise without -ffast-math
  std::size_t i = 0;
  for (; i + 8 < n; i += 8)
    for (std::size_t k = 0; k < 8; ++k) part[k] += 100 * a[i + k] * a[i + k] + (1 - x[i + k]) * (1 - x[i + k]);
  for (; i < n - 1; ++i) sum += 100 * a[i] * a[i] + (1 - x[i]) * (1 - x[i]);
  for (const double p : part) sum += p;
  g[0] = -400 * a[0] * x[0] - 2 * (1 - x[0]);
#pragma GCC ivdep
  for (std::size_t j = 1; j < n - 1; ++j) g[j] = -400 * a[j] * x[j] - 2 * (1 - x[j]) + 200 * a[j - 1];
  g[n - 1] = 200 * a[n - 2];
  return sum;
}

double arrow(const std::vector<double>& x, std::vector<double>& g) {
  const std::size_t n = x.size();
  const double last = x[n - 1], square = last * last;
  std::array<double, 8> part{}, all{};
  double sum = 0, total = 0;
  const auto one = [&](std::size_t i, double& s, double& m) {
    const double a = x[i] * x[i] + square;
    s += a * a - 4 * x[i] + 3;
    g[i] = 4 * a * x[i] - 4;
    m += a;
  };
  std::size_t i = 0;
  for (; i + 8 < n; i += 8)
#pragma GCC ivdep
    for (std::size_t k = 0; k < 8; ++k) one(i + k, part[k], all[k]);
  for (; i < n - 1; ++i) one(i, sum, total);
  for (std::size_t k = 0; k < 8; ++k) sum += part[k], total += all[k];
  g[n - 1] = 4 * last * total;
  return sum;
}

double log_cosh(const std::vector<double>& x, const Rows& a, std::vector<double>& g) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Eigen::Index n = Eigen::Index(x.size()), m = Eigen::Index(a.count);
  const Eigen::Map<const RowMajor> A(a.entries.data(), m, n);
  static thread_local Eigen::VectorXd z;
  z.noalias() = A * Eigen::Map<const Eigen::VectorXd>(x.data(), n);
  const Eigen::ArrayXd e = (-2.0 * z.array().abs()).exp();
  const double sum = (z.array().abs() + (1.0 + e).log()).sum() - double(m) * std::log(2.0);
  const Eigen::VectorXd tanh = z.array().sign() * (1.0 - e) / (1.0 + e);
  Eigen::Map<Eigen::VectorXd>(g.data(), n).noalias() = A.transpose() * tanh;
  return sum;
}

namespace {

using Weights = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Eigen::ArrayXXd, Eigen::MatrixXd, Eigen::VectorXd;

struct Parameters {
  Eigen::Map<const Weights> w1, w2, w3;
  Eigen::Map<const VectorXd> b1, b2, b3;
  explicit Parameters(const double* p)
      : w1(p + S::w1, S::width, S::inputs),
        w2(p + S::w2, S::width, S::width),
        w3(p + S::w3, S::outputs, S::width),
        b1(p + S::b1, S::width),
        b2(p + S::b2, S::width),
        b3(p + S::b3, S::outputs) {}
};
struct Gradient {
  Eigen::Map<Weights> w1, w2, w3;
  Eigen::Map<VectorXd> b1, b2, b3;
  explicit Gradient(double* p)
      : w1(p + S::w1, S::width, S::inputs),
        w2(p + S::w2, S::width, S::width),
        w3(p + S::w3, S::outputs, S::width),
        b1(p + S::b1, S::width),
        b2(p + S::b2, S::width),
        b3(p + S::b3, S::outputs) {}
};

}  // namespace

double network_loss(const std::vector<double>& p, const Samples& samples, std::vector<double>& g) {
  const Parameters w(p.data());
  Gradient d(g.data());
  const Eigen::Index n = Eigen::Index(samples.inputs.size());
  const Eigen::Map<const MatrixXd> x(samples.inputs[0].data(), 3, n), target(samples.targets[0].data(), 3, n);
  static thread_local MatrixXd h1, h2, slope1, slope2, error, d1, d2;
  const auto activate = [](MatrixXd& h, MatrixXd& slope) {
    slope = h.array().exp();
    h = (1.0 + slope.array()).log();
    slope = slope.array() / (1.0 + slope.array());
  };
  h1.noalias() = w.w1 * x;
  h1.colwise() += w.b1;
  activate(h1, slope1);
  h2.noalias() = w.w2 * h1;
  h2.colwise() += w.b2;
  activate(h2, slope2);
  error.noalias() = w.w3 * h2;
  error.colwise() += w.b3;
  error -= target;
  const double share = 1 / double(3 * n), loss = error.squaredNorm() * share;
  error *= 2 * share;
  d.w3.noalias() = error * h2.transpose();
  d.b3 = error.rowwise().sum();
  d2.noalias() = w.w3.transpose() * error;
  d2.array() *= slope2.array();
  d.w2.noalias() = d2 * h1.transpose();
  d.b2 = d2.rowwise().sum();
  d1.noalias() = w.w2.transpose() * d2;
  d1.array() *= slope1.array();
  d.w1.noalias() = d1 * x.transpose();
  d.b1 = d1.rowwise().sum();
  return loss;
}

namespace {

// A tile of m points: columns of values, then of derivatives u, v, uu, uv, vv.
constexpr Eigen::Index tile = 32;

struct Layer {
  MatrixXd z, a, back;            // before and after the activation, and what comes back; width x 6 m
  ArrayXXd slope, second, third;  // of the activation at the values, width x m

  void activate(Eigen::Index m) {
    const auto part = [m](auto& x, Eigen::Index k) { return x.middleCols(k * m, m).array(); };
    a.resize(z.rows(), z.cols());
    slope = part(z, 0).exp();
    part(a, 0) = (1.0 + slope).log();
    slope /= 1.0 + slope;
    second = slope * (1.0 - slope);
    third = second * (1.0 - 2.0 * slope);
    for (Eigen::Index k = 1; k < 3; ++k) part(a, k) = slope * part(z, k);
    part(a, 3) = slope * part(z, 3) + second * part(z, 1).square();
    part(a, 4) = slope * part(z, 4) + second * part(z, 1) * part(z, 2);
    part(a, 5) = slope * part(z, 5) + second * part(z, 2).square();
  }
  /// Turns the derivatives in a, in `back`, into those in z.
  void pull(Eigen::Index m) {
    const auto part = [m](auto& x, Eigen::Index k) { return x.middleCols(k * m, m).array(); };
    const auto u = part(z, 1), v = part(z, 2);
    part(back, 0) = slope * part(back, 0) +
                    second * (u * part(back, 1) + v * part(back, 2) + part(z, 3) * part(back, 3) +
                              part(z, 4) * part(back, 4) + part(z, 5) * part(back, 5)) +
                    third * (u.square() * part(back, 3) + u * v * part(back, 4) + v.square() * part(back, 5));
    part(back, 1) = slope * part(back, 1) + second * (2.0 * u * part(back, 3) + v * part(back, 4));
    part(back, 2) = slope * part(back, 2) + second * (2.0 * v * part(back, 5) + u * part(back, 4));
    for (Eigen::Index k = 3; k < 6; ++k) part(back, k) *= slope;
  }
};

/// (H - 1)^2 and its derivatives in u, v, uu, uv, vv (columns).
double curvature_error(const Eigen::Matrix<double, 3, 5>& d, Eigen::Matrix<double, 3, 5>& g) {
  const Eigen::Vector3d fu = d.col(0), fv = d.col(1), fuu = d.col(2), fuv = d.col(3), fvv = d.col(4);
  const Eigen::Vector3d n(fu[1] * fv[2] - fu[2] * fv[1], fu[2] * fv[0] - fu[0] * fv[2], fu[0] * fv[1] - fu[1] * fv[0]);
  const double E = fu.dot(fu), F = fu.dot(fv), G = fv.dot(fv);
  const double l = fuu.dot(n), m = fuv.dot(n), k = fvv.dot(n);
  const double area = E * G - F * F, scale = -0.5 / (area * std::sqrt(area));
  const double numerator = E * k - 2 * F * m + G * l, error = scale * numerator - 1;
  const double dn = 2 * error * scale, darea = 2 * error * numerator * scale * -1.5 / area;
  const double dE = dn * k + darea * G, dF = -2 * dn * m - 2 * darea * F, dG = dn * l + darea * E;
  const double dl = dn * G, dm = -2 * dn * F, dk = dn * E;
  const Eigen::Vector3d normal = dl * fuu + dm * fuv + dk * fvv;
  const auto cross = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return Eigen::Vector3d(a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]);
  };
  g.col(0) = 2 * dE * fu + dF * fv + cross(fv, normal);
  g.col(1) = 2 * dG * fv + dF * fu + cross(normal, fu);
  g.col(2) = dl * n;
  g.col(3) = dm * n;
  g.col(4) = dk * n;
  return error * error;
}

}  // namespace

double curvature_loss(const std::vector<double>& p, const Charts& charts, std::vector<double>& g) {
  const Parameters w(p.data());
  std::fill(g.begin(), g.end(), 0.0);
  Gradient d(g.data());
  const Eigen::Index n = Eigen::Index(charts.s.size());
  static thread_local MatrixXd x, y;
  static thread_local Layer l1, l2;
  double loss = 0;
  for (Eigen::Index first = 0; first < n; first += tile) {
    const Eigen::Index m = std::min(tile, n - first);
    const auto points = [&](const auto& v) { return Eigen::Map<const MatrixXd>(v[std::size_t(first)].data(), 3, m); };
    x.setZero(3, 6 * m);
    x.leftCols(m) = points(charts.s);
    x.middleCols(m, m) = points(charts.e1);
    x.middleCols(2 * m, m) = points(charts.e2);
    x.middleCols(3 * m, m) = -points(charts.s);
    x.middleCols(5 * m, m) = -points(charts.s);
    l1.z.noalias() = w.w1 * x;
    l1.z.leftCols(m).colwise() += w.b1;
    l1.activate(m);
    l2.z.noalias() = w.w2 * l1.a;
    l2.z.leftCols(m).colwise() += w.b2;
    l2.activate(m);
    y.noalias() = w.w3 * l2.a;  // the last bias moves the surface and bends nothing
    y = workloads::network_share * y + x;
    Eigen::Matrix<double, 3, 5> jet, slope;
    for (Eigen::Index i = 0; i < m; ++i) {
      for (Eigen::Index k = 0; k < 5; ++k) jet.col(k) = y.col((k + 1) * m + i);
      loss += curvature_error(jet, slope);
      y.col(i).setZero();
      for (Eigen::Index k = 0; k < 5; ++k)
        y.col((k + 1) * m + i) = slope.col(k) * (workloads::network_share / double(n));
    }
    d.w3.noalias() += y * l2.a.transpose();
    l2.back.noalias() = w.w3.transpose() * y;
    l2.pull(m);
    d.w2.noalias() += l2.back * l1.a.transpose();
    d.b2 += l2.back.leftCols(m).rowwise().sum();
    l1.back.noalias() = w.w2.transpose() * l2.back;
    l1.pull(m);
    d.w1.noalias() += l1.back * x.transpose();
    d.b1 += l1.back.leftCols(m).rowwise().sum();
  }
  return loss / double(n);
}

double rosenbrock_hessian(const std::vector<double>& x, std::vector<double>& g, std::vector<double>& h) {
  const std::size_t n = x.size();
  const double value = rosenbrock(x, g);
  h[0] = 1200 * x[0] * x[0] - 400 * x[1] + 2;
  h[1] = -400 * x[0];
#pragma GCC ivdep
  for (std::size_t i = 1; i + 1 < n; ++i) {
    double* const column = &h[3 * i - 1];
    column[0] = -400 * x[i - 1];
    column[1] = 1200 * x[i] * x[i] - 400 * x[i + 1] + 202;
    column[2] = -400 * x[i];
  }
  h[3 * n - 4] = -400 * x[n - 2];
  h[3 * n - 3] = 200;
  return value;
}

}  // namespace hand
