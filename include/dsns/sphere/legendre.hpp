#pragma once
/// Legendre factors of the real harmonics: P_lm(z) without the powers of sin(colatitude), by recurrence upwards in degree.
///   P_lm = a z P_(l-1)m - b P_(l-2)m,   a = sqrt((4 l^2 - 1) / (l^2 - m^2)),   b = a sqrt(((l - 1)^2 - m^2) / (4 (l - 1)^2 - 1))
/// and dP_lm/dz = sqrt((l - m)(l + m + 1)) P_l(m+1), with sqrt(2) undone at m = 0 where the normalisation first carries it.
/// source   Holmes and Featherstone 2002, J. Geodesy 76, section 2
#include <dsns/core/types.hpp>

#include <cmath>
#include <map>
#include <vector>

namespace dsns::detail {

/// What the pair (l, m) needs: P from the two degrees below, P' = first P_l(m+1) and P'' = second P_l(m+2).
template <class S>
struct LegendreStep {
  S a, b, first, second;
};

/// The steps of one order m after another, each from l = m - 1 to the degree. Where a column starts, 0 and 1 stand below it:
/// its first step has a = 0 and b = -P_mm, so that a walk upwards needs no case for the diagonal.
template <class S>
class LegendreTable {
 public:
  explicit LegendreTable(int degree) : degree_(degree), start_(std::size_t(degree + 3), 0) {
    double diagonal = std::sqrt(1 / (4 * pi));
    for (int m = 0; m <= degree + 1; ++m) {
      if (m > 0) diagonal *= std::sqrt((2.0 * m + 1) / (2.0 * m));
      steps_.push_back({S(0), S(0), S(0), S(0)});
      for (int l = m; l <= degree; ++l) steps_.push_back(step(l, m, m > 0 ? std::sqrt(2.0) * diagonal : diagonal));
      start_[std::size_t(m + 1)] = steps_.size();
    }
  }
  int degree() const { return degree_; }
  /// Steps of order m <= degree + 2; the first is that of l = m - 1.
  const LegendreStep<S>* column(int m) const { return steps_.data() + start_[std::size_t(m)]; }

 private:
  static LegendreStep<S> step(int l, int m, double diagonal) {
    const double n = l, o = m, undo = m == 0 ? std::sqrt(0.5) : 1;
    const double first = undo * std::sqrt((n - o) * (n + o + 1));
    const double second = m < l ? first * std::sqrt((n - o - 1) * (n + o + 2)) : 0;
    if (l == m) return {S(0), S(-diagonal), S(first), S(second)};
    const double a = std::sqrt((4 * n * n - 1) / (n * n - o * o));
    const double b = a * std::sqrt(((n - 1) * (n - 1) - o * o) / (4 * (n - 1) * (n - 1) - 1));
    return {S(a), S(b), S(first), S(second)};
  }

  int degree_;
  std::vector<LegendreStep<S>> steps_;
  std::vector<std::size_t> start_;
};

/// Made once a degree and thread.
template <class S>
const LegendreTable<S>& legendre_table(int degree) {
  thread_local std::map<int, LegendreTable<S>> made;
  return made.try_emplace(degree, degree).first->second;
}

/// P_lm(z) of degree up to L, m <= l, at one point; T any scalar.
template <class T>
struct LegendreFactors {
  const LegendreTable<double>& steps;
  std::vector<T> table;

  explicit LegendreFactors(int degree)
      : steps(legendre_table<double>(degree)), table(std::size_t((degree + 1) * (degree + 2) / 2)) {}

  const T& at(int l, int m) const { return table[std::size_t(l * (l + 1) / 2 + m)]; }
  T& at(int l, int m) { return table[std::size_t(l * (l + 1) / 2 + m)]; }
  /// dP_lm/dz.
  T derivative(int l, int m) const { return m < l ? T(steps.column(m)[l - m + 1].first * at(l, m + 1)) : T(0.0); }

  void evaluate(const T& z) {
    for (int m = 0; m <= steps.degree(); ++m) {
      const LegendreStep<double>* step = steps.column(m) + 1;
      at(m, m) = T(-step->b);
      if (m < steps.degree()) at(m + 1, m) = (++step)->a * (z * at(m, m));
      for (int l = m + 2; l <= steps.degree(); ++l) {
        ++step;
        at(l, m) = step->a * (z * at(l - 1, m)) - step->b * at(l - 2, m);
      }
    }
  }
};

/// Re and Im of (x + iy)^m for m up to the degree.
template <class T>
struct PlanePowers {
  std::vector<T> re, im;
  explicit PlanePowers(int degree) : re(std::size_t(degree + 1)), im(std::size_t(degree + 1)) {}
  void evaluate(const T& x, const T& y) {
    re[0] = T(1);
    im[0] = T(0);
    for (std::size_t m = 1; m < re.size(); ++m) {
      re[m] = x * re[m - 1] - y * im[m - 1];
      im[m] = x * im[m - 1] + y * re[m - 1];
    }
  }
};

}  // namespace dsns::detail
