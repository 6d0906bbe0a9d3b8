#include "landmarks.hpp"

#include <dsns/io/file_bytes.hpp>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

namespace dsns::program {

namespace {

std::vector<std::string> cells_of(std::string line) {
  line.erase(std::min(line.find('#'), line.size()));
  std::vector<std::string> cells;
  std::istringstream text(line);
  for (std::string cell; std::getline(text, cell, ',');) {
    const auto begin = cell.find_first_not_of(" \t\r"), end = cell.find_last_not_of(" \t\r");
    cells.push_back(begin == std::string::npos ? "" : cell.substr(begin, end - begin + 1));
  }
  const bool blank = cells.empty() || (cells.size() == 1 && cells[0].empty());
  return blank ? std::vector<std::string>{} : cells;
}

template <class T>
bool parsed(const std::string& cell, T& value) {
  return detail::parse_number(std::string_view(cell), value);
}

/// The vertex of the repaired mesh that a vertex of the file became.
Index repaired_vertex(const LandmarkFile& given, const VertexPair& pair, Index vertex, const Body& body,
                      const char* which) {
  const std::string place = message(given.file.string(), ", line ", pair.line, ": ");
  const Index n = body.own.vertex_count();
  require<FileError>(vertex >= 0 && vertex < n, place, "there is no vertex ", vertex, " in the ", which, " mesh, ",
                     body.file.string(), ": give a number from 0 to ", n - 1);
  const Index repaired = body.own.repaired_vertex(vertex);
  require<FileError>(repaired >= 0, place, "vertex ", vertex, " of the ", which, " mesh, ", body.file.string(),
                     ", belongs to a piece or a face that was dropped: give a vertex of the piece that is kept");
  return repaired;
}

}  // namespace

LandmarkFile read_landmarks(const std::filesystem::path& file, double together) {
  LandmarkFile out{file, {}, together};
  if (file.empty()) return out;
  std::istringstream text(detail::read_whole_file(file));
  bool header = true;
  std::size_t number = 0;
  for (std::string line; std::getline(text, line);) {
    ++number;
    const std::vector<std::string> cells = cells_of(line);
    if (cells.empty()) continue;
    const auto is_number = [](const std::string& cell) {
      double ignored = 0;
      return parsed(cell, ignored);
    };
    if (std::exchange(header, false) && std::none_of(cells.begin(), cells.end(), is_number)) continue;
    const auto check = [&](bool ok, const auto&... what) {
      require<FileError>(ok, file.string(), ", line ", number, ": ", what...);
    };
    check(cells.size() == 2 || cells.size() == 3, cells.size(), cells.size() == 1 ? " column" : " columns",
          ", give the vertex of the first mesh, that of the second and, if you like, a weight, with commas between");
    VertexPair pair{0, 0, 1, number};
    for (const auto& [cell, vertex] : {std::pair(cells[0], &pair.first), std::pair(cells[1], &pair.second)})
      check(parsed(cell, *vertex), "'", cell, "' is not the number of a vertex: give a whole number from 0");
    if (cells.size() == 3)
      check(parsed(cells[2], pair.weight) && std::isfinite(pair.weight) && pair.weight >= 0, "'", cells[2],
            "' is not a weight: give a number from 0");
    out.pairs.push_back(pair);
  }
  require<FileError>(!out.pairs.empty(), file.string(),
                     " holds no landmarks: give lines of a vertex of the first mesh, a comma and one of the second");
  return out;
}

BodyLandmarks landmarks_on(const LandmarkFile& given, const Body& first, const Body& second) {
  double sum = 0;
  for (const VertexPair& pair : given.pairs) sum += pair.weight;
  BodyLandmarks out;
  for (const VertexPair& pair : given.pairs) {
    SphereLandmarks& to = pair.weight > 0 ? out.used : out.held_out;
    const Index n = to.size();
    to.points.conservativeResize(3, n + 1);
    to.targets.conservativeResize(3, n + 1);
    to.weights.conservativeResize(n + 1);
    to.points.col(n) = first.sphere.vertices.col(repaired_vertex(given, pair, pair.first, first, "first"));
    to.targets.col(n) = second.sphere.vertices.col(repaired_vertex(given, pair, pair.second, second, "second"));
    to.weights[n] = pair.weight > 0 ? given.together * pair.weight / sum : 1;
  }
  return out;
}

void report_landmarks(const BodyLandmarks& landmarks, const Body& second, const SpatialResult& registration,
                      Report& report) {
  const Mat3X& ground = second.normalized.sequence.frames.front();
  const Vec3d centre = (ground.rowwise().minCoeff() + ground.rowwise().maxCoeff()) / 2;
  const double diameter = 2 * (ground.colwise() - centre).colwise().norm().maxCoeff();
  const auto say = [&](const std::string& key, const std::string& label, const SphereLandmarks& of) {
    if (of.size() == 0) return;
    const Mat3X images = registration.gamma(of.points);
    const Eigen::VectorXd missed =
        100 / diameter *
        (second.surface.positions(images, 0) - second.surface.positions(of.targets, 0)).colwise().norm().transpose();
    report.figure(key + ".number", label, of.size());
    report.figure(key + ".missed_deg", "  missed on the sphere, degrees rms",
                  angular_distance(images, of.targets, of.weights).rms * 180 / pi);
    report.figure(key + ".missed_percent", "  on the second body, % of its diameter rms",
                  std::sqrt(missed.squaredNorm() / double(missed.size())));
    report.figure(key + ".missed_percent_each", "  each", std::vector<double>(missed.begin(), missed.end()));
  };
  say("landmarks", "landmarks", landmarks.used);
  say("landmarks_held_out", "landmarks held out (weight 0)", landmarks.held_out);
}

}  // namespace dsns::program
