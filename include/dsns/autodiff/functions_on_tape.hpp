#pragma once
/// Shorter tapes: a part of a computation recorded as one function with a derivative of its own.
///
///   const auto f = preaccumulate([](const auto& x, const auto& y) { return sin(x) * y + x / y; }, a, b);  // one statement
///   const auto y = checkpoint([](const auto& v) { ... return a vector ... }, x);   // recorded again when needed
///   const auto z = custom_vjp(values, x, [](results, operands) { ... });           // a derivative written by hand
#include <dsns/autodiff/dual.hpp>
#include <dsns/autodiff/tape.hpp>

#include <array>
#include <concepts>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace dsns {

/// f(x ...), differentiated on the spot by forward mode: a small function of few arguments costs the tape one statement
/// of half as many nodes as it has arguments, however long it is.
/// f        takes any differentiable scalar for each argument, and returns one
template <class F, class T, std::same_as<Var<T>>... X>
Var<T> preaccumulate(const F& f, const Var<T>& first, const X&... rest) {
  constexpr int n = 1 + int(sizeof...(X));
  const std::array<const Var<T>*, std::size_t(n)> x{&first, &rest...};
  const auto y = [&]<std::size_t... i>(std::index_sequence<i...>) {
    return Dual<T, n>(f(Dual<T, n>::variable(x[i]->f, int(i))...));
  }
  (std::make_index_sequence<std::size_t(n)>{});
  // Two arguments a node, and the parts added up; every node carries the value, of which the tape keeps the last.
  const auto part = [&](std::size_t k) {
    if (k + 1 == std::size_t(n)) return chain(*x[k], y.f, T(y.g[k]), [] {});
    return chain(*x[k], *x[k + 1], y.f, T(y.g[k]), T(y.g[k + 1]), [] {});
  };
  Var<T> sum = part(0);
  for (std::size_t k = 2; k < std::size_t(n); k += 2) sum = chain(sum, part(k), y.f, T(1), T(1), [] {});
  return sum;
}

/// The results of a computation whose derivative is known: `pullback(results, operands)` reads the derivatives of the end
/// result in `values` and adds those in x to `operands`.
template <class T, class Pullback>
std::vector<Var<T>> custom_vjp(const std::vector<T>& values, const std::vector<Var<T>>& x, Pullback pullback) {
  return Tape<T>::function(std::span<const Var<T>>(x), std::span<const T>(values), std::move(pullback));
}

/// f(x), recorded only for its results: the backward sweep records it once more, on a tape of its own, and forgets it. A
/// long computation in k segments needs memory for one segment at a time, and twice the time.
/// f        takes std::vector<T> and std::vector<Var<T>> and returns a vector of the same scalar; it is kept as long as
///          the recording
template <class F, class T>
std::vector<Var<T>> checkpoint(const F& f, const std::vector<Var<T>>& x) {
  std::vector<T> values;
  values.reserve(x.size());
  for (const Var<T>& v : x) values.push_back(v.f);
  const std::vector<T> results = f(std::as_const(values));
  const auto pullback = [f, values](std::span<const T> back, std::span<T> operands) {
    Tape<T> segment;
    const auto recording = segment.record();
    std::vector<Var<T>> inputs;
    inputs.reserve(values.size());
    for (const T& v : values) inputs.push_back(segment.variable(v));
    const std::vector<Var<T>> outputs = f(std::as_const(inputs));
    Var<T> sum(T(0));
    for (std::size_t k = 0; k < outputs.size(); ++k) sum += outputs[k] * back[k];
    segment.backward(sum);
    for (std::size_t k = 0; k < inputs.size(); ++k) operands[k] += segment.adjoint(inputs[k]);
  };
  return Tape<T>::function(std::span<const Var<T>>(x), std::span<const T>(results), pullback);
}

}  // namespace dsns
