#pragma once
/// How far one moving surface is from another at given points and times.
#include <dsns/surface/jets.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace dsns {

/// Lengths in units of `unit`. MSD averages the three coordinates too, as the tables of the D-SNS paper do: the root mean
/// square distance of points is sqrt(3 MSD).
struct SurfaceError {
  double msd = 0;
  double rms_distance = 0;
  double max_distance = 0;
  double normal_angle_mean_deg = 0;  ///< mean angle between the normals, degrees
};

/// Compares at every column of s and every time. A sampled mesh's normals are those of its flat faces.
template <AnimatedSurface A, AnimatedSurface B>
SurfaceError compare(const A& first, const B& second, const Mat3X& s, const std::vector<double>& times,
                     double unit = 1) {
  require(s.cols() > 0 && !times.empty() && unit > 0, "compare: ", s.cols(), " points, ", times.size(), " times, unit ",
          unit, ", give at least one point and time and a positive unit");
  const ChartBatch charts = charts_at(s);
  SurfaceError e;
  const double samples = double(s.cols()) * double(times.size());
  for (const double t : times) {
    const SurfaceJets a = jets(first, charts, t), b = jets(second, charts, t);
    for (Index i = 0; i < s.cols(); ++i) {
      const double square = (a.f.col(i) - b.f.col(i)).squaredNorm() / (unit * unit);
      e.msd += square / (3 * samples);
      e.max_distance = std::max(e.max_distance, std::sqrt(square));
      const Vec3d na = Vec3d(a.fu.col(i)).cross(Vec3d(a.fv.col(i))), nb = Vec3d(b.fu.col(i)).cross(Vec3d(b.fv.col(i)));
      e.normal_angle_mean_deg += std::atan2(na.cross(nb).norm(), na.dot(nb)) * 180 / pi / samples;
    }
  }
  e.rms_distance = std::sqrt(3 * e.msd);
  return e;
}

}  // namespace dsns
