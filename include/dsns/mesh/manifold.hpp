#pragma once
/// From faces that meet anyhow to an oriented surface whose every vertex has one fan of faces.
#include <dsns/core/errors.hpp>
#include <dsns/core/types.hpp>
#include <dsns/mesh/diagnosis.hpp>

#include <algorithm>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace dsns::detail {

/// "1 hole", "2 holes"
inline std::string counted(Index count, std::string_view noun) {
  return message(count, " ", noun, count == 1 ? "" : "s");
}

/// The faces of one piece, turned so that neighbours run through their common edge in opposite directions.
/// throws   UnusableMesh for edges with more than two faces and for one-sided surfaces
inline Faces oriented(const Faces& faces, const std::string& name) {
  const auto sides = sorted_sides(faces);
  struct Neighbour {
    Index face;
    bool agrees;
  };
  std::vector<std::vector<Neighbour>> neighbours(static_cast<std::size_t>(faces.cols()));
  Index crowded = 0;
  for_each_edge(sides, [&](auto first, auto last) {
    if (last - first > 2) ++crowded;
    if (last - first != 2) return;
    const auto& other = *(first + 1);
    const bool agrees = first->forward != other.forward;
    neighbours[static_cast<std::size_t>(first->face)].push_back({other.face, agrees});
    neighbours[static_cast<std::size_t>(other.face)].push_back({first->face, agrees});
  });
  require<UnusableMesh>(crowded == 0, name, ": three faces or more meet at ", counted(crowded, "edge"),
                        ": remove inner walls, so that two faces meet at each edge");
  std::vector<int> turn(static_cast<std::size_t>(faces.cols()), 0);  // 0 unknown, 1 as it is, -1 reversed
  std::vector<Index> open{0};
  turn[0] = 1;
  while (!open.empty()) {
    const Index f = open.back();
    open.pop_back();
    for (const Neighbour& next : neighbours[static_cast<std::size_t>(f)]) {
      const int wanted = turn[static_cast<std::size_t>(f)] * (next.agrees ? 1 : -1);
      int& found = turn[static_cast<std::size_t>(next.face)];
      require<UnusableMesh>(found == 0 || found == wanted, name,
                            ": the surface is one-sided like a Moebius strip: it has no inside, cut it open");
      if (found == 0) open.push_back(next.face);
      found = wanted;
    }
  }
  Faces result = faces;
  for (Index f = 0; f < faces.cols(); ++f)
    if (turn[static_cast<std::size_t>(f)] < 0) std::swap(result(1, f), result(2, f));
  return result;
}

/// One new vertex for every fan of faces, so that pieces that touch in a point come apart; unused vertices go.
/// On return source[v] is the old vertex of the new vertex v.
struct SplitFaces {
  Faces faces;
  std::vector<Index> source;
  Index splits = 0;
};
inline SplitFaces one_vertex_per_fan(const Faces& faces) {
  auto fans = vertex_fans(sorted_sides(faces), faces.cols());
  std::vector<std::pair<int, Index>> found;  // (old vertex, corner that represents its fan)
  for (Index c = 0; c < faces.size(); ++c)
    if (fans.find(c) == c) found.emplace_back(faces(c), c);
  std::sort(found.begin(), found.end());  // new vertices keep the old order
  SplitFaces result;
  std::vector<int> new_vertex(static_cast<std::size_t>(faces.size()), -1);
  for (const auto& [vertex, fan] : found) {
    if (!result.source.empty() && result.source.back() == vertex) ++result.splits;
    new_vertex[static_cast<std::size_t>(fan)] = static_cast<int>(result.source.size());
    result.source.push_back(vertex);
  }
  result.faces.resize(3, faces.cols());
  for (Index c = 0; c < faces.size(); ++c) result.faces(c) = new_vertex[static_cast<std::size_t>(fans.find(c))];
  return result;
}

/// Holes as cycles of vertices, in the direction in which a cap's faces run along them.
inline std::vector<std::vector<int>> boundary_loops(const Faces& faces) {
  std::map<int, int> next;
  for_each_edge(sorted_sides(faces), [&](auto first, auto last) {
    if (last - first != 1) return;
    const int from = first->forward ? first->low : first->high;
    next[first->forward ? first->high : first->low] = from;
  });
  std::vector<std::vector<int>> loops;
  while (!next.empty()) {
    auto& loop = loops.emplace_back();
    for (auto step = next.begin(); step != next.end(); step = next.find(loop.back())) {
      loop.push_back(step->second);
      next.erase(step);
    }
  }
  return loops;
}

}  // namespace dsns::detail
