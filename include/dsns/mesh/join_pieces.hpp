#pragma once
/// Several pieces as one surface: each is repaired, then tubes join them where they are nearest.
#include <dsns/mesh/repair.hpp>

#include <algorithm>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace dsns {

namespace detail {

/// The two faces, caps left out, whose centres are nearest in the first frame.
inline std::pair<Index, Index> nearest_faces(const MeshSequence& a, const MeshSequence& b) {
  const auto centres = [](const MeshSequence& s) {
    Mat3X c(3, s.faces.cols() - s.cap_faces);
    for (Index f = 0; f < c.cols(); ++f) c.col(f) = s.frames.front()(Eigen::all, s.faces.col(f)).rowwise().mean();
    return c;
  };
  const Mat3X ca = centres(a), cb = centres(b);
  std::pair<Index, Index> best{0, 0};
  double least = std::numeric_limits<double>::infinity();
  for (Index i = 0; i < ca.cols(); ++i) {
    Index j = 0;
    const double distance = (cb.colwise() - ca.col(i)).colwise().squaredNorm().minCoeff(&j);
    if (distance < least) least = distance, best = {i, j};
  }
  return best;
}

/// The six faces of a tube between the rims that faces p of one surface and q of another leave behind.
inline Faces tube(const Eigen::Vector3i& p, const Eigen::Vector3i& q, const Mat3X& points) {
  int turn = 0;
  double least = std::numeric_limits<double>::infinity();
  const auto opposite = [&](int i, int s) { return q[(s - i + 3) % 3]; };  // the rims run against each other
  for (int s = 0; s < 3; ++s) {
    double length = 0;
    for (int i = 0; i < 3; ++i) length += (points.col(p[i]) - points.col(opposite(i, s))).norm();
    if (length < least) least = length, turn = s;
  }
  Faces faces(3, 6);
  for (int i = 0; i < 3; ++i) {
    const int next = (i + 1) % 3;
    faces.col(2 * i) << p[i], p[next], opposite(next, turn);
    faces.col(2 * i + 1) << p[i], opposite(next, turn), opposite(i, turn);
  }
  return faces;
}

/// The connected sum of two repaired pieces of one mesh. The tube's faces count as caps.
inline RepairResult joined(RepairResult a, const RepairResult& b) {
  const Index n = a.sequence.vertex_count();
  const auto [p, q] = nearest_faces(a.sequence, b.sequence);
  for (std::size_t k = 0; k < a.sequence.frames.size(); ++k) {
    Mat3X both(3, n + b.sequence.vertex_count());
    both << a.sequence.frames[k], b.sequence.frames[k];
    a.sequence.frames[k] = std::move(both);
  }
  const Faces fa = a.sequence.faces, fb = b.sequence.faces.array() + static_cast<int>(n);
  const Index ka = fa.cols() - a.sequence.cap_faces, kb = fb.cols() - b.sequence.cap_faces;
  Faces& faces = a.sequence.faces;
  faces.resize(3, fa.cols() + fb.cols() + 4);
  faces << fa.leftCols(p), fa.middleCols(p + 1, ka - p - 1), fb.leftCols(q), fb.middleCols(q + 1, kb - q - 1),
      fa.rightCols(a.sequence.cap_faces), fb.rightCols(b.sequence.cap_faces),
      tube(fa.col(p), fb.col(q), a.sequence.frames.front());
  a.sequence.cap_faces += b.sequence.cap_faces + 6;
  a.source_vertex.insert(a.source_vertex.end(), b.source_vertex.begin(), b.source_vertex.end());
  for (std::size_t v = 0; v < a.repaired_vertex.size(); ++v)
    if (a.repaired_vertex[v] < 0 && b.repaired_vertex[v] >= 0) a.repaired_vertex[v] = n + b.repaired_vertex[v];
  a.after = diagnose(faces, a.sequence.vertex_count());
  return a;
}

}  // namespace detail

/// Like repair(), but all pieces with more than options.loose_piece_limit of the largest one's area are kept and joined to it
/// by a tube of six faces where they are nearest in the first frame; the tubes are among the caps.
/// throws   UnusableMesh as repair() does, for any of the pieces
inline RepairResult repair_joined(const MeshSequence& raw, const RepairOptions& options = {}) {
  require(options.piece == 0, "repair_joined: piece ", options.piece, " is chosen, leave it 0 to join pieces");
  detail::check_sequence(raw);
  const auto first = coincident_vertices(raw, options.weld_tolerance, options.weld_frames);
  const auto areas = detail::ranked_pieces(raw, detail::welded_faces(raw.faces, first).faces).areas;
  RepairOptions one = options;
  one.piece = 1;
  RepairResult result = repair(raw, one);
  int count = 1;
  while (count < static_cast<int>(areas.size()) &&
         areas[static_cast<std::size_t>(count)] > options.loose_piece_limit * areas.front()) {
    one.piece = ++count;
    result = detail::joined(std::move(result), repair(raw, one));
  }
  if (count == 1) return result;
  const auto about_pieces = [](const std::string& action) { return action.find("loose piece") != std::string::npos; };
  std::erase_if(result.actions, about_pieces);
  if (static_cast<std::size_t>(count) < areas.size())
    result.actions.push_back("dropped " +
                             detail::counted(static_cast<Index>(areas.size()) - count, "small loose piece"));
  result.actions.push_back(message("joined ", count, " pieces by tubes"));
  return result;
}

}  // namespace dsns
