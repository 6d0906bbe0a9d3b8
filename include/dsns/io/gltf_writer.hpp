#pragma once
/// Moving meshes as a GLB file that any viewer plays: a morph target for every frame but the first, and one clip.
#include <dsns/core/errors.hpp>
#include <dsns/core/types.hpp>
#include <dsns/io/atomic_file.hpp>
#include <dsns/mesh/triangle_mesh.hpp>

#include <tiny_gltf.h>

#include <bit>
#include <cstdint>
#include <cstring>
#include <exception>
#include <filesystem>
#include <limits>
#include <sstream>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace dsns {

/// Lists by body may be empty: then all bodies stand where they are, grey, without colours of their own.
struct GltfWriteOptions {
  double duration = 0;  ///< seconds of the clip; 0: the first body's
  std::string clip = "motion";
  std::vector<Vec3d> offsets;        ///< by body, where it stands
  std::vector<Vec3d> colors;         ///< by body, linear RGB in [0, 1]
  std::vector<Mat3X> vertex_colors;  ///< by body, 3 x n linear RGB in [0, 1]; 3 x 0: none
};

namespace detail::gltf {

static_assert(std::endian::native == std::endian::little, "glTF is little-endian: append() would have to swap bytes");

using Mat3Xf = Eigen::Matrix<float, 3, Eigen::Dynamic>;

/// A model under construction, with all its numbers in one buffer.
class GltfBuilder {
 public:
  tinygltf::Model model;

  GltfBuilder() {
    model.asset.version = "2.0";
    model.asset.generator = "dsns";
    model.scenes.emplace_back();
    model.defaultScene = 0;
  }

  /// A model to be added to, with all its numbers in one buffer.
  GltfBuilder(tinygltf::Model whole, std::vector<unsigned char> bytes)
      : model(std::move(whole)), bytes_(std::move(bytes)) {
    model.buffers.clear();
  }

  /// The accessor of a matrix in the order of its columns; `type` is the kind of element, `target` of buffer or 0.
  template <class Matrix>
  int append(const Matrix& values, int type, int target) {
    using Scalar = typename Matrix::Scalar;
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = bytes_.size();
    view.byteLength = sizeof(Scalar) * static_cast<std::size_t>(values.size());
    view.target = target;
    bytes_.resize(bytes_.size() + view.byteLength);
    std::memcpy(bytes_.data() + view.byteOffset, values.data(), view.byteLength);

    tinygltf::Accessor accessor;
    accessor.bufferView = static_cast<int>(model.bufferViews.size());
    accessor.componentType =
        std::is_same_v<Scalar, float> ? TINYGLTF_COMPONENT_TYPE_FLOAT : TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    accessor.type = type;
    const auto components = tinygltf::GetNumComponentsInType(std::uint32_t(type));
    const auto elements = values.reshaped(components, values.size() / components);
    accessor.count = static_cast<std::size_t>(elements.cols());
    for (Index k = 0; k < components; ++k) {
      accessor.minValues.push_back(double(elements.row(k).minCoeff()));
      accessor.maxValues.push_back(double(elements.row(k).maxCoeff()));
    }
    model.bufferViews.push_back(std::move(view));
    model.accessors.push_back(std::move(accessor));
    return static_cast<int>(model.accessors.size()) - 1;
  }

  int append_vectors(const Mat3Xf& values) { return append(values, TINYGLTF_TYPE_VEC3, TINYGLTF_TARGET_ARRAY_BUFFER); }

  std::string glb() {
    model.buffers.emplace_back().data = std::move(bytes_);
    std::ostringstream stream;
    try {
      tinygltf::TinyGLTF().WriteGltfSceneToStream(&model, stream, false, true);
    } catch (const std::exception& failure) {
      throw InvalidArgument(message("write_gltf: a name is not UTF-8 text (", failure.what(), "): rename the body"));
    }
    return std::move(stream).str();
  }

  std::size_t size() const { return bytes_.size(); }

 private:
  std::vector<unsigned char> bytes_;
};

/// glTF asks for unit normals, also at vertices that no face uses.
inline Mat3Xf unit_normals(const Mat3X& vertices, const Faces& faces) {
  Mat3X normals = vertex_normals(vertices, faces);
  for (Index v = 0; v < normals.cols(); ++v)
    if (!(normals.col(v).norm() > 0.5)) normals.col(v) = Vec3d::UnitZ();
  return normals.cast<float>();
}

inline tinygltf::Material plain_material(const Vec3d& color) {
  tinygltf::Material material;
  material.doubleSided = true;
  material.pbrMetallicRoughness.baseColorFactor = {color.x(), color.y(), color.z(), 1};
  material.pbrMetallicRoughness.metallicFactor = 0;
  material.pbrMetallicRoughness.roughnessFactor = 0.7;
  return material;
}

/// The mesh of a body: its first frame, and the other frames as displacements from it. The displacements are taken
/// between floats, so that a viewer that adds them gets the frame back to a rounding of its largest term.
inline tinygltf::Mesh morphing_mesh(GltfBuilder& builder, const MeshSequence& body, const Mat3X& vertex_colors) {
  const Mat3Xf points = body.frames.front().cast<float>();
  const Mat3Xf normals = unit_normals(body.frames.front(), body.faces);
  tinygltf::Mesh mesh;
  mesh.name = body.name;
  auto& primitive = mesh.primitives.emplace_back();
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  primitive.material = static_cast<int>(builder.model.materials.size());
  primitive.attributes["POSITION"] = builder.append_vectors(points);
  primitive.attributes["NORMAL"] = builder.append_vectors(normals);
  if (vertex_colors.cols() > 0)
    primitive.attributes["COLOR_0"] = builder.append_vectors(vertex_colors.cwiseMax(0).cwiseMin(1).cast<float>());
  primitive.indices = builder.append(Eigen::Matrix<std::uint32_t, 3, Eigen::Dynamic>(body.faces.cast<std::uint32_t>()),
                                     TINYGLTF_TYPE_SCALAR, TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
  for (std::size_t k = 1; k < body.frames.size(); ++k) {
    const Mat3X moved = body.frames[k] - points.cast<double>();
    primitive.targets.push_back(
        {{"POSITION", builder.append_vectors(moved.cast<float>())},
         {"NORMAL", builder.append_vectors(unit_normals(body.frames[k], body.faces) - normals)}});
  }
  mesh.weights.assign(primitive.targets.size(), 0.0);
  return mesh;
}

/// Frame k is shown at its time: target k - 1 has weight one there and none at the other keys.
inline void append_motion(GltfBuilder& builder, tinygltf::Animation& animation, int node, int frames, double duration) {
  const Eigen::RowVectorXf times = Eigen::RowVectorXd::LinSpaced(frames, 0, duration).cast<float>();
  Eigen::MatrixXf weights = Eigen::MatrixXf::Zero(frames - 1, frames);
  weights.diagonal(1).setOnes();
  tinygltf::AnimationSampler sampler;
  sampler.input = builder.append(times, TINYGLTF_TYPE_SCALAR, 0);
  sampler.output = builder.append(weights, TINYGLTF_TYPE_SCALAR, 0);
  tinygltf::AnimationChannel channel;
  channel.sampler = static_cast<int>(animation.samplers.size());
  channel.target_node = node;
  channel.target_path = "weights";
  animation.samplers.push_back(std::move(sampler));
  animation.channels.push_back(std::move(channel));
}

inline void check_bodies(const std::vector<MeshSequence>& bodies, const GltfWriteOptions& options) {
  require(!bodies.empty(), "write_gltf: no bodies, give at least one");
  const auto matches = [&](std::size_t size) { return size == 0 || size == bodies.size(); };
  require(matches(options.offsets.size()) && matches(options.colors.size()) && matches(options.vertex_colors.size()),
          "write_gltf: ", options.offsets.size(), " offsets, ", options.colors.size(), " colors and ",
          options.vertex_colors.size(), " lists of vertex colors for ", bodies.size(),
          " bodies: give one for each body or none");
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const MeshSequence& body = bodies[b];
    const Index n = body.vertex_count();
    require(body.frame_count() >= 2 && body.faces.cols() >= 1, "write_gltf: body ", b, " has ", body.frame_count(),
            " frames and ", body.faces.cols(), " faces, an animation needs at least 2 frames and a face");
    require(body.faces.minCoeff() >= 0 && body.faces.maxCoeff() < n, "write_gltf: body ", b, " has faces from ",
            body.faces.minCoeff(), " to ", body.faces.maxCoeff(), " for ", n, " vertices");
    for (const Mat3X& frame : body.frames)
      require(frame.cols() == n && frame.allFinite(), "write_gltf: a frame of body ", b, " has ", frame.cols(),
              " vertices (the first ", n, ") or a position that is not finite");
    const Index colored = options.vertex_colors.empty() ? 0 : options.vertex_colors[b].cols();
    require(colored == 0 || colored == n, "write_gltf: ", colored, " vertex colors for the ", n, " vertices of body ",
            b);
  }
}

}  // namespace detail::gltf

/// Writes bodies into one GLB file: each a node with a mesh of its own, one clip that moves them all, a body's frames
/// equidistant over the clip. Whoever reads the file sees it whole or not at all.
/// accuracy 1e-7 of the largest coordinate, read back by read_gltf [io/gltf_writer_test]
/// throws   InvalidArgument for bodies that are no animation, FileError where the file cannot be written
inline void write_gltf(const std::filesystem::path& path, const std::vector<MeshSequence>& bodies,
                       const GltfWriteOptions& options = {}) {
  detail::gltf::check_bodies(bodies, options);
  const double duration = options.duration > 0 ? options.duration : bodies.front().duration;
  require(duration > 0, "write_gltf: the clip lasts ", duration, " s, give a positive duration");
  detail::gltf::GltfBuilder builder;
  tinygltf::Animation animation;
  animation.name = options.clip;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Mat3X vertex_colors = options.vertex_colors.empty() ? Mat3X() : options.vertex_colors[b];
    auto mesh = detail::gltf::morphing_mesh(builder, bodies[b], vertex_colors);
    builder.model.materials.push_back(
        detail::gltf::plain_material(options.colors.empty() ? Vec3d::Constant(0.6) : options.colors[b]));
    tinygltf::Node node;
    node.name = bodies[b].name;
    node.mesh = static_cast<int>(b);
    if (!options.offsets.empty())
      node.translation = {options.offsets[b].x(), options.offsets[b].y(), options.offsets[b].z()};
    builder.model.meshes.push_back(std::move(mesh));
    builder.model.nodes.push_back(std::move(node));
    builder.model.scenes.front().nodes.push_back(static_cast<int>(b));
    detail::gltf::append_motion(builder, animation, static_cast<int>(b), bodies[b].frame_count(), duration);
    require<FileError>(builder.size() < std::numeric_limits<std::int32_t>::max(), path.string(),
                       " would exceed 2 GB: write fewer frames or bodies");
  }
  builder.model.animations.push_back(std::move(animation));
  write_file_atomically(path, builder.glb());
}

inline void write_gltf(const std::filesystem::path& path, const MeshSequence& body,
                       const GltfWriteOptions& options = {}) {
  write_gltf(path, std::vector<MeshSequence>{body}, options);
}

}  // namespace dsns
