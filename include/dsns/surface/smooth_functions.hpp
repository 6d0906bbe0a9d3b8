#pragma once
/// Functions of any scalar, also of several points side by side, that analytic surfaces are made of.
#include <dsns/autodiff/functions.hpp>

namespace dsns::detail {

/// x^n for n >= 0: exact derivatives also at x = 0.
template <class T>
T integer_power(const T& x, int n) {
  T power(1.0);
  for (int k = 0; k < n; ++k) power = power * x;
  return power;
}

/// sin(x) / x, smooth at 0: for |x| <= 1 its Taylor series (next term below 1e-18 at double precision).
template <class T>
T sinc(const T& x) {
  using std::sin;
  const T square = x * x;
  const auto near = value(square) <= 1;
  T series(1.0);
  for (int k = 18; k >= 2; k -= 2) series = 1.0 - square * series / (double(k) * (k + 1));
  const T away = select(near, T(1.0), x);
  return select(near, series, T(sin(away) / away));
}

}  // namespace dsns::detail
