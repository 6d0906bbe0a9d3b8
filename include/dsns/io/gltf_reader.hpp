#pragma once
/// Animated meshes out of glTF: the clip's pose is applied to every mesh of the scene at equidistant times.
#include <dsns/io/gltf_animation.hpp>
#include <dsns/mesh/triangle_mesh.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace dsns {

struct GltfReadOptions {
  std::string clip;  ///< full name, or its part after the last '|'; empty: the first clip
  int frames = 32;
  double rate = 0;           ///< frames a second instead of a number of frames, if positive
  std::string node = {};     ///< only the meshes at the node of this name and below it; empty: all of the scene
  bool allow_still = false;  ///< a file without animation is one frame
};

struct GltfAnimation {
  MeshSequence sequence;
  std::string clip;                     ///< full name of the clip that was read
  bool clip_chosen_by_default = false;  ///< no name was given
};

namespace detail::gltf {

/// One primitive at one node: positions before deformation, and what deforms them.
struct MeshPart {
  std::size_t node;
  const tinygltf::Primitive* primitive;
  Mat3X points;
  std::vector<Mat3X> targets;  ///< displacements by morph target; empty matrices displace nothing
  const tinygltf::Skin* skin = nullptr;
  std::vector<Eigen::Affine3d> inverse_binds;  ///< by joint
  Eigen::MatrixXi joints;                      ///< influences x n
  Eigen::MatrixXd weights;                     ///< columns sum to 1
  Faces faces;
};

inline Faces triangles_of(const GltfFile& file, const tinygltf::Primitive& primitive, Index vertices) {
  std::vector<int> indices;
  if (primitive.indices >= 0) {
    const auto values = read_accessor(file, primitive.indices, TINYGLTF_TYPE_SCALAR, "the list of triangles");
    for (const double i : values.reshaped()) {
      file.check(i >= 0 && i < double(vertices), "a triangle names vertex ", i, " of ", vertices,
                 ": the file is damaged, export it again");
      indices.push_back(static_cast<int>(i));
    }
  } else {
    for (Index i = 0; i < vertices; ++i) indices.push_back(static_cast<int>(i));
  }
  const Index count = static_cast<Index>(indices.size());
  const auto corner = [&](Index i) { return indices[static_cast<std::size_t>(i)]; };
  const bool separate = primitive.mode == TINYGLTF_MODE_TRIANGLES;
  Faces faces(3, separate ? count / 3 : std::max<Index>(count - 2, 0));
  for (Index f = 0; f < faces.cols(); ++f) {
    if (separate)
      faces.col(f) << corner(3 * f), corner(3 * f + 1), corner(3 * f + 2);
    else if (primitive.mode == TINYGLTF_MODE_TRIANGLE_FAN)
      faces.col(f) << corner(0), corner(f + 1), corner(f + 2);
    else
      faces.col(f) << corner(f), corner(f + 1 + f % 2), corner(f + 2 - f % 2);
  }
  return faces;
}

inline void read_influences(const GltfFile& file, const tinygltf::Primitive& primitive, MeshPart& part) {
  const Index n = part.points.cols();
  for (int set = 0; primitive.attributes.count(message("JOINTS_", set)) > 0; ++set) {
    const std::string joints = message("JOINTS_", set), weights = message("WEIGHTS_", set);
    file.check(primitive.attributes.count(weights) > 0, joints, " has no ", weights, ": export the file again");
    part.joints.conservativeResize(4 * (set + 1), n);
    part.weights.conservativeResize(4 * (set + 1), n);
    const auto numbers = read_accessor(file, primitive.attributes.at(joints), TINYGLTF_TYPE_VEC4, joints, n);
    part.joints.bottomRows(4) = numbers.cwiseMax(-1).cwiseMin(1e9).cast<int>();
    part.weights.bottomRows(4) = read_accessor(file, primitive.attributes.at(weights), TINYGLTF_TYPE_VEC4, weights, n);
  }
  const int joint_count = static_cast<int>(part.skin->joints.size());
  for (Index v = 0; v < part.weights.cols(); ++v) {
    const double sum = part.weights.col(v).sum();
    if (sum > 0)
      part.weights.col(v) /= sum;
    else
      part.weights.col(v) = Eigen::VectorXd::Unit(part.weights.rows(), 0);  // as viewers do
    for (Index k = 0; k < part.weights.rows(); ++k)
      file.check(part.weights(k, v) == 0 || (part.joints(k, v) >= 0 && part.joints(k, v) < joint_count), "vertex ", v,
                 " hangs on joint ", part.joints(k, v), " of ", joint_count, ": the file is damaged, export it again");
  }
}

inline void read_skin(const GltfFile& file, int skin, const tinygltf::Primitive& primitive, MeshPart& part) {
  part.skin = &at(file, file.model.skins, skin, "skin");
  for (const int joint : part.skin->joints) at(file, file.model.nodes, joint, "node");
  part.inverse_binds.assign(part.skin->joints.size(), Eigen::Affine3d::Identity());
  if (part.skin->inverseBindMatrices >= 0) {
    const auto matrices = read_accessor(file, part.skin->inverseBindMatrices, TINYGLTF_TYPE_MAT4, "a skin's bind pose");
    file.check(matrices.cols() >= Index(part.inverse_binds.size()), "a skin has ", part.inverse_binds.size(),
               " joints and ", matrices.cols(), " bind matrices: export the file again");
    for (std::size_t j = 0; j < part.inverse_binds.size(); ++j)
      part.inverse_binds[j].matrix() = matrices.col(Index(j)).reshaped(4, 4);
  }
  read_influences(file, primitive, part);
}

inline MeshPart read_part(const GltfFile& file, std::size_t node_index, const tinygltf::Primitive& primitive) {
  const auto& node = file.model.nodes[node_index];
  MeshPart part;
  part.node = node_index;
  part.primitive = &primitive;
  file.check(primitive.attributes.count("POSITION") > 0, "a mesh of node '", node.name,
             "' has no positions: export the file again");
  part.points = read_accessor(file, primitive.attributes.at("POSITION"), TINYGLTF_TYPE_VEC3, "POSITION");
  part.faces = triangles_of(file, primitive, part.points.cols());
  const Index n = part.points.cols();
  for (const auto& target : primitive.targets) {
    auto& displacement = part.targets.emplace_back();
    if (target.count("POSITION") > 0)
      displacement = read_accessor(file, target.at("POSITION"), TINYGLTF_TYPE_VEC3, "a morph target", n);
  }
  if (node.skin >= 0 && primitive.attributes.count("JOINTS_0") > 0) read_skin(file, node.skin, primitive, part);
  return part;
}

/// For each node whether it is the one of that name, or below one that is.
inline std::vector<char> nodes_below(const GltfFile& file, const Hierarchy& tree, const std::string& name) {
  std::vector<char> below(file.model.nodes.size(), name.empty() ? 1 : 0);
  std::string names;
  bool found = name.empty();
  for (const int node : tree.order) {
    const auto i = static_cast<std::size_t>(node);
    const auto& n = file.model.nodes[i];
    if (n.name == name) below[i] = 1, found = true;
    if (tree.parent[i] >= 0 && below[static_cast<std::size_t>(tree.parent[i])] != 0) below[i] = 1;
    if (n.mesh >= 0) names += (names.empty() ? "" : ", ") + n.name;
  }
  file.check(found, "there is no node '", name, "': nodes with a mesh are ", names);
  return below;
}

/// The triangles of all meshes that the file's scene shows, at the chosen node or below it, in the order of its nodes.
inline std::vector<MeshPart> read_parts(const GltfFile& file, const Hierarchy& tree, const std::string& node_name) {
  const auto& model = file.model;
  std::vector<char> shown(model.nodes.size(), model.scenes.empty() ? 1 : 0);
  if (!model.scenes.empty())
    for (const int root : at(file, model.scenes, std::max(model.defaultScene, 0), "scene").nodes) {
      at(file, model.nodes, root, "node");
      shown[static_cast<std::size_t>(root)] = 1;
    }
  const std::vector<char> chosen = nodes_below(file, tree, node_name);
  std::vector<MeshPart> parts;
  for (const int node : tree.order) {
    const auto i = static_cast<std::size_t>(node);
    if (tree.parent[i] >= 0 && shown[static_cast<std::size_t>(tree.parent[i])] != 0) shown[i] = 1;
    if (shown[i] == 0 || chosen[i] == 0 || model.nodes[i].mesh < 0) continue;
    for (const auto& primitive : at(file, model.meshes, model.nodes[i].mesh, "mesh").primitives)
      if (primitive.mode >= TINYGLTF_MODE_TRIANGLES && primitive.mode <= TINYGLTF_MODE_TRIANGLE_FAN)
        parts.push_back(read_part(file, i, primitive));
  }
  return parts;
}

/// Morph targets act before skins, and a skinned mesh goes where its joints are, not its own node.
/// source   glTF 2.0, sections 3.7.2.2 and 3.7.3.3
inline Mat3X posed_points(const MeshPart& part, const ScenePose& pose) {
  Mat3X points = part.points;
  const Eigen::VectorXd& morph = pose.weights[part.node];
  for (std::size_t k = 0; k < part.targets.size() && Index(k) < morph.size(); ++k)
    if (morph[Index(k)] != 0 && part.targets[k].cols() > 0) points += morph[Index(k)] * part.targets[k];
  if (part.skin == nullptr) return pose.places[part.node] * points;

  std::vector<Eigen::Matrix<double, 3, 4>> moves;
  for (std::size_t j = 0; j < part.inverse_binds.size(); ++j)
    moves.push_back((pose.places[std::size_t(part.skin->joints[j])] * part.inverse_binds[j]).affine());
  for (Index v = 0; v < points.cols(); ++v) {
    Eigen::Matrix<double, 3, 4> blend = Eigen::Matrix<double, 3, 4>::Zero();
    for (Index k = 0; k < part.weights.rows(); ++k)
      if (part.weights(k, v) != 0) blend += part.weights(k, v) * moves[std::size_t(part.joints(k, v))];
    points.col(v) = blend * points.col(v).homogeneous();
  }
  return points;
}

inline std::string last_part(const std::string& clip) { return clip.substr(clip.rfind('|') + 1); }

inline std::size_t find_clip(const GltfFile& file, const std::string& wanted) {
  const std::size_t count = file.model.animations.size();
  require<UnusableMesh>(count > 0, file.name, " has no animation: export the mesh with at least one clip");
  if (wanted.empty()) return 0;
  std::string names;
  std::vector<std::size_t> matches;
  for (std::size_t i = 0; i < count; ++i) {
    const std::string name = clip_name(file, i);
    if (name == wanted) return i;
    if (last_part(name) == wanted) matches.push_back(i);
    names += (i == 0 ? "" : ", ") + name;
  }
  file.check(matches.size() <= 1, "several clips end in '", wanted, "': give the full name, one of ", names);
  file.check(!matches.empty(), "there is no clip '", wanted, "': choose one of ", names);
  return matches.front();
}

/// One sequence of all parts, their vertices and faces in the order of the parts.
inline MeshSequence merged(const std::vector<MeshPart>& parts) {
  MeshSequence sequence;
  Index vertices = 0, faces = 0;
  for (const MeshPart& part : parts) {
    sequence.faces.conservativeResize(3, faces + part.faces.cols());
    sequence.faces.rightCols(part.faces.cols()) = part.faces.array() + static_cast<int>(vertices);
    faces += part.faces.cols();
    vertices += part.points.cols();
  }
  return sequence;
}

inline Mat3X posed_points(const std::vector<MeshPart>& parts, const ScenePose& pose) {
  Index vertices = 0, filled = 0;
  for (const MeshPart& part : parts) vertices += part.points.cols();
  Mat3X points(3, vertices);
  for (const MeshPart& part : parts) {
    points.middleCols(filled, part.points.cols()) = posed_points(part, pose);
    filled += part.points.cols();
  }
  return points;
}

inline GltfAnimation bake(const GltfFile& file, const GltfReadOptions& options) {
  const bool still = options.allow_still && options.clip.empty() && file.model.animations.empty();
  const Clip clip = still ? Clip{} : read_clip(file, find_clip(file, options.clip));
  require<UnusableMesh>(still || clip.end > clip.start, file.name, ": clip '", clip.name,
                        "' holds a single pose and no motion: choose another clip");
  const Hierarchy tree = hierarchy(file);
  const auto parts = read_parts(file, tree, options.node);
  std::vector<NodePose> rest;
  for (const auto& node : file.model.nodes) rest.push_back(rest_pose(file, node));

  GltfAnimation result{merged(parts), clip.name, options.clip.empty() && !still};
  MeshSequence& sequence = result.sequence;
  require<UnusableMesh>(sequence.faces.cols() > 0, file.name,
                        " has no triangles in its scene: export a mesh with faces");
  const double duration = clip.end - clip.start;
  sequence.duration = still ? 1 : duration;
  sequence.name = std::filesystem::path(file.name).stem().string() + (still ? "" : "_" + last_part(clip.name));
  double frames = still ? 1 : options.frames;
  if (!still && options.rate > 0) frames = std::max(2.0, std::round(options.rate * duration) + 1);
  file.check(frames <= 1e5, "clip '", clip.name, "' has ", frames, " frames at ", options.rate,
             " a second: give a lower rate");
  for (int k = 0; k < int(frames); ++k) {
    const double time = clip.start + (still ? 0 : duration * k / (frames - 1));
    sequence.frames.push_back(posed_points(parts, pose_at(tree, rest, clip, time)));
    file.check(sequence.frames.back().allFinite(), "frame ", k, " of clip '", clip.name,
               "' has positions that are not finite numbers: export the animation again");
  }
  return result;
}

}  // namespace detail::gltf

/// Names and durations of the animations in a .glb or .gltf file; unnamed ones are called animation_0, animation_1, ...
/// throws   FileError
inline std::vector<ClipInfo> gltf_clips(const std::filesystem::path& path) {
  const auto file = detail::gltf::load_gltf(path);
  std::vector<ClipInfo> clips;
  for (std::size_t i = 0; i < file.model.animations.size(); ++i) {
    const auto clip = detail::gltf::read_clip(file, i);
    clips.push_back({clip.name, clip.end - clip.start});
  }
  return clips;
}

/// The triangles of a .glb or .gltf file at equidistant times from a clip's first key to its last: skins, morph targets
/// and moving nodes, step, linear and cubic interpolation; textures and lines are ignored, the scene's meshes merged.
/// accuracy that of the file's floats [io/gltf_reader_test: closed forms]
/// throws   FileError for damaged files and unknown clips, UnusableMesh where there is no animation or no triangle
inline GltfAnimation read_gltf(const std::filesystem::path& path, const GltfReadOptions& options = {}) {
  require(options.rate > 0 || options.frames >= 2, "read_gltf: ", options.frames, " frames, give at least 2");
  require(options.rate >= 0 && std::isfinite(options.rate), "read_gltf: ", options.rate,
          " frames a second, give a positive number or 0");
  return detail::gltf::bake(detail::gltf::load_gltf(path), options);
}

}  // namespace dsns
