#pragma once
/// The clips of a glTF file and the pose of its nodes at a time.
#include <dsns/io/gltf_accessor.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace dsns {

struct ClipInfo {
  std::string name;
  double duration;  ///< seconds
};

namespace detail::gltf {

/// One animated property of one node. Columns of `values` are keys; a cubic spline has three columns a key (in-tangent,
/// value, out-tangent).
struct Track {
  enum class Target { translation, rotation, scale, weights };
  enum class Interpolation { step, linear, cubic };
  int node;
  Target target;
  Interpolation interpolation;
  Eigen::VectorXd times;
  Eigen::MatrixXd values;
};

struct Clip {
  std::string name;
  std::vector<Track> tracks;
  double start = 0, end = 0;  ///< seconds
};

inline Track read_track(const GltfFile& file, const tinygltf::AnimationSampler& sampler, int node, Track::Target target,
                        const std::string& what) {
  Track track{node, target, Track::Interpolation::linear, {}, {}};
  file.check(
      sampler.interpolation == "LINEAR" || sampler.interpolation == "STEP" || sampler.interpolation == "CUBICSPLINE",
      what, " is interpolated by '", sampler.interpolation, "': glTF knows LINEAR, STEP and CUBICSPLINE");
  if (sampler.interpolation == "STEP") track.interpolation = Track::Interpolation::step;
  if (sampler.interpolation == "CUBICSPLINE") track.interpolation = Track::Interpolation::cubic;
  track.times = read_accessor(file, sampler.input, TINYGLTF_TYPE_SCALAR, what + ", times").transpose();
  const Index keys = track.times.size();
  for (Index k = 1; k < keys; ++k)
    file.check(track.times[k] >= track.times[k - 1], what, " goes back in time from ", track.times[k - 1], " s to ",
               track.times[k], " s: export the animation again");
  const int type = target == Track::Target::weights    ? TINYGLTF_TYPE_SCALAR
                   : target == Track::Target::rotation ? TINYGLTF_TYPE_VEC4
                                                       : TINYGLTF_TYPE_VEC3;
  track.values = read_accessor(file, sampler.output, type, what);
  const Index columns = keys * (track.interpolation == Track::Interpolation::cubic ? 3 : 1);
  file.check(track.values.cols() % columns == 0 && (type == TINYGLTF_TYPE_SCALAR || track.values.cols() == columns),
             what, " has ", track.values.cols(), " values for ", keys, " keys: export the animation again");
  if (type == TINYGLTF_TYPE_SCALAR)
    track.values = Eigen::MatrixXd(track.values.reshaped(track.values.cols() / columns, columns));
  return track;
}

inline std::optional<Track::Target> target_named(std::string_view path) {
  if (path == "translation") return Track::Target::translation;
  if (path == "rotation") return Track::Target::rotation;
  if (path == "scale") return Track::Target::scale;
  if (path == "weights") return Track::Target::weights;
  return std::nullopt;
}

inline std::string clip_name(const GltfFile& file, std::size_t index) {
  const std::string& name = file.model.animations[index].name;
  return name.empty() ? message("animation_", index) : name;
}

inline Clip read_clip(const GltfFile& file, std::size_t index) {
  const auto& animation = file.model.animations[index];
  Clip clip;
  clip.name = clip_name(file, index);
  for (const auto& channel : animation.channels) {
    const auto target = target_named(channel.target_path);
    if (!target || channel.target_node < 0) continue;
    at(file, file.model.nodes, channel.target_node, "node");
    const std::string what = message("clip '", clip.name, "', ", channel.target_path, " of node ", channel.target_node);
    const auto& sampler = at(file, animation.samplers, channel.sampler, "animation sampler");
    clip.tracks.push_back(read_track(file, sampler, channel.target_node, *target, what));
    const auto& times = clip.tracks.back().times;
    const bool first = clip.tracks.size() == 1;
    clip.start = first ? times.minCoeff() : std::min(clip.start, times.minCoeff());
    clip.end = first ? times.maxCoeff() : std::max(clip.end, times.maxCoeff());
  }
  return clip;
}

/// The value of a track at a time, held constant before its first and after its last key.
/// source   glTF 2.0, appendix C (interpolation)
inline Eigen::VectorXd value_at(const Track& track, double time) {
  const auto& times = track.times;
  const bool cubic = track.interpolation == Track::Interpolation::cubic;
  const auto key = [&](Index k) { return track.values.col(cubic ? 3 * k + 1 : k); };
  const auto after = std::upper_bound(times.begin(), times.end(), time) - times.begin();
  if (after == 0) return key(0);
  if (after == times.size()) return key(after - 1);
  const Index a = after - 1, b = after;
  const double gap = times[b] - times[a], x = (time - times[a]) / gap;
  if (track.interpolation == Track::Interpolation::step) return key(a);
  if (cubic) {
    const double x2 = x * x, x3 = x2 * x;
    return (2 * x3 - 3 * x2 + 1) * key(a) + gap * (x3 - 2 * x2 + x) * track.values.col(3 * a + 2) +
           (3 * x2 - 2 * x3) * key(b) + gap * (x3 - x2) * track.values.col(3 * b);
  }
  if (track.target == Track::Target::rotation) {
    const Eigen::Quaterniond from(Eigen::Vector4d(key(a))), to(Eigen::Vector4d(key(b)));
    return from.normalized().slerp(x, to.normalized()).coeffs();
  }
  return (1 - x) * key(a) + x * key(b);
}

/// A node's place relative to its parent, and the weights of its morph targets.
struct NodePose {
  Vec3d translation = Vec3d::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Vec3d scale = Vec3d::Ones();
  Eigen::Affine3d matrix = Eigen::Affine3d::Identity();
  bool from_matrix = false;  ///< until the first animated property replaces the matrix
  Eigen::VectorXd weights;

  Eigen::Affine3d local() const {
    if (from_matrix) return matrix;
    return Eigen::Translation3d(translation) * rotation.normalized() * Eigen::Scaling(scale);
  }
};

inline NodePose rest_pose(const GltfFile& file, const tinygltf::Node& node) {
  NodePose pose;
  const auto values = [&](const std::vector<double>& list, std::size_t size, std::string_view what) {
    file.check(list.empty() || list.size() == size, "a node's ", what, " has ", list.size(), " numbers, not ", size,
               ": export the file again");
    return !list.empty();
  };
  if (values(node.translation, 3, "translation")) pose.translation = Vec3d::Map(node.translation.data());
  if (values(node.rotation, 4, "rotation")) pose.rotation = Eigen::Quaterniond(node.rotation.data());
  if (values(node.scale, 3, "scale")) pose.scale = Vec3d::Map(node.scale.data());
  if (values(node.matrix, 16, "matrix")) {
    pose.matrix.matrix() = Eigen::Matrix4d::Map(node.matrix.data());
    pose.from_matrix = true;
  }
  const auto& weights =
      node.weights.empty() && node.mesh >= 0 ? at(file, file.model.meshes, node.mesh, "mesh").weights : node.weights;
  pose.weights = Eigen::VectorXd::Map(weights.data(), Index(weights.size()));
  return pose;
}

inline void apply(const Track& track, double time, NodePose& pose) {
  const Eigen::VectorXd value = value_at(track, time);
  if (track.target == Track::Target::weights) {
    pose.weights = value;
    return;
  }
  pose.from_matrix = false;
  if (track.target == Track::Target::translation) pose.translation = value;
  if (track.target == Track::Target::rotation) pose.rotation = Eigen::Quaterniond(Eigen::Vector4d(value));
  if (track.target == Track::Target::scale) pose.scale = value;
}

/// Nodes in an order in which parents come before their children, with the parent of each (-1 for roots).
struct Hierarchy {
  std::vector<int> order, parent;
};

inline Hierarchy hierarchy(const GltfFile& file) {
  const auto& nodes = file.model.nodes;
  Hierarchy result;
  result.parent.assign(nodes.size(), -1);
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (const int child : nodes[i].children) {
      at(file, nodes, child, "node");
      int& parent = result.parent[static_cast<std::size_t>(child)];
      file.check(parent < 0, "node ", child, " has two parents: the file is damaged, export it again");
      parent = static_cast<int>(i);
    }
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (result.parent[i] < 0) result.order.push_back(static_cast<int>(i));
  for (std::size_t next = 0; next < result.order.size(); ++next) {
    const auto& children = nodes[static_cast<std::size_t>(result.order[next])].children;
    result.order.insert(result.order.end(), children.begin(), children.end());
  }
  file.check(result.order.size() == nodes.size(), "some nodes are their own ancestors: export the file again");
  return result;
}

/// Places of all nodes in the scene and their morph weights at one time of a clip.
struct ScenePose {
  std::vector<Eigen::Affine3d> places;
  std::vector<Eigen::VectorXd> weights;
};

inline ScenePose pose_at(const Hierarchy& tree, std::vector<NodePose> poses, const Clip& clip, double time) {
  for (const Track& track : clip.tracks) apply(track, time, poses[static_cast<std::size_t>(track.node)]);
  ScenePose scene;
  scene.places.resize(poses.size());
  for (const int node : tree.order) {
    const auto i = static_cast<std::size_t>(node);
    const int parent = tree.parent[i];
    scene.places[i] = poses[i].local();
    if (parent >= 0) scene.places[i] = scene.places[static_cast<std::size_t>(parent)] * scene.places[i];
  }
  for (NodePose& pose : poses) scene.weights.push_back(std::move(pose.weights));
  return scene;
}

}  // namespace detail::gltf
}  // namespace dsns
