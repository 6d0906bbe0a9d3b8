#pragma once
/// How far one moving surface is from another at given points and times.
#include <dsns/surface/jets.hpp>
#include <dsns/surface/sampled.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace dsns {

/// Lengths in units of `unit`, angles in degrees. MSD averages the three coordinates too, as the tables of the D-SNS paper
/// do: the root mean square distance of points is sqrt(3 MSD).
struct SurfaceError {
  double msd = 0;
  double rms_distance = 0;
  double max_distance = 0;
  double normal_angle_mean_deg = 0;  ///< between the normals, those of a sampled mesh being constant on its faces
  double normal_angle_median_deg = 0;
};

/// Against a sampled mesh also by the normals that renderers interpolate on it. How far those are from its own flat faces'
/// is the yardstick of both: no smooth surface is nearer than that to the ones and the others.
struct SampledSurfaceError : SurfaceError {
  double smooth_normal_angle_mean_deg = 0;  ///< to the interpolated normals
  double smooth_normal_angle_median_deg = 0;
  double mesh_normal_angle_mean_deg = 0;  ///< of the mesh alone: between flat and interpolated normals
  double mesh_normal_angle_median_deg = 0;
};

namespace detail {

struct Angles {
  std::vector<float> degrees;

  void add(const Vec3d& a, const Vec3d& b) {
    degrees.push_back(static_cast<float>(std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / pi));
  }
  double mean() const {
    double sum = 0;
    for (const float x : degrees) sum += double(x);
    return sum / double(degrees.size());
  }
  double median() {
    const auto middle = degrees.begin() + std::ptrdiff_t(degrees.size() / 2);
    std::nth_element(degrees.begin(), middle, degrees.end());
    return double(*middle);
  }
};

class ErrorSum {
 public:
  explicit ErrorSum(double unit) : unit_(unit) {}

  void add(const Mat3X& first, const Mat3X& second) {
    const auto squares = (first - second).colwise().squaredNorm().eval();
    square_ += squares.sum() / (unit_ * unit_);
    max_ = std::max(max_, std::sqrt(squares.maxCoeff()) / unit_);
    samples_ += double(first.cols());
  }
  Angles& angles() { return angles_; }

  SurfaceError error() {
    return {square_ / (3 * samples_), std::sqrt(square_ / samples_), max_, angles_.mean(), angles_.median()};
  }

 private:
  double unit_, square_ = 0, max_ = 0, samples_ = 0;
  Angles angles_;
};

inline Mat3X area_vectors(const SurfaceTangents& j) {
  Mat3X out(3, j.f.cols());
  for (Index i = 0; i < out.cols(); ++i) out.col(i) = Vec3d(j.fu.col(i)).cross(Vec3d(j.fv.col(i)));
  return out;
}

inline void check_comparison(const Mat3X& s, const std::vector<double>& times, double unit) {
  require(s.cols() > 0 && !times.empty() && unit > 0, "compare: ", s.cols(), " points, ", times.size(), " times, unit ",
          unit, ", give at least one point and time and a positive unit");
}

}  // namespace detail

/// Compares at every column of s and every time.
template <AnimatedSurface A, AnimatedSurface B>
SurfaceError compare(const A& first, const B& second, const Mat3X& s, const std::vector<double>& times,
                     double unit = 1) {
  detail::check_comparison(s, times, unit);
  const ChartBatch charts = charts_at(s);
  detail::ErrorSum sum(unit);
  for (const double t : times) {
    const SurfaceTangents a = tangents(first, charts, t), b = tangents(second, charts, t);
    const Mat3X na = detail::area_vectors(a), nb = detail::area_vectors(b);
    sum.add(a.f, b.f);
    for (Index i = 0; i < s.cols(); ++i) sum.angles().add(na.col(i), nb.col(i));
  }
  return sum.error();
}

/// The same against a sampled mesh; points on faces that close holes do not count.
/// throws   InvalidArgument where all points lie on such faces
template <AnimatedSurface A>
SampledSurfaceError compare(const A& first, const SampledSurface& mesh, const Mat3X& s,
                            const std::vector<double>& times, double unit = 1) {
  detail::check_comparison(s, times, unit);
  SampledSurface::Hits hits;
  Mat3X own(3, s.cols());
  for (Index i = 0; const SphereHit& hit : mesh.locate(s)) {
    if (!mesh.on_cap(hit)) {
      own.col(Index(hits.size())) = s.col(i);
      hits.push_back(hit);
    }
    ++i;
  }
  require(!hits.empty(), "compare: all ", s.cols(), " points lie on faces that close holes, give others");
  own.conservativeResize(3, Index(hits.size()));
  const ChartBatch charts = charts_at(own);
  detail::ErrorSum sum(unit);
  detail::Angles smooth, yardstick;
  for (const double t : times) {
    const SurfaceTangents a = tangents(first, charts, t), b(mesh.jets(hits, charts, t));
    const Mat3X na = detail::area_vectors(a), nb = detail::area_vectors(b), interpolated = mesh.normals(hits, t);
    sum.add(a.f, b.f);
    for (Index i = 0; i < own.cols(); ++i) {
      sum.angles().add(na.col(i), nb.col(i));
      smooth.add(na.col(i), interpolated.col(i));
      yardstick.add(interpolated.col(i), nb.col(i));
    }
  }
  return {sum.error(), smooth.mean(), smooth.median(), yardstick.mean(), yardstick.median()};
}

}  // namespace dsns
