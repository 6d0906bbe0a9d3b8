#include "scene.hpp"

#include <dsns/io/gltf_writer.hpp>

namespace dsns::program {

void Scene::add(MeshSequence body, Mat3X colors) {
  bodies_.push_back(std::move(body));
  colors_.push_back(std::move(colors));
}

void Scene::write(const std::filesystem::path& path) const {
  GltfWriteOptions options;
  options.vertex_colors = colors_;
  Vec3d travel = Vec3d::Zero();
  for (const auto& body : bodies_)
    travel = travel.cwiseMax((body.frames.back().rowwise().mean() - body.frames.front().rowwise().mean()).cwiseAbs());
  const Index axis = travel.x() > travel.z() ? 2 : 0;
  double place = 0, last_half = 0;
  for (const auto& body : bodies_) {
    double low = body.frames.front().row(axis).minCoeff(), high = body.frames.front().row(axis).maxCoeff();
    for (const auto& frame : body.frames) {
      low = std::min(low, frame.row(axis).minCoeff());
      high = std::max(high, frame.row(axis).maxCoeff());
    }
    const double half = 0.55 * (high - low);
    if (!options.offsets.empty()) place += last_half + half;
    options.offsets.push_back((place - (low + high) / 2) * Vec3d::Unit(axis));
    last_half = half;
  }
  write_gltf(path, bodies_, options);
}

namespace {

/// Where points lie in the box of others.
Mat3X colors_in_box(const Mat3X& points, const Mat3X& others) {
  const Vec3d low = others.rowwise().minCoeff(), extent = (others.rowwise().maxCoeff() - low).cwiseMax(1e-300);
  Mat3X colors(3, points.cols());
  for (Index i = 0; i < points.cols(); ++i)
    colors.col(i) =
        (0.1 + 0.75 * (Vec3d(points.col(i)) - low).array() / extent.array()).matrix().cwiseMax(0).cwiseMin(1);
  return colors;
}

}  // namespace

Mat3X position_colors(const Mat3X& points) { return colors_in_box(points, points); }

Mat3X place_colors(const Body& body, const Mat3X& sphere) {
  return colors_in_box(body.surface.positions(sphere, 0), body.surface.positions(body.sphere.vertices, 0));
}

}  // namespace dsns::program
