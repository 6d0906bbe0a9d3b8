#pragma once
/// Discrete paths between two points of a surface, relaxed to nearly geodesic: where geodesic_distance starts from.
#include <dsns/geometry/fundamental_forms.hpp>
#include <dsns/mesh/sphere_mesh.hpp>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <utility>
#include <vector>

namespace dsns::detail {

/// Unit vectors from a to b; 3 x m.
using SpherePath = Mat3X;

/// The great circle from a to b, bent sideways by `bend` at its middle (0: not; 1: by 45 degrees). Antipodes are joined
/// through a's first frame vector.
inline SpherePath bent_arc(const Vec3d& a, const Vec3d& b, double bend, Index m) {
  const Vec3d across = a.cross(b);
  const Vec3d side = across.norm() > 1e-6 ? Vec3d(across.normalized()) : tangent_frame(a).e2;
  const Vec3d forward = side.cross(a);
  const double angle = angle_between(a, b);
  SpherePath path(3, m);
  for (Index i = 0; i < m; ++i) {
    const double x = double(i) / double(m - 1);
    const Vec3d arc = std::cos(angle * x) * a + std::sin(angle * x) * forward;
    path.col(i) = (arc + bend * std::sin(pi * x) * side).normalized();
  }
  path.col(m - 1) = b;
  return path;
}

/// Shortest path from a to b along the edges of an icosphere with their lengths on the surface (Dijkstra).
template <Surface S>
SpherePath edge_path(const S& surface, const Vec3d& a, const Vec3d& b, int level) {
  const TriangleMesh sphere = icosphere(level);
  const Index n = sphere.vertices.cols();
  const Mat3X p = positions(surface, sphere.vertices);
  std::vector<std::vector<int>> neighbours(static_cast<std::size_t>(n));
  for (Index f = 0; f < sphere.faces.cols(); ++f)
    for (int k = 0; k < 3; ++k) neighbours[std::size_t(sphere.faces(k, f))].push_back(sphere.faces((k + 1) % 3, f));
  const auto nearest = [&](const Vec3d& s) {
    Index at = 0;
    const Eigen::RowVectorXd nearness = s.transpose() * sphere.vertices;
    nearness.maxCoeff(&at);
    return static_cast<int>(at);
  };
  const int first = nearest(a), last = nearest(b);
  Eigen::VectorXd length = Eigen::VectorXd::Constant(n, std::numeric_limits<double>::infinity());
  std::vector<int> before(static_cast<std::size_t>(n), -1);
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  length[first] = 0;
  open.emplace(0.0, first);
  while (!open.empty() && open.top().second != last) {
    const auto [distance, v] = open.top();
    open.pop();
    if (distance > length[v]) continue;
    for (const int w : neighbours[std::size_t(v)]) {
      const double through = distance + (p.col(w) - p.col(v)).norm();
      if (through >= length[w]) continue;
      length[w] = through;
      before[std::size_t(w)] = v;
      open.emplace(through, w);
    }
  }
  std::vector<Vec3d> nodes{b};
  for (int v = before[std::size_t(last)]; v >= 0 && v != first; v = before[std::size_t(v)])
    nodes.emplace_back(sphere.vertices.col(v));
  nodes.push_back(a);
  SpherePath path(3, Index(nodes.size()));
  for (Index i = 0; i < path.cols(); ++i) path.col(i) = nodes[nodes.size() - 1 - std::size_t(i)];
  return path;
}

/// Chords of a path on the surface, one less than its points.
template <Surface S>
Eigen::VectorXd chords(const S& surface, const SpherePath& path) {
  const Mat3X p = positions(surface, path);
  return (p.rightCols(p.cols() - 1) - p.leftCols(p.cols() - 1)).colwise().norm().transpose();
}

/// The path with m points at nearly equal lengths on the surface.
template <Surface S>
SpherePath resampled(const S& surface, const SpherePath& path, Index m) {
  const Eigen::VectorXd chord = chords(surface, path);
  SpherePath out(3, m);
  double passed = 0;
  for (Index i = 0, k = 0; i < m; ++i) {
    const double wanted = chord.sum() * double(i) / double(m - 1);
    while (k + 1 < chord.size() && passed + chord[k] < wanted) passed += chord[k++];
    const double x = chord[k] > 0 ? std::clamp((wanted - passed) / chord[k], 0.0, 1.0) : 0;
    out.col(i) = ((1 - x) * path.col(k) + x * path.col(k + 1)).normalized();
  }
  out.col(0) = path.col(0);
  out.col(m - 1) = path.col(path.cols() - 1);
  return out;
}

/// A Newton step for the energy 1/2 sum |f_(i+1) - f_i|^2 of a path with fixed ends, damped by mu times the metric: 2 x m chart
/// coordinates, by block elimination of the tridiagonal system.
inline Eigen::Matrix2Xd relaxation_step(const SurfaceJets& j, double mu) {
  const Index m = j.size();
  std::vector<Eigen::Matrix2d> inverse(std::size_t(m), Eigen::Matrix2d::Zero()), upper = inverse;
  Eigen::Matrix2Xd x = Eigen::Matrix2Xd::Zero(2, m);
  const auto frame = [&](Index i) {
    Eigen::Matrix<double, 3, 2> D;
    D << j.fu.col(i), j.fv.col(i);
    return D;
  };
  for (Index i = 1; i + 1 < m; ++i) {
    const Eigen::Matrix<double, 3, 2> D = frame(i);
    const Vec3d pull = 2 * j.f.col(i) - j.f.col(i - 1) - j.f.col(i + 1);
    Eigen::Matrix2d bend;
    bend << pull.dot(j.fuu.col(i)), pull.dot(j.fuv.col(i)), pull.dot(j.fuv.col(i)), pull.dot(j.fvv.col(i));
    Eigen::Matrix2d diagonal = (2 + mu) * D.transpose() * D + bend;
    Eigen::Vector2d right = -D.transpose() * pull;
    if (i > 1) {
      const Eigen::Matrix2d lower = upper[std::size_t(i - 1)].transpose() * inverse[std::size_t(i - 1)];
      diagonal -= lower * upper[std::size_t(i - 1)];
      right -= lower * x.col(i - 1);
    }
    inverse[std::size_t(i)] = diagonal.inverse();
    if (i + 2 < m) upper[std::size_t(i)] = -D.transpose() * frame(i + 1);
    x.col(i) = right;
  }
  for (Index i = m - 2; i >= 1; --i)
    x.col(i) = inverse[std::size_t(i)] * (x.col(i) - upper[std::size_t(i)] * x.col(i + 1));
  return x;
}

/// The path moved towards the nearest discrete geodesic: damped Newton steps that lower the energy, until one lowers it by
/// less than 1e-8 of it.
template <Surface S>
SpherePath relaxed(const S& surface, SpherePath path, int max_iterations = 60) {
  double mu = 0.1, energy = chords(surface, path).squaredNorm();
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    const ChartBatch c = charts_at(path);
    const Eigen::Matrix2Xd x = relaxation_step(jets(surface, c), mu);
    double lowered = -1;
    if (x.allFinite() && x.colwise().norm().maxCoeff() < 0.7) {
      SpherePath moved = (c.s + c.e1 * x.row(0).asDiagonal() + c.e2 * x.row(1).asDiagonal()).colwise().normalized();
      moved.col(0) = path.col(0);
      moved.rightCols<1>() = path.rightCols<1>();
      lowered = energy - chords(surface, moved).squaredNorm();
      if (lowered >= 0) {
        path = std::move(moved);
        energy -= lowered;
      }
    }
    mu = lowered >= 0 ? mu / 5 : 4 * mu + 1e-3;
    if (lowered >= 0 && lowered < 1e-8 * energy) break;
  }
  return path;
}

}  // namespace dsns::detail
