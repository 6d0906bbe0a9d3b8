#pragma once
/// Motion written back on the meshes of a glTF file: its vertices, triangles, texture coordinates, colours, materials and
/// images stay, its skins and clips make room for one clip of morph targets.
#include <dsns/io/gltf_reader.hpp>
#include <dsns/io/gltf_writer.hpp>
#include <dsns/mesh/weld.hpp>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace dsns {

struct GltfOwnMeshOptions {
  double duration = 1;  ///< seconds of the clip
  std::string clip = "motion";
  std::string node;  ///< the one that was read, see GltfReadOptions
};

namespace detail::gltf {

/// All buffers and the images that have files or text of their own, one after the other; views and images point there.
inline std::vector<unsigned char> gather_bytes(const GltfFile& file, tinygltf::Model& model) {
  std::vector<unsigned char> bytes;
  const auto append = [&](const std::vector<unsigned char>& more) {
    bytes.resize((bytes.size() + 3) / 4 * 4);
    const std::size_t offset = bytes.size();
    bytes.insert(bytes.end(), more.begin(), more.end());
    return offset;
  };
  std::vector<std::size_t> offsets;
  for (const auto& buffer : model.buffers) offsets.push_back(append(buffer.data));
  for (auto& view : model.bufferViews) {
    view.byteOffset += at(file, offsets, view.buffer, "buffer");  // views that no mesh uses were not looked at before
    view.buffer = 0;
  }
  for (auto& image : model.images) {
    const bool png = image.image.size() > 4 && image.image[0] == 0x89 && image.image[1] == 'P';
    const bool jpeg = image.image.size() > 4 && image.image[0] == 0xFF && image.image[1] == 0xD8;
    if (image.bufferView < 0 && (png || jpeg)) {
      tinygltf::BufferView view;
      view.buffer = 0;
      view.byteOffset = append(image.image);
      view.byteLength = image.image.size();
      image.bufferView = static_cast<int>(model.bufferViews.size());
      image.mimeType = png ? "image/png" : "image/jpeg";
      image.uri.clear();
      model.bufferViews.push_back(std::move(view));
    }
    image.image.clear();
  }
  bytes.resize((bytes.size() + 3) / 4 * 4);
  return bytes;
}

inline bool starts_with(const std::string& text, std::string_view start) { return text.rfind(start, 0) == 0; }

/// The primitive as it is, without what gives it its shape.
inline tinygltf::Primitive without_shape(const tinygltf::Primitive& primitive) {
  tinygltf::Primitive bare = primitive;
  bare.targets.clear();
  bare.attributes.clear();
  for (const auto& [name, accessor] : primitive.attributes)
    if (name != "POSITION" && name != "NORMAL" && name != "TANGENT" && !starts_with(name, "JOINTS_") &&
        !starts_with(name, "WEIGHTS_"))
      bare.attributes[name] = accessor;
  return bare;
}

/// Unit normals of all vertices, the same on both sides of a seam.
inline Mat3Xf seamless_normals(const Mat3X& points, const Faces& welded, const std::vector<Index>& first) {
  return unit_normals(points, welded)(Eigen::all, first);
}

}  // namespace detail::gltf

/// Writes a GLB with the meshes of `original`, moving through `frames`.
/// frames   each 3 x n, in the scene's space: vertices in the order and number in which read_gltf gives them
/// throws   InvalidArgument for another number of vertices or fewer than two frames, FileError as read_gltf and write_gltf
inline void write_gltf_own_mesh(const std::filesystem::path& path, const std::filesystem::path& original,
                                const std::vector<Mat3X>& frames, const GltfOwnMeshOptions& options = {}) {
  namespace g = detail::gltf;
  require(frames.size() >= 2 && options.duration > 0, "write_gltf_own_mesh: ", frames.size(), " frames in ",
          options.duration, " s, give at least 2 and a positive duration");
  const g::GltfFile file = g::load_gltf(original, &g::keep_image);
  const g::Hierarchy tree = g::hierarchy(file);
  const std::vector<g::MeshPart> parts = g::read_parts(file, tree, options.node);
  MeshSequence all = g::merged(parts);
  Index vertices = 0;
  for (const auto& part : parts) vertices += part.points.cols();
  for (const Mat3X& frame : frames)
    require(frame.cols() == vertices && frame.allFinite(), "write_gltf_own_mesh: a frame has ", frame.cols(),
            " vertices, the meshes of ", original.string(), " have ", vertices, "; and all must be finite");
  all.frames = frames;
  const std::vector<Index> first = coincident_vertices(all, 1e-6, 4);
  const Faces welded = all.faces.unaryExpr([&](int v) { return static_cast<int>(first[std::size_t(v)]); });

  tinygltf::Model model = file.model;
  std::vector<unsigned char> bytes = g::gather_bytes(file, model);
  model.nodes.clear();
  model.meshes.clear();
  model.skins.clear();
  model.animations.clear();
  model.cameras.clear();
  model.scenes.assign(1, {});
  model.defaultScene = 0;
  g::GltfBuilder builder(std::move(model), std::move(bytes));
  std::vector<g::Mat3Xf> normals;
  for (const Mat3X& frame : frames) normals.push_back(g::seamless_normals(frame, welded, first));
  tinygltf::Animation animation;
  animation.name = options.clip;
  Index begin = 0;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const g::MeshPart& part = parts[p];
    const Index n = part.points.cols();
    if (p == 0 || parts[p - 1].node != part.node) {  // the primitives of one node stay together
      tinygltf::Node node;
      node.name = file.model.nodes[part.node].name;
      node.mesh = static_cast<int>(builder.model.meshes.size());
      const int index = static_cast<int>(builder.model.nodes.size());
      builder.model.nodes.push_back(std::move(node));
      builder.model.scenes.front().nodes.push_back(index);
      tinygltf::Mesh& mesh = builder.model.meshes.emplace_back();
      mesh.name = file.model.nodes[part.node].name;
      mesh.weights.assign(frames.size() - 1, 0.0);
      g::append_motion(builder, animation, index, static_cast<int>(frames.size()), options.duration);
    }
    const g::Mat3Xf points = frames.front().middleCols(begin, n).cast<float>();
    auto& primitive = builder.model.meshes.back().primitives.emplace_back(g::without_shape(*part.primitive));
    primitive.attributes["POSITION"] = builder.append_vectors(points);
    primitive.attributes["NORMAL"] = builder.append_vectors(normals[0].middleCols(begin, n));
    for (std::size_t k = 1; k < frames.size(); ++k)
      primitive.targets.push_back(
          {{"POSITION", builder.append_vectors((frames[k].middleCols(begin, n) - points.cast<double>()).cast<float>())},
           {"NORMAL", builder.append_vectors((normals[k] - normals[0]).middleCols(begin, n))}});
    require<FileError>(builder.size() < std::numeric_limits<std::int32_t>::max(), path.string(),
                       " would exceed 2 GB: write fewer frames");
    begin += n;
  }
  builder.model.animations.push_back(std::move(animation));
  write_file_atomically(path, builder.glb());
}

}  // namespace dsns
