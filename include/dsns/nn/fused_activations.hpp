#pragma once
/// Softplus and SiLU with their slopes over columns of single-precision numbers: one pass, one exponential and one division
/// a number, where formulas array by array take three to five times as long.
///
/// Both come from e = exp(-|x|): the logistic function s is 1 / (1 + e), or e / (1 + e) for negative x;
///   softplus x = max(x, 0) + log1p(e), slope s;   SiLU x = x s, slope s + x s (1 - s).
/// Inputs that are not finite stay so.
/// accuracy relative 4 ulp of softplus and its slope where they are normal numbers [nn/fused_activations_test]
#include <dsns/autodiff/batch.hpp>

#include <cstdint>
#include <cstring>

namespace dsns::detail {

using FloatLanes = Batch<float>;

/// exp(x) for x <= 0, at least the smallest normal number: 2^n p(r) with x = n ln 2 + r, |r| <= ln 2 / 2, and p equal to
/// exp at the zeros of a Chebyshev polynomial (relative error 2e-8).
DSNS_INLINE FloatLanes exp_of_negative(FloatLanes x) {
  constexpr float smallest = -87.3f;
  x = select(x < smallest, FloatLanes(smallest), x);
  constexpr float to_integer = 12582912;  // 1.5 2^23: the last bits of a sum with it are the nearest integer
  const FloatLanes shifted = x * 1.44269504f + to_integer, n = shifted - to_integer;
  const FloatLanes r = (x - n * 0.693359375f) - n * -2.12194440e-4f;  // n ln 2, the first part without rounding
  FloatLanes p = 1.3941108e-3f;
  for (const float c : {8.3751259e-3f, 4.1666351e-2f, 1.6666415e-1f, 0.5f, 1.0f, 1.0f}) p = p * r + c;
  typedef std::int32_t Bits __attribute__((vector_size(sizeof(FloatLanes::Vector))));
  Bits power, result;
  std::memcpy(&power, &shifted.v, sizeof(power));
  std::memcpy(&result, &p.v, sizeof(result));
  result += power << 23;
  std::memcpy(&p.v, &result, sizeof(result));
  return p;
}

/// log(1 + e) for e in [0, 1], a polynomial of degree 9 times e (relative error 1.5e-8).
DSNS_INLINE FloatLanes log1p_of_unit(const FloatLanes& e) {
  FloatLanes p = -3.1760570e-3f;
  for (const float c : {1.9542527e-2f, -5.6373611e-2f, 1.0543624e-1f, -1.5269667e-1f, 1.9663274e-1f, -2.4951616e-1f,
                        3.3329710e-1f, -4.9999893e-1f, 1.0f})
    p = p * e + c;
  return p * e;
}

struct LogisticLanes {
  FloatLanes e, s, rest;  // exp(-|x|), 1 / (1 + exp(-x)), and 1 - s without cancellation
};
DSNS_INLINE LogisticLanes logistic(const FloatLanes& x) {
  const FloatLanes e = exp_of_negative(select(x > 0, -x, x));
  const FloatLanes larger = 1 / (1 + e), smaller = e * larger;
  return {e, select(x < 0, smaller, larger), select(x < 0, larger, smaller)};
}

/// A number's replacement by its softplus, and the slope there.
struct SoftplusLanes {
  DSNS_INLINE void operator()(FloatLanes& x, FloatLanes& slope) const {
    const LogisticLanes l = logistic(x);
    x = select(x < 0, FloatLanes(0), x) + log1p_of_unit(l.e);
    slope = l.s;
  }
};
struct SiluLanes {
  DSNS_INLINE void operator()(FloatLanes& x, FloatLanes& slope) const {
    const LogisticLanes l = logistic(x);
    x = x * l.s;
    slope = l.s + x * l.rest;
  }
};

/// law(y, slope) over n numbers, the last ones in lanes that are filled up with zeros.
template <class Law>
void for_lanes(std::ptrdiff_t n, float* y, float* slope, const Law& law) {
  constexpr std::ptrdiff_t lanes = FloatLanes::lanes;
  const auto at = [&](float* values, float* slopes) DSNS_INLINE_LAMBDA {
    FloatLanes x = FloatLanes::load(values), s;
    law(x, s);
    x.store(values);
    s.store(slopes);
  };
  std::ptrdiff_t i = 0;
  for (; i + lanes <= n; i += lanes) at(y + i, slope + i);
  if (i == n) return;
  float values[lanes] = {}, slopes[lanes];
  std::memcpy(values, y + i, std::size_t(n - i) * sizeof(float));
  at(values, slopes);
  std::memcpy(y + i, values, std::size_t(n - i) * sizeof(float));
  std::memcpy(slope + i, slopes, std::size_t(n - i) * sizeof(float));
}

}  // namespace dsns::detail
