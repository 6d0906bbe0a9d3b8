// Fits a network to a surface of your own: any functor of a unit vector and a time, written for any scalar.
#include <dsns/geometry/curvature.hpp>
#include <dsns/nn/fit.hpp>
#include <dsns/surface/surface_error.hpp>

#include <iostream>

using namespace dsns;

namespace {

/// A bean that bends.
struct Bean {
  template <class T>
  Vec3<T> operator()(const Vec3<T>& s, const T& t) const {
    using std::sin;
    const T bend = 0.4 * sin(2.0 * pi * t);
    return {2.0 * s.x(), s.y() + bend * s.x() * s.x(), s.z()};
  }
};

}  // namespace

int main() {
  FitOptions options;
  options.encoding.harmonic_degree = 1;  // the coordinates of s themselves: the smoothest network
  options.encoding.time_frequencies = 2;
  options.points = 2000;
  options.times = 16;
  options.batch = 1024;
  options.steps = 400;
  const FitResult fit = fit_neural_surface(Bean{}, options);

  const Mat3X s = fibonacci_sphere(500).points;  // points and times that the fit never saw
  const SurfaceError e = compare(fit.surface, Bean{}, s, {0.21, 0.47, 0.83}, fit.surface.scale());
  const Curvature learnt = curvature(at_time(fit.surface, 0.47), s), exact = curvature(at_time(Bean{}, 0.47), s);
  std::cout << fit.summary.steps << " steps, " << fit.summary.cpu_seconds << " s\n"
            << "rms distance " << e.rms_distance << " of the size, normals " << e.normal_angle_mean_deg
            << " degrees, Gaussian curvature " << (learnt.gaussian - exact.gaussian).norm() / exact.gaussian.norm()
            << " relative\n";
  return e.rms_distance < 1e-2 ? 0 : 1;
}
