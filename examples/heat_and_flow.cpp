// Eigenfunctions, heat and mean-curvature flow of surfaces that are functions, without a mesh: the tones of an
// ellipsoid, heat that spreads from its tip, a body that becomes a sphere.  heat_and_flow [HEAT.glb FLOW.glb]; without
// files, figures only.
#include <dsns/geometry/mean_curvature_flow.hpp>
#include <dsns/geometry/spectrum.hpp>
#include <dsns/io/gltf_writer.hpp>
#include <dsns/mesh/sphere_mesh.hpp>
#include <dsns/surface/analytic.hpp>
#include <dsns/surface/any_surface.hpp>

#include <cmath>
#include <iostream>

using namespace dsns;

namespace {

LimbedBody made_limbs() {
  LimbedBody body;
  body.axes = {0.75, 1, 0.6};
  const auto limb = [](double x, double y, const Vec3d& reach) { return Limb{Vec3d(x, y, 0).normalized(), 9, reach}; };
  body.limbs = {limb(1, 0.5, {0.9, 0.15, 0}), limb(-1, 0.5, {-0.9, 0.15, 0}), limb(0.6, -1, {0.25, -1, 0}),
                limb(-0.6, -1, {-0.25, -1, 0}), limb(0, 1, {0, 0.45, 0})};
  return body;
}

/// Copies of a sphere's mesh side by side, as one body at rest with a colour for each vertex.
class Row {
 public:
  explicit Row(const TriangleMesh& sphere) : sphere_(sphere) {}

  void add(const Mat3X& vertices, const Mat3X& colors) {
    const Index n = vertices.cols(), before = vertices_.cols(), faces = faces_.cols();
    const double left = vertices.row(0).minCoeff(), right = vertices.row(0).maxCoeff();
    vertices_.conservativeResize(3, before + n);
    vertices_.rightCols(n) = vertices.colwise() + Vec3d(end_ - left, 0, 0);
    colors_.conservativeResize(3, before + n);
    colors_.rightCols(n) = colors;
    faces_.conservativeResize(3, faces + sphere_.faces.cols());
    faces_.rightCols(sphere_.faces.cols()) = sphere_.faces.array() + static_cast<int>(before);
    end_ += 1.12 * (right - left);
  }
  MeshSequence body(const char* name) const {
    MeshSequence still;
    still.frames = {vertices_, vertices_};
    still.faces = faces_;
    still.name = name;
    return still;
  }
  const Mat3X& colors() const { return colors_; }

 private:
  TriangleMesh sphere_;
  Mat3X vertices_, colors_;
  Faces faces_;
  double end_ = 0;
};

/// From night over red and yellow to white, for x in [0, 1].
Vec3d glow(double x) { return Vec3d(3 * x, 3 * x - 1, 3 * x - 2).cwiseMax(Vec3d(0.03, 0.035, 0.06)).cwiseMin(1); }
/// Blue, white and red, for x in [-1, 1]: linear RGB.
Vec3d signs(double x) {
  const double a = std::min(1.0, std::abs(x));
  return x > 0 ? Vec3d(1 - 0.35 * a, 1 - 0.97 * a, 1 - 0.97 * a) : Vec3d(1 - 0.97 * a, 1 - 0.8 * a, 1 - 0.4 * a);
}

template <class Color>
Mat3X colored(const Eigen::VectorXd& values, const Color& color) {
  Mat3X colors(3, values.size());
  for (Index i = 0; i < values.size(); ++i) colors.col(i) = color(values[i]);
  return colors;
}

/// Stripes of latitude and longitude, which show where the points of the sphere go.
Mat3X stripes(const Mat3X& s) {
  Mat3X colors(3, s.cols());
  for (Index i = 0; i < s.cols(); ++i) {
    const double u = std::asin(s(1, i)) * 9 / pi, v = std::atan2(s(0, i), s(2, i)) * 9 / pi;
    const bool odd = (static_cast<int>(std::floor(u)) + static_cast<int>(std::floor(v + 0.5))) % 2 != 0;
    colors.col(i) = odd ? Vec3d(0.75, 0.36, 0.1) : Vec3d(0.9, 0.8, 0.6);
  }
  return colors;
}

MeshSequence sequence(const std::vector<HarmonicSurface>& surfaces, const TriangleMesh& sphere, double scale,
                      const char* name) {
  MeshSequence moving;
  for (const auto& f : surfaces) moving.frames.push_back(scale * f.positions(sphere.vertices));
  moving.faces = sphere.faces;
  moving.duration = 4;
  moving.name = name;
  return moving;
}

std::vector<double> equal_times(double end, int count) {
  std::vector<double> times;
  for (int k = 0; k < count; ++k) times.push_back(end * k / (count - 1));
  return times;
}

}  // namespace

int main(int argc, char** argv) try {
  const bool pictures = argc == 3;

  const Ellipsoid ellipsoid{5, 2, 1};
  const auto spectrum = laplace_beltrami_spectrum(ellipsoid, {.degree = pictures ? 30 : 14});
  std::cout << "ellipsoid 1:2:5, area " << spectrum.summary.area << "; " << trusted_count(spectrum, 1e-6) << " of "
            << spectrum.size() << " eigenvalues are good to 1e-6\nlambda:";
  for (Index k = 0; k < 8; ++k) std::cout << ' ' << spectrum.eigenvalues[k];

  const Vec3d source = Vec3d(-0.75, 0.4, 0.53).normalized();
  std::cout << "\nheat of a unit at one point, there and at the far tip:";
  for (const double t : {0.6, 3.0, 15.0}) {
    const Mat3X far = Vec3d::UnitX();
    std::cout << "  t = " << t << ": " << heat_kernel(spectrum, source, source, t)(0, 0) << " and "
              << heat_kernel(spectrum, far, source, t)(0, 0);
  }

  const LimbedBody limbed = made_limbs();
  const HarmonicSurface body = project_on_harmonics(at_time(limbed, 0), pictures ? 24 : 10);
  const MeanCurvatureFlow round = mean_curvature_flow(body, {.times = equal_times(2, 9),
                                                             .step = 0.05,
                                                             .variant = CurvatureFlow::conformalized,
                                                             .area = FlowArea::kept,
                                                             .largest_turn = pi});
  const auto& m = round.summary;
  const double before = sphericity(m.areas.front(), m.volumes.front()),
               after = sphericity(m.areas.back(), m.volumes.back());
  std::cout << "\nlimbed body, 36 pi V^2 / A^3 under the conformalised flow: " << before << " -> " << after << '\n';

  if (pictures) {
    const TriangleMesh sphere = icosphere(6);
    Row heat(sphere), tones(sphere);
    for (const double t : {0.1, 0.6, 3.0}) {
      const Eigen::VectorXd k = heat_kernel(spectrum, sphere.vertices, source, t);
      heat.add(positions(ellipsoid, sphere.vertices), colored(k / k.maxCoeff(), glow));
    }
    const auto of_body = laplace_beltrami_spectrum(body, {.degree = 24, .count = 40});
    for (const Index k : {1, 2, 5, 9, 16, 30}) {
      const Eigen::VectorXd phi = of_body.eigenfunction(k).values(sphere.vertices);
      tones.add(2 * body.positions(sphere.vertices), colored(phi / (0.8 * phi.cwiseAbs().maxCoeff()), signs));
    }
    GltfWriteOptions options;
    options.colors.assign(2, Vec3d::Ones());
    options.vertex_colors = {heat.colors(), tones.colors()};
    write_gltf(argv[1], {heat.body("heat kernel"), tones.body("eigenfunctions")}, options);

    const HarmonicSurface start = project_on_harmonics(ellipsoid, 20);
    const MeanCurvatureFlow shrinking =
        mean_curvature_flow(start, {.times = equal_times(0.72, 9), .step = 0.01, .largest_turn = pi});
    for (std::size_t k = 0; k < shrinking.summary.times.size(); k += 12)
      std::cout << "t = " << shrinking.summary.times[k] << ": area " << shrinking.summary.areas[k] << '\n';
    options.vertex_colors.assign(2, stripes(sphere.vertices));
    write_gltf(argv[2],
               {sequence(shrinking.surfaces, sphere, 1, "mean-curvature flow"),
                sequence(round.surfaces, sphere, 2.2, "conformalised flow, area kept")},
               options);
  }
  return after > 0.95 ? 0 : 1;
} catch (const Error& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
