#pragma once
/// Vertices that coincide throughout a motion. File formats split them along seams of colour or texture.
#include <dsns/core/errors.hpp>
#include <dsns/mesh/triangle_mesh.hpp>

#include <algorithm>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace dsns {

namespace detail {

/// Up to `count` equidistant frames, the first and the last among them.
inline std::vector<const Mat3X*> spread_frames(const MeshSequence& sequence, int count) {
  const int last = sequence.frame_count() - 1, picked = std::min(std::max(count, 1), last + 1);
  std::vector<const Mat3X*> frames;
  for (int k = 0; k < picked; ++k)
    frames.push_back(&sequence.frames[static_cast<std::size_t>(picked > 1 ? k * last / (picked - 1) : 0)]);
  return frames;
}

inline double diagonal(const Mat3X& points) {
  return (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
}

/// Points by cell of a cubic grid. Different cells may share a bucket: callers compare distances anyway.
class PointGrid {
 public:
  PointGrid(const Vec3d& corner, double cell) : corner_(corner), cell_(cell) {}

  void insert(const Vec3d& p, Index label) { buckets_[key(cell_of(p))].push_back(label); }

  /// The first label near p, in p's cell or one of the 26 around it, that `accept` takes; -1 if none.
  template <class Accept>
  Index find(const Vec3d& p, const Accept& accept) const {
    const Cell centre = cell_of(p);
    for (int step = 0; step < 27; ++step) {
      const Cell offset(step % 3 - 1, step / 3 % 3 - 1, step / 9 - 1);
      const auto bucket = buckets_.find(key(centre + offset));
      if (bucket == buckets_.end()) continue;
      for (const Index label : bucket->second)
        if (accept(label)) return label;
    }
    return -1;
  }

 private:
  using Cell = Eigen::Matrix<std::int64_t, 3, 1>;
  Cell cell_of(const Vec3d& p) const { return ((p - corner_) / cell_).array().floor().cast<std::int64_t>(); }
  static std::uint64_t key(const Cell& c) {
    std::uint64_t hash = 0;
    for (int k = 0; k < 3; ++k) hash = (hash ^ static_cast<std::uint64_t>(c[k])) * 0x9E3779B97F4A7C15u;
    return hash ^ (hash >> 32);
  }
  Vec3d corner_;
  double cell_;
  std::unordered_map<std::uint64_t, std::vector<Index>> buckets_;
};

}  // namespace detail

/// For each vertex the first vertex that stays within `tolerance` (relative to the diagonal of the largest frame's
/// bounding box) of it in `frames` equidistant frames; itself where there is none before it.
/// throws   UnusableMesh where all points coincide
inline std::vector<Index> coincident_vertices(const MeshSequence& sequence, double tolerance, int frames) {
  const auto keys = detail::spread_frames(sequence, frames);
  const Mat3X* widest = keys.front();
  for (const Mat3X* frame : keys)
    if (detail::diagonal(*frame) > detail::diagonal(*widest)) widest = frame;
  const double size = detail::diagonal(*widest), reach = tolerance * size;
  require<UnusableMesh>(size > 0, sequence.name, ": all vertices are in one point: give a mesh with some extent");

  detail::PointGrid grid(widest->rowwise().minCoeff(), std::max(reach, 1e-9 * size));
  std::vector<Index> first(static_cast<std::size_t>(sequence.vertex_count()));
  for (Index v = 0; v < sequence.vertex_count(); ++v) {
    const auto coincides = [&](Index u) {
      return std::all_of(keys.begin(), keys.end(),
                         [&](const Mat3X* frame) { return (frame->col(u) - frame->col(v)).norm() <= reach; });
    };
    const Index u = grid.find(widest->col(v), coincides);
    first[static_cast<std::size_t>(v)] = u < 0 ? v : u;
    if (u < 0) grid.insert(widest->col(v), v);
  }
  return first;
}

}  // namespace dsns
