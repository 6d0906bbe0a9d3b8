#pragma once
/// From what files hold to what a sphere can be mapped to: one closed, oriented surface without handles.
#include <dsns/core/errors.hpp>
#include <dsns/mesh/diagnosis.hpp>
#include <dsns/mesh/manifold.hpp>
#include <dsns/mesh/triangle_mesh.hpp>
#include <dsns/mesh/weld.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace dsns {

struct RepairOptions {
  double weld_tolerance = 1e-6;    ///< relative to the bounding-box diagonal
  int weld_frames = 4;             ///< frames in which vertices must coincide to be welded
  double loose_piece_limit = 0.2;  ///< largest area of a piece that is dropped, as a share of the kept one's
  int piece = 0;                   ///< the piece to keep, 1 for the largest; 0: the largest, if the others are small
};

struct RepairResult {
  MeshSequence sequence;
  std::vector<std::string> actions;    ///< what was done, in plain words; empty where nothing was needed
  MeshDiagnosis before;                ///< of the mesh as given
  MeshDiagnosis welded;                ///< after welding and dropping degenerate and duplicate faces, all pieces
  MeshDiagnosis after;                 ///< of the result: closed, genus 0
  std::vector<Index> source_vertex;    ///< for each vertex the given one it moves with; -1 for the centre of a cap
  std::vector<Index> repaired_vertex;  ///< for each vertex given the one it became; -1 where it was dropped
};

namespace detail {

inline void check_sequence(const MeshSequence& sequence) {
  require(sequence.frame_count() >= 1 && sequence.faces.cols() >= 1, "repair: ", sequence.name, " has ",
          sequence.frame_count(), " frames and ", sequence.faces.cols(), " faces, give at least one of each");
  for (const Mat3X& frame : sequence.frames) {
    require(frame.cols() == sequence.vertex_count(), "repair: ", sequence.name, " has frames of ",
            sequence.vertex_count(), " and of ", frame.cols(), " vertices: all frames share their vertices");
    require<UnusableMesh>(frame.allFinite(), sequence.name,
                          ": a position is not a finite number: export the animation again");
  }
}

/// Some of the faces given, in their order; `source` are their numbers.
struct FaceSelection {
  Faces faces;
  std::vector<Index> source;
};

/// Faces with their vertices replaced by the first coincident one, without those that lost an edge or came before.
inline FaceSelection welded_faces(const Faces& faces, const std::vector<Index>& first) {
  Faces relabelled = faces.unaryExpr([&](int v) { return static_cast<int>(first[static_cast<std::size_t>(v)]); });
  std::set<std::array<int, 3>> seen;
  FaceSelection kept;
  for (Index f = 0; f < relabelled.cols(); ++f) {
    std::array<int, 3> corners{relabelled(0, f), relabelled(1, f), relabelled(2, f)};
    std::sort(corners.begin(), corners.end());
    if (corners[0] != corners[1] && corners[1] != corners[2] && seen.insert(corners).second) kept.source.push_back(f);
  }
  kept.faces = relabelled(Eigen::all, kept.source);
  return kept;
}

/// The pieces that hang together by edges: their areas over all frames, the largest first, and for each face its piece's
/// place in that order.
struct RankedPieces {
  std::vector<double> areas;
  std::vector<std::size_t> of_face;
};
inline RankedPieces ranked_pieces(const MeshSequence& sequence, const Faces& faces) {
  auto pieces = face_pieces(sorted_sides(faces), faces.cols());
  Eigen::VectorXd face_areas = Eigen::VectorXd::Zero(faces.cols());
  for (const Mat3X& frame : sequence.frames) face_areas += face_normals(frame, faces).colwise().norm().transpose();
  std::map<Index, double> area_of;
  for (Index f = 0; f < faces.cols(); ++f) area_of[pieces.find(f)] += face_areas[f];
  std::vector<std::pair<double, Index>> ranking;
  for (const auto& [piece, area] : area_of) ranking.emplace_back(-area, piece);
  std::sort(ranking.begin(), ranking.end());
  RankedPieces result;
  std::map<Index, std::size_t> rank_of;
  for (const auto& [area, piece] : ranking) {
    rank_of[piece] = result.areas.size();
    result.areas.push_back(-area);
  }
  for (Index f = 0; f < faces.cols(); ++f) result.of_face.push_back(rank_of[pieces.find(f)]);
  return result;
}

/// The chosen piece, by area averaged over all frames.
/// throws   UnusableMesh where none is chosen and the second largest is more than options.loose_piece_limit of the
///          largest, or there are fewer pieces than that
inline FaceSelection chosen_piece(const MeshSequence& sequence, const FaceSelection& all, const RepairOptions& options,
                                  std::vector<std::string>& actions) {
  const Faces& faces = all.faces;
  const RankedPieces pieces = ranked_pieces(sequence, faces);
  const Index count = static_cast<Index>(pieces.areas.size());
  require(options.piece >= 0, "RepairOptions: piece ", options.piece, ", give 1 for the largest and so on, or 0");
  require<UnusableMesh>(options.piece <= count, sequence.name, ": there is no piece ", options.piece, ", only ", count,
                        " of them");
  if (count == 1) return all;

  const double whole = std::accumulate(pieces.areas.begin(), pieces.areas.end(), 0.0);
  const double largest = pieces.areas[0], second = pieces.areas[1];
  const auto percent = [&](double area) { return std::round(1000 * area / whole) / 10; };
  require<UnusableMesh>(options.piece > 0 || second <= options.loose_piece_limit * largest, sequence.name, ": ", count,
                        " loose pieces, the two largest with ", percent(largest), " % and ", percent(second),
                        " % of the area: say which one counts (piece 1, 2, ...), or that they are to be joined");
  const std::size_t rank = options.piece > 0 ? std::size_t(options.piece) - 1 : 0;
  actions.push_back(message("dropped ", counted(count - 1, "loose piece"), " with ",
                            percent(whole - pieces.areas[rank]), " % of the area"));
  FaceSelection kept;
  std::vector<Index> chosen;
  for (Index f = 0; f < faces.cols(); ++f)
    if (pieces.of_face[static_cast<std::size_t>(f)] == rank) chosen.push_back(f);
  kept.faces = faces(Eigen::all, chosen);
  for (const Index f : chosen) kept.source.push_back(all.source[static_cast<std::size_t>(f)]);
  return kept;
}

/// Closes every hole: a triangle for a hole of three edges, else a fan around the centroid of its rim in every frame.
inline void cap_holes(RepairResult& result) {
  MeshSequence& sequence = result.sequence;
  const auto loops = boundary_loops(sequence.faces);
  if (loops.empty()) return;
  std::vector<Eigen::Vector3i> caps;
  std::vector<const std::vector<int>*> fans;
  std::size_t rim_edges = 0;
  for (const auto& loop : loops) {
    rim_edges += loop.size();
    if (loop.size() == 3 && sequence.faces.cols() > 1) {
      caps.emplace_back(loop[0], loop[1], loop[2]);
      continue;
    }
    const int centre = static_cast<int>(result.source_vertex.size());
    for (std::size_t k = 0; k < loop.size(); ++k) caps.emplace_back(loop[k], loop[(k + 1) % loop.size()], centre);
    fans.push_back(&loop);
    result.source_vertex.push_back(-1);
  }
  for (Mat3X& frame : sequence.frames) {
    const Index first = frame.cols();
    frame.conservativeResize(3, first + static_cast<Index>(fans.size()));
    for (std::size_t i = 0; i < fans.size(); ++i)
      frame.col(first + static_cast<Index>(i)) = frame(Eigen::all, *fans[i]).rowwise().mean();
  }
  const Index first = sequence.faces.cols(), added = static_cast<Index>(caps.size());
  sequence.cap_faces += added;
  sequence.faces.conservativeResize(3, first + added);
  for (std::size_t i = 0; i < caps.size(); ++i) sequence.faces.col(first + static_cast<Index>(i)) = caps[i];
  result.actions.push_back(message("closed ", counted(Index(loops.size()), "hole"), " with ", rim_edges, " rim edges"));
}

}  // namespace detail

/// What the mesh is once coincident vertices are one and degenerate and duplicate faces are gone, usable or not.
/// throws   InvalidArgument, UnusableMesh for sequences that hold no mesh at all
inline MeshDiagnosis diagnose_welded(const MeshSequence& raw, const RepairOptions& options = {}) {
  detail::check_sequence(raw);
  const auto first = coincident_vertices(raw, options.weld_tolerance, options.weld_frames);
  return diagnose(detail::welded_faces(raw.faces, first).faces, raw.vertex_count());
}

/// Welds coincident vertices, drops degenerate and duplicate faces, keeps one piece, parts it where it touches
/// itself in a vertex, orients it outwards (positive mean volume) and caps holes: the caps are the trailing cap_faces.
/// throws   UnusableMesh in one sentence: pieces of comparable size, edges with three faces, one-sided, handles
inline RepairResult repair(const MeshSequence& raw, const RepairOptions& options = {}) {
  detail::check_sequence(raw);
  RepairResult result;
  result.before = diagnose(raw.faces, raw.vertex_count());
  const auto first = coincident_vertices(raw, options.weld_tolerance, options.weld_frames);
  detail::FaceSelection kept = detail::welded_faces(raw.faces, first);
  require<UnusableMesh>(kept.faces.cols() > 0, raw.name, ": no triangle is left after welding: give a mesh with area");
  result.welded = diagnose(kept.faces, raw.vertex_count());
  if (result.welded.vertices < result.before.vertices)
    result.actions.push_back(message("welded ", result.before.vertices, " vertices to ", result.welded.vertices));
  if (kept.faces.cols() < raw.faces.cols())
    result.actions.push_back("dropped " +
                             detail::counted(raw.faces.cols() - kept.faces.cols(), "degenerate or duplicate face"));

  kept = detail::chosen_piece(raw, kept, options, result.actions);
  const Faces turned = detail::oriented(kept.faces, raw.name);
  if (turned != kept.faces) result.actions.emplace_back("turned faces to agree with their neighbours");
  auto split = detail::one_vertex_per_fan(turned);
  if (split.splits > 0)
    result.actions.push_back("parted the surface " + detail::counted(split.splits, "time") + " at a pinched vertex");

  MeshSequence& sequence = result.sequence;
  sequence.duration = raw.duration;
  sequence.name = raw.name;
  sequence.faces = std::move(split.faces);
  const auto is_cap = [&](Index f) { return f >= raw.faces.cols() - raw.cap_faces; };
  sequence.cap_faces = std::count_if(kept.source.begin(), kept.source.end(), is_cap);
  result.source_vertex = std::move(split.source);
  std::vector<Index> became(first.size(), -1);
  for (std::size_t v = result.source_vertex.size(); v-- > 0;)
    became[static_cast<std::size_t>(result.source_vertex[v])] = static_cast<Index>(v);
  for (const Index representative : first)
    result.repaired_vertex.push_back(became[static_cast<std::size_t>(representative)]);
  for (const Mat3X& frame : raw.frames) sequence.frames.emplace_back(frame(Eigen::all, result.source_vertex));
  detail::cap_holes(result);

  result.after = diagnose(sequence.faces, sequence.vertex_count());
  require<UnusableMesh>(result.after.genus == 0, raw.name, ": the surface has genus ", result.after.genus.value_or(-1),
                        " (handles like a torus's): only surfaces of genus 0 fit a sphere, fill the handles");
  double summed_volume = 0;
  for (int k = 0; k < sequence.frame_count(); ++k) summed_volume += volume(sequence.frame(k));
  if (summed_volume < 0) {
    sequence.faces.row(1).swap(sequence.faces.row(2));
    result.actions.emplace_back("turned the surface outside in");
  }
  return result;
}

}  // namespace dsns
