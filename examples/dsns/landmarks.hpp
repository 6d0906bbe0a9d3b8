#pragma once
/// Points of two bodies that a user says correspond: pairs of vertices of their files' own meshes, from a file.
#include "bodies.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace dsns::program {

struct VertexPair {
  Index first, second;  ///< vertices of the files' own meshes, from 0
  double weight;        ///< 0: not used, but told how far it is missed
  std::size_t line;     ///< of the file
};

/// Pairs as a file has them; no file: none.
struct LandmarkFile {
  std::filesystem::path file;
  std::vector<VertexPair> pairs;
  double together = 10;  ///< what all weigh together, see SphereLandmarks
};

/// Each line `vertex, vertex[, weight]`; # begins a comment, the first line may be a header. No path: no landmarks.
/// throws   FileError that names the line
LandmarkFile read_landmarks(const std::filesystem::path& file, double together);

/// On the spheres of both bodies, those that are used apart from those that are held out, which have weight 0.
struct BodyLandmarks {
  SphereLandmarks used, held_out;
};
/// throws   FileError that names the line of a vertex that there is not, or that the repair dropped
BodyLandmarks landmarks_on(const LandmarkFile& given, const Body& first, const Body& second);

/// How many there are, and how far the map misses them: on the sphere, and on the second body at its first frame.
void report_landmarks(const BodyLandmarks& landmarks, const Body& second, const SpatialResult& registration,
                      Report& report);

}  // namespace dsns::program
