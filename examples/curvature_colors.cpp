// Colours a mesh by its mean curvature and writes it as glTF.  curvature_colors [FILE.glb#Clip [OUT.glb]]; without a file, a
// body from a formula. The mesh becomes a function on the sphere, so its curvature has a formula too: no differences of angles.
#include <dsns/elastic/normalization.hpp>
#include <dsns/geometry/curvature.hpp>
#include <dsns/io/gltf_reader.hpp>
#include <dsns/io/gltf_writer.hpp>
#include <dsns/io/source_name.hpp>
#include <dsns/mesh/repair.hpp>
#include <dsns/mesh/sphere_mesh.hpp>
#include <dsns/mesh/spherical_parameterization.hpp>
#include <dsns/surface/analytic.hpp>
#include <dsns/surface/harmonic.hpp>
#include <dsns/surface/sampled.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iostream>
#include <vector>

using namespace dsns;

namespace {

MeshSequence made_body() {
  LimbedBody body;
  body.axes = {1, 0.6, 0.5};
  body.limbs = {{Vec3d(0.8, -0.8, 0.5).normalized(), 12, Vec3d(0, -0.8, 0.1)},
                {Vec3d(-0.8, -0.8, 0).normalized(), 8, Vec3d(0, -0.7, 0)}};
  return sequence_of(body, icosphere(4), 16);
}

MeshSequence read_body(const char* name) {
  const SourceName source = parse_source(name);
  return repair(read_gltf(source.file, {source.clip, 16}).sequence).sequence;
}

/// White where the surface is flat, red where it bulges, blue where it is hollow; h in units of `full`.
Vec3d color(double h, double full) {
  const double x = std::clamp(h / full, -1.0, 1.0);
  return x > 0 ? Vec3d(1, 1 - x, 1 - x) : Vec3d(1 + x, 1 + x, 1);
}

}  // namespace

int main(int argc, char** argv) try {
  const NormalizedSequence body = normalize(argc > 1 ? read_body(argv[1]) : made_body());
  const Mat3X sphere = spherical_parameterization(body.sequence).sphere;
  const SampledSurface mesh(body.sequence, sphere);
  const HarmonicSurface smooth = project_on_harmonics(at_time(mesh, 0), 40).smoothed(40, 0.5e-3);
  const Eigen::VectorXd h = curvature(smooth, sphere).mean;

  std::vector<double> sizes(h.data(), h.data() + h.size());
  for (double& x : sizes) x = std::abs(x);
  const auto high = sizes.begin() + std::ptrdiff_t(sizes.size()) * 9 / 10;
  std::nth_element(sizes.begin(), high, sizes.end());  // full colour for a tenth of the vertices: limbs bend most
  Mat3X colors(3, sphere.cols());
  for (Index v = 0; v < sphere.cols(); ++v) colors.col(v) = color(h[v], *high);
  std::cout << "mean curvature from " << h.minCoeff() << " to " << h.maxCoeff() << " at " << sphere.cols()
            << " vertices of a surface of area 1\n";
  if (argc > 2) {
    GltfWriteOptions options;
    options.vertex_colors = {colors};
    write_gltf(argv[2], body.sequence, options);  // the colours of the first frame, on the whole clip
  }
} catch (const Error& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
