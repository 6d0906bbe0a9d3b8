// Functions of two variables at all pairs of special arguments: the derivative is the limit where there is one, and
// otherwise what docs/autodiff.md says.
#include "catch.hpp"

#include <dsns/autodiff/batch.hpp>
#include <dsns/autodiff/dual.hpp>
#include <dsns/autodiff/jet2.hpp>
#include <dsns/autodiff/tape.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace special_pairs_test {

using namespace dsns;

namespace {

using Long = long double;
/// Value, slopes in x and y, second derivatives xx, xy, yy.
using Six = std::array<Long, 6>;

constexpr double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
const std::vector<double> special{0.0, -0.0, 1, -1, 2, -2, 0.5, -0.5, 3, inf, -inf, nan};

bool same(double a, double b) { return (std::isnan(a) && std::isnan(b)) || a == b; }

/// Arguments near x, from the sides in question.
std::vector<Long> near(double x, bool both_sides) {
  if (std::isinf(x)) return {std::copysign(1e30L, Long(x)), std::copysign(1e60L, Long(x))};
  if (x == 0 && both_sides) return {1e-30L, -1e-30L, 1e-60L};
  if (x == 0) return {std::copysign(1e-30L, Long(x)), std::copysign(1e-60L, Long(x))};
  return {Long(x), Long(x) * (1 + 1e-6L), Long(x) * (1 - 1e-6L)};
}

/// What numbers beyond all bounds tend to.
Long coarse(Long x) { return std::abs(x) < 1e-10L ? 0 : std::abs(x) > 1e10L ? std::copysign(Long(inf), x) : x; }
bool near_to(Long a, Long b) { return coarse(a) == coarse(b) || std::abs(a - b) < 1e-3L * std::abs(b); }

/// Entry k of the derivatives if all approaches agree about it.
template <class Closed>
std::optional<Long> limit(const Closed& closed, double x, double y, std::size_t k, bool both_sides_of_x) {
  std::optional<Long> common;
  for (const Long a : near(x, both_sides_of_x))
    for (const Long b : near(y, true)) {
      const Long v = closed(a, b)[k];
      if (std::isnan(v) || (common && !near_to(v, *common))) return {};
      if (!common) common = v;
    }
  return coarse(*common);
}

struct Slopes {
  double x, y;
};

/// The first derivatives in every mode; returns all of Jet2's.
template <class F>
std::array<double, 6> every_mode(const F& f, double x, double y) {
  using J = Jet2<double, 2>;
  const J jet = f(J::variable(x, 0), J::variable(y, 1));
  CHECK(same(jet.f, f(x, y)));
  const auto agrees = [&](const char* mode, double value, double dx, double dy) {
    INFO(mode << ": " << value << ", " << dx << ", " << dy << "; Jet2: " << jet.f << ", " << jet.g[0] << ", "
              << jet.g[1]);
    CHECK((same(value, jet.f) && same(dx, jet.g[0]) && same(dy, jet.g[1])));
  };
  using D = Dual<double, 3>;
  const D dual = f(D::variable(x, 0), D::variable(y, 1));
  agrees("Dual", dual.f, dual.g[0], dual.g[1]);
  CHECK(dual.g[2] == 0);
  const D left = f(D::variable(x, 0), y), right = f(x, D::variable(y, 1));
  if (!(std::isnan(x) || std::isnan(y))) {
    CHECK(same(left.f, jet.f));
    CHECK(same(right.f, jet.f));
    CHECK(same(left.g[0], jet.g[0]));
    CHECK(same(right.g[1], jet.g[1]));
  }
  CHECK((left.g[1] == 0 && right.g[0] == 0));
  using N = Dual<Dual<double, 1>, 2>;
  const N nested = f(N::variable(Dual<double, 1>(x), 0), N::variable(Dual<double, 1>(y), 1));
  agrees("nested Dual", nested.f.f, nested.g[0].f, nested.g[1].f);
  {
    Tape<double> tape;
    const auto recording = tape.record();
    const auto u = tape.variable(x), v = tape.variable(y);
    const auto w = f(u, v);
    tape.backward(w);
    agrees("Var", w.f, tape.adjoint(u), tape.adjoint(v));
  }
  {
    using B = Dual<Batch<double, 2>, 2>;
    const B batch = f(B::variable(Batch<double, 2>(x), 0), B::variable(Batch<double, 2>(y), 1));
    agrees("batch", batch.f[1], batch.g[0][1], batch.g[1][1]);
  }
  return {jet.f, jet.g[0], jet.g[1], jet.h[0], jet.h[1], jet.h[2]};
}

/// All pairs: limits where there are, else `convention(x, y)`.
template <class F, class Closed, class Convention>
void check_pairs(const std::string& name, const F& f, const Closed& closed, bool both_sides_of_x,
                 const Convention& convention) {
  int limits = 0;
  for (const double x : special)
    for (const double y : special) {
      INFO(name << " at " << x << ", " << y);
      const auto found = every_mode(f, x, y);
      const Slopes expected = convention(x, y);
      for (std::size_t k = 1; k < 6; ++k) {
        INFO("derivative " << k << " of f, x, y, xx, xy, yy: " << found[k]);
        std::optional<Long> l;
        if (!std::isnan(x) && !std::isnan(y)) l = limit(closed, x, y, k, both_sides_of_x);
        if (name == "pow" && x == 0 && y == 0 && k == 4) continue;  // (1 + y log x) / x has any sign
        if (l) {
          INFO("limit " << double(*l));
          ++limits;
          CHECK(near_to(Long(found[k]), *l));
        } else if (k < 3) {
          const double wanted = k == 1 ? expected.x : expected.y;
          INFO("convention " << wanted);
          CHECK((same(found[k], wanted) || std::abs(found[k] - wanted) < 1e-15));
        }
      }
    }
  CHECK(limits > 150);
}

}  // namespace

TEST_CASE("conventions: hypot and atan2 at all pairs of special arguments", "[autodiff]") {
  const auto length = [](const auto& x, const auto& y) {
    using std::hypot;
    return hypot(x, y);
  };
  const auto sign = [](double x) { return std::copysign(1.0, x); };
  check_pairs(
      "hypot", length,
      [](Long x, Long y) {
        const Long r = std::hypot(x, y), c = x / r, s = y / r;
        return Six{r, c, s, s * s / r, -c * s / r, c * c / r};
      },
      true,
      [&](double x, double y) -> Slopes {
        if (std::isnan(x) || std::isnan(y)) return {nan, nan};
        if (x == 0 && y == 0) return {0, 0};
        return {sign(x) * std::sqrt(0.5), sign(y) * std::sqrt(0.5)};  // infinite both: the direction that atan2 gives
      });
  const auto angle = [](const auto& y, const auto& x) {
    using std::atan2;
    return atan2(y, x);
  };
  check_pairs(
      "atan2", angle,
      [](Long y, Long x) {
        const Long r = std::hypot(x, y), c = x / r, s = y / r;
        return Six{std::atan2(y, x),   c / r, -s / r, -2 * c * s / (r * r), (s * s - c * c) / (r * r),
                   2 * c * s / (r * r)};
      },
      true,
      [](double y, double x) -> Slopes {
        if (std::isnan(x) || std::isnan(y)) return {nan, nan};
        return {0, 0};
      });
  // The length overflows, the arguments do not.
  using D = Dual<double, 2>;
  const D overflow = length(D::variable(1.5e308, 0), D::variable(-1.5e308, 1));
  CHECK(overflow.f == inf);
  CHECK(overflow.g[0] == Approx(std::sqrt(0.5)));
  CHECK(overflow.g[1] == Approx(-std::sqrt(0.5)));
}

TEST_CASE("conventions: pow at all pairs of special arguments", "[autodiff]") {
  check_pairs(
      "pow",
      [](const auto& x, const auto& y) {
        using std::pow;
        return pow(x, y);
      },
      [](Long x, Long y) {
        const Long f = std::pow(x, y), l = std::log(x);
        return Six{
            f,        y * std::pow(x, y - 1), f * l, y * (y - 1) * std::pow(x, y - 2), std::pow(x, y - 1) * (1 + y * l),
            f * l * l};
      },
      false,
      [](double x, double y) -> Slopes {
        const double of_y = x < 0 || std::isnan(x) ? nan  // no power of a negative base beside an integer exponent
                            : x == 1               ? 0
                            : std::isnan(y)        ? nan
                            : x == 0 && y >= 0     ? 0
                                                   : std::pow(x, y) * std::log(x);  // the logarithm's infinity
        const double of_x = y == 0                              ? 0             // x^0 = 1 for all x
                            : std::isnan(x) && y == 1           ? 1
                            : std::isnan(x) || std::isnan(y)    ? nan
                            : std::isinf(y) && std::abs(x) == 1 ? y
                                                                : y * std::pow(x, y - 1);
        return {of_x, of_y};
      });
}

TEST_CASE("conventions: min, max and their relatives at all pairs of special arguments", "[autodiff]") {
  const auto choice = [](const auto& f, bool first, double x, double y) {
    INFO("at " << x << ", " << y);
    const auto found = every_mode(f, x, y);
    CHECK((found[1] == first && found[2] == !first));
    CHECK((found[3] == 0 && found[4] == 0 && found[5] == 0));
  };
  for (const double x : special)
    for (const double y : special) {
      choice(
          [](const auto& a, const auto& b) {
            using std::min;
            return min(a, b);
          },
          !(y < x), x, y);
      choice(
          [](const auto& a, const auto& b) {
            using std::max;
            return max(a, b);
          },
          !(x < y), x, y);
      // As the standard's, but for the sign of a zero.
      const auto least = [](const auto& a, const auto& b) {
        using std::fmin;
        return fmin(a, b);
      };
      const auto most = [](const auto& a, const auto& b) {
        using std::fmax;
        return fmax(a, b);
      };
      choice(least, !(y < x || std::isnan(x)), x, y);
      choice(most, !(x < y || std::isnan(x)), x, y);
    }
}

}  // namespace special_pairs_test
