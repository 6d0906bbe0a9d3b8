#pragma once
/// Warps of time: increasing maps of [0, 1] onto itself with fixed ends, stored as values and slopes on an equidistant grid
/// and interpolated by monotone cubics.
#include <dsns/core/errors.hpp>
#include <dsns/core/types.hpp>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <numeric>
#include <random>
#include <vector>

namespace dsns {

class TimeWarp {
 public:
  static constexpr Index default_intervals = 400;

  /// The identity.
  TimeWarp()
      : TimeWarp(Eigen::VectorXd::LinSpaced(default_intervals + 1, 0, 1),
                 Eigen::VectorXd::Ones(default_intervals + 1)) {}

  /// Values and slopes at equidistant times from 0 to 1.
  /// throws   InvalidArgument unless the values increase from 0 to 1 and the slopes are positive
  TimeWarp(Eigen::VectorXd values, Eigen::VectorXd slopes) : values_(std::move(values)), slopes_(std::move(slopes)) {
    const Index n = values_.size();
    require(n >= 2 && slopes_.size() == n, "TimeWarp: ", n, " values and ", slopes_.size(),
            " slopes, give as many of both, at least two");
    require(std::abs(values_[0]) < 1e-12 && std::abs(values_[n - 1] - 1) < 1e-12, "TimeWarp: goes from ", values_[0],
            " to ", values_[n - 1], ", it must go from 0 to 1");
    values_[0] = 0;
    values_[n - 1] = 1;
    for (Index k = 0; k < n; ++k) {
      require(slopes_[k] > 0 && (k == 0 || values_[k] > values_[k - 1]), "TimeWarp: not increasing at node ", k, " of ",
              n);
      // Slopes up to three times the neighbouring secants keep the cubics monotone (Fritsch and Carlson 1980).
      if (k > 0) slopes_[k] = std::min(slopes_[k], 3 * secant(k - 1));
      if (k + 1 < n) slopes_[k] = std::min(slopes_[k], 3 * secant(k));
    }
  }

  /// zeta' = e^u / integral of e^u for u at equidistant times: increasing with exact ends whatever u is.
  static TimeWarp from_log_slope(const Eigen::VectorXd& u) {
    const Eigen::VectorXd rate = (u.array() - u.maxCoeff()).exp();
    Eigen::VectorXd sum(u.size());
    sum[0] = 0;
    for (Index k = 1; k < u.size(); ++k) sum[k] = sum[k - 1] + (rate[k - 1] + rate[k]) / 2;
    const double total = sum[u.size() - 1];
    return {sum / total, rate * double(u.size() - 1) / total};
  }

  Index intervals() const { return values_.size() - 1; }
  const Eigen::VectorXd& values() const { return values_; }
  const Eigen::VectorXd& slopes() const { return slopes_; }

  /// zeta(t); t is clamped to [0, 1].
  double operator()(double t) const {
    const auto [k, x] = piece(t);
    const double y = 1 - x;
    return y * y * (1 + 2 * x) * values_[k] + x * x * (1 + 2 * y) * values_[k + 1] +
           h() * x * y * (y * slopes_[k] - x * slopes_[k + 1]);
  }
  /// zeta'(t) >= 0.
  double slope(double t) const {
    const auto [k, x] = piece(t);
    const double y = 1 - x;
    return 6 * x * y * secant(k) + y * (1 - 3 * x) * slopes_[k] + x * (3 * x - 2) * slopes_[k + 1];
  }
  /// The t with zeta(t) = value, by bisection to machine precision.
  double inverse(double value) const {
    double low = 0, high = 1;
    for (int step = 0; step < 60 && high - low > 0; ++step) {
      const double middle = (low + high) / 2;
      ((*this)(middle) < value ? low : high) = middle;
    }
    return (low + high) / 2;
  }
  /// The smallest slope over the nodes and four points between any two.
  double min_slope() const {
    double least = slopes_.minCoeff();
    for (Index k = 0; k < 5 * intervals(); ++k)
      least = std::min(least, slope((double(k) + 0.5) / (5 * double(intervals()))));
    return least;
  }

 private:
  struct Piece {
    Index left;
    double x;
  };
  double h() const { return 1 / double(intervals()); }
  double secant(Index k) const { return (values_[k + 1] - values_[k]) / h(); }
  Piece piece(double t) const {
    const double u = std::clamp(t, 0.0, 1.0) / h();
    const Index left = std::min(static_cast<Index>(u), intervals() - 1);
    return {left, u - double(left)};
  }

  Eigen::VectorXd values_, slopes_;
};

namespace detail {

/// The warp through values(t) with slopes(t) on the default grid.
template <class Value, class Slope>
TimeWarp tabulated_warp(const Value& value, const Slope& slope) {
  const Index n = TimeWarp::default_intervals + 1;
  Eigen::VectorXd values(n), slopes(n);
  for (Index k = 0; k < n; ++k) {
    const double t = double(k) / double(n - 1);
    values[k] = k == 0 ? 0 : k == n - 1 ? 1 : value(t);
    slopes[k] = std::max(slope(t), 1e-12);
  }
  return {std::move(values), std::move(slopes)};
}

}  // namespace detail

/// t -> outer(inner(t)).
inline TimeWarp compose(const TimeWarp& outer, const TimeWarp& inner) {
  return detail::tabulated_warp([&](double t) { return outer(inner(t)); },
                                [&](double t) { return outer.slope(inner(t)) * inner.slope(t); });
}

inline TimeWarp inverse(const TimeWarp& warp) {
  return detail::tabulated_warp([&](double t) { return warp.inverse(t); },
                                [&](double t) { return 1 / std::max(warp.slope(warp.inverse(t)), 1e-12); });
}

/// A function of time and its derivative: a TimeWarp, a PiecewiseLinearWarp, a WarpNetwork.
template <class W>
concept WarpOfTime = requires(const W& w, double t) {
  { w(t) } -> std::same_as<double>;
  { w.slope(t) } -> std::same_as<double>;
};

/// Root of the integral of (a - b)^2 over [0, 1], in the unit of the clip's length.
template <WarpOfTime A, WarpOfTime B>
double distance(const A& a, const B& b) {
  constexpr int n = 1000;
  double sum = 0;
  for (int k = 0; k < n; ++k) sum += std::pow(a((k + 0.5) / n) - b((k + 0.5) / n), 2);
  return std::sqrt(sum / n);
}
inline double distance(const TimeWarp& a, const TimeWarp& b) { return distance<TimeWarp, TimeWarp>(a, b); }

/// A smooth random warp; the logarithm of its slope is a sum of four cosines with amplitudes about strength / k.
inline TimeWarp random_warp(std::uint64_t seed, double strength) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0, 2 * pi);
  Eigen::VectorXd u = Eigen::VectorXd::Zero(TimeWarp::default_intervals + 1);
  for (int k = 1; k <= 4; ++k) {
    const double amplitude = strength * normal(random) / k, phase = uniform(random);
    for (Index i = 0; i < u.size(); ++i)
      u[i] += amplitude * std::cos(k * pi * double(i) / double(u.size() - 1) + phase);
  }
  return TimeWarp::from_log_slope(u);
}

/// A smooth random warp whose slopes reach from min_slope to max_slope, both within the table's resolution.
/// The logarithm of the slope is a sum of four cosines of random phases and amplitudes, bent so that the ends are kept.
/// throws   InvalidArgument unless 0 < min_slope < 1 < max_slope
inline TimeWarp random_time_warp(std::uint64_t seed, double min_slope, double max_slope) {
  require(min_slope > 0 && min_slope < 1 && max_slope > 1 && std::isfinite(max_slope), "random_time_warp: slopes from ",
          min_slope, " to ", max_slope, ", give positive ones on either side of 1");
  Eigen::ArrayXd u = random_warp(seed, 1).slopes().array().log();
  u = (u - u.minCoeff()) / (u.maxCoeff() - u.minCoeff());
  // u -> (e^(b u) - 1) / (e^b - 1) keeps 0 and 1; the mean slope falls from max to min as b rises, and must be 1.
  const double range = std::log(max_slope / min_slope);
  const auto log_slope = [&](double b) -> Eigen::VectorXd {
    if (std::abs(b) < 1e-9) return range * u;
    return range / std::expm1(b) * u.unaryExpr([b](double x) { return std::expm1(b * x); });
  };
  double low = -50, high = 50;
  for (int step = 0; step < 60; ++step) {
    const double b = (low + high) / 2;
    const Eigen::ArrayXd rate = min_slope * log_slope(b).array().exp();
    const double mean = (rate.sum() - (rate[0] + rate[rate.size() - 1]) / 2) / double(rate.size() - 1);
    (mean > 1 ? low : high) = b;
  }
  return TimeWarp::from_log_slope(log_slope((low + high) / 2));
}

/// The mean of warps on the Hilbert sphere of psi = sqrt(zeta'): the Karcher mean of the psi, squared and integrated.
/// weights  one a warp, not negative, not all 0; empty: all alike
/// source   Srivastava, Klassen 2016, section 7.5
inline TimeWarp karcher_mean(const std::vector<TimeWarp>& warps, std::vector<double> weights = {}) {
  if (weights.empty()) weights.assign(warps.size(), 1);
  const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
  require(!warps.empty() && weights.size() == warps.size() && total > 0, "karcher_mean: ", warps.size(), " warps and ",
          weights.size(), " weights, give at least one warp and as many weights of a positive sum");
  const Index n = TimeWarp::default_intervals + 1;
  Eigen::VectorXd w = Eigen::VectorXd::Constant(n, 1 / double(n - 1));
  w[0] = w[n - 1] = 0.5 / double(n - 1);
  const auto inner = [&](const Eigen::VectorXd& a, const Eigen::VectorXd& b) { return a.cwiseProduct(b).dot(w); };
  std::vector<Eigen::VectorXd> psi;
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(n);
  for (std::size_t i = 0; i < warps.size(); ++i) {
    Eigen::VectorXd p(n);
    for (Index k = 0; k < n; ++k) p[k] = std::sqrt(std::max(warps[i].slope(double(k) / double(n - 1)), 0.0));
    p /= std::sqrt(inner(p, p));
    mean += weights[i] / total * p;
    psi.push_back(std::move(p));
  }
  mean /= std::sqrt(inner(mean, mean));
  for (int step = 0; step < 50; ++step) {
    Eigen::VectorXd tangent = Eigen::VectorXd::Zero(n);
    for (std::size_t i = 0; i < psi.size(); ++i) {
      const double c = std::clamp(inner(psi[i], mean), -1.0, 1.0), angle = std::acos(c);
      tangent += (psi[i] - c * mean) * (angle > 1e-8 ? angle / std::sin(angle) : 1.0) * weights[i] / total;
    }
    const double length = std::sqrt(inner(tangent, tangent));
    if (length < 1e-13) break;
    mean = std::cos(length) * mean + std::sin(length) / length * tangent;
  }
  return TimeWarp::from_log_slope(2 * mean.array().max(1e-6).log().matrix());
}

}  // namespace dsns
