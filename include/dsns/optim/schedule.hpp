#pragma once
/// Learning-rate schedules: factors in [0, 1] of the highest rate, as functions of the finished fraction of a training,
/// be it counted in steps or in seconds; and the clipping of gradients.
#include <dsns/core/errors.hpp>
#include <dsns/core/types.hpp>

#include <algorithm>
#include <cmath>
#include <concepts>

namespace dsns {

template <class S>
concept Schedule = requires(const S& schedule, double done) {
  { schedule(done) } -> std::same_as<double>;
};

namespace detail {

/// Rises linearly from 0 to 1 along the warm-up; afterwards `fall` of the finished fraction of the rest, down to floor.
template <class Fall>
double warmed_up(double done, double warmup, double floor, const Fall& fall) {
  if (done < warmup) return std::max(done, 0.0) / warmup;
  const double rest = warmup < 1 ? std::min((done - warmup) / (1 - warmup), 1.0) : 0;
  return floor + (1 - floor) * fall(rest);
}

}  // namespace detail

struct ConstantRate {
  double operator()(double /*done*/) const { return 1; }
};

/// Half a cosine from 1 to the floor.
struct CosineRate {
  double warmup = 0;  ///< fraction of the training
  double floor = 0;

  double operator()(double done) const {
    return detail::warmed_up(done, warmup, floor, [](double x) { return (1 + std::cos(pi * x)) / 2; });
  }
};

/// A straight line from 1 to the floor.
struct LinearRate {
  double warmup = 0;
  double floor = 0;

  double operator()(double done) const {
    return detail::warmed_up(done, warmup, floor, [](double x) { return 1 - x; });
  }
};

static_assert(Schedule<ConstantRate> && Schedule<CosineRate> && Schedule<LinearRate>);

/// Scales a gradient down to Euclidean norm `limit` where it is longer.
/// returns  its norm before
/// throws   InvalidArgument unless the limit is positive
template <class T>
double clip_norm(Eigen::Ref<Eigen::VectorX<T>> gradient, double limit) {
  require(limit > 0, "clip_norm: a limit of ", limit, ", give a positive one");
  const double norm = gradient.template cast<double>().norm();
  if (norm > limit) gradient *= T(limit / norm);
  return norm;
}

}  // namespace dsns
