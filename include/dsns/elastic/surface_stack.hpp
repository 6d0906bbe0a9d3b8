#pragma once
/// The surfaces that a registration compares, one for each time, as functions to be evaluated anywhere on the sphere.
#include <dsns/core/parallel.hpp>
#include <dsns/surface/jets.hpp>

#include <concepts>
#include <vector>

namespace dsns {

/// Surfaces of several times at n points, and with first derivatives in n charts.
template <class F>
concept SurfaceStack = requires(const F& f, const Mat3X& s, const ChartBatch& charts) {
  { f.positions(s) } -> std::same_as<std::vector<Mat3X>>;
  { f.tangents(charts) } -> std::same_as<std::vector<SurfaceTangents>>;
};

/// A moving surface at `times` equidistant times along a warp of its clock. Refers to the surface and the clock.
template <AnimatedSurface F, class Clock>
struct MovingStack {
  const F& surface;
  const Clock& clock;
  int times;
  int threads = 1;

  std::vector<Mat3X> positions(const Mat3X& s) const {
    std::vector<Mat3X> out(std::size_t(times), Mat3X(3, 0));
    parallel_for(times, threads, [&](int k) { out[std::size_t(k)] = dsns::positions(surface, s, at(k)); });
    return out;
  }
  std::vector<SurfaceTangents> tangents(const ChartBatch& charts) const {
    std::vector<SurfaceTangents> out(std::size_t(times), SurfaceTangents(0));
    parallel_for(times, threads, [&](int k) { out[std::size_t(k)] = dsns::tangents(surface, charts, at(k)); });
    return out;
  }

 private:
  double at(int k) const { return clock(times > 1 ? double(k) / (times - 1) : 0.0); }
};

/// A surface at rest. Refers to it.
template <Surface S>
struct StillStack {
  const S& surface;
  std::vector<Mat3X> positions(const Mat3X& s) const { return {dsns::positions(surface, s)}; }
  std::vector<SurfaceTangents> tangents(const ChartBatch& charts) const { return {dsns::tangents(surface, charts)}; }
};

}  // namespace dsns
