// How a network comes near a known surface, derivatives and all: error of positions, normals, mean and Gaussian curvature
// while it is trained, on an ellipsoid 1:2:5 composed with a diffeomorphism of degree 4 and on a bumpy sphere.
//   neural_curvature [SECONDS [FILE.csv]]      about so many CPU-seconds a network (60), one thread
#include <dsns/geometry/curvature.hpp>
#include <dsns/nn/fit.hpp>
#include <dsns/sphere/diffeomorphism.hpp>
#include <dsns/surface/adapters.hpp>
#include <dsns/surface/analytic.hpp>
#include <dsns/surface/any_surface.hpp>
#include <dsns/surface/motion.hpp>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace dsns;

struct Errors {
  double distance, normal_deg, mean, gaussian;
};

/// Root mean squares over the sphere: distance in units of the size, relative for curvatures; the mean angle.
Errors errors(const NeuralSurface& network, const AnyAnimatedSurface& exact, const ChartBatch& charts) {
  const SurfaceJets a = network.jets(charts, 0), b = exact.jets(charts, 0);
  const Curvature ca = curvature(a), cb = curvature(b);
  const Mat3X na = unit_normals(a), nb = unit_normals(b);
  double angle = 0;
  for (Index i = 0; i < charts.size(); ++i) angle += angle_between(na.col(i), nb.col(i)) / double(charts.size());
  return {(a.f - b.f).norm() / std::sqrt(double(charts.size())) / network.scale(), angle * 180 / pi,
          (ca.mean - cb.mean).norm() / cb.mean.norm(), (ca.gaussian - cb.gaussian).norm() / cb.gaussian.norm()};
}

}  // namespace

int main(int argc, char** argv) {
  const double seconds = argc > 1 ? std::atof(argv[1]) : 60;
  std::ofstream csv;
  if (argc > 2) csv.open(argv[2]);
  csv << "surface,embedding,cpu_seconds,steps,rms_distance,normal_angle_deg,mean_curvature,gaussian_curvature\n";

  const SphereDiffeomorphism gamma = random_diffeomorphism(3, 4, 0.15);
  const std::vector<std::pair<std::string, AnyAnimatedSurface>> surfaces = {
      {"ellipsoid", AnyAnimatedSurface(resting(reparametrized(Ellipsoid{1, 2, 5}, gamma)))},
      {"bumpy sphere", AnyAnimatedSurface(resting(BumpySphere{0.2, 4}))}};
  SurfaceEncoding raw, paper = paper_encoding();
  raw.harmonic_degree = 1;  // the coordinates of the point
  raw.harmonic_decay = 0;
  raw.time_frequencies = 0;
  paper.time_octaves = 0;
  const ChartBatch charts = charts_at(fibonacci_sphere(4001).points);  // none of the fit's points is among them

  std::printf("%-14s %-6s %8s %7s %12s %10s %10s %10s\n", "surface", "input", "CPU s", "steps", "distance", "normals",
              "H", "K");
  for (const auto& [name, exact] : surfaces)
    for (const auto& [input, encoding] : {std::pair<std::string, SurfaceEncoding>{"raw", raw}, {"paper", paper}}) {
      double next = 0.5;
      const auto print = [&](double cpu, int steps, const NeuralSurface& network) {
        const Errors e = errors(network, exact, charts);
        std::printf("%-14s %-6s %8.1f %7d %12.2e %9.4f° %10.5f %10.5f\n", name.c_str(), input.c_str(), cpu, steps,
                    e.distance, e.normal_deg, e.mean, e.gaussian);
        std::fflush(stdout);
        csv << name << ',' << input << ',' << cpu << ',' << steps << ',' << e.distance << ',' << e.normal_deg << ','
            << e.mean << ',' << e.gaussian << '\n';
      };
      FitOptions options;
      options.encoding = encoding;
      options.times = 1;
      options.batch = 1024;
      options.learning_rate = 1e-2;
      options.steps = 300;
      options.steps = int(300 * seconds / fit_neural_surface(exact, options).summary.cpu_seconds);
      options.observe_every = seconds / 240;
      options.observer = [&](const FitState& state) {
        if (state.cpu_seconds < next) return;
        next *= 1.4142;
        print(state.cpu_seconds, state.steps, state.surface);
      };
      const FitResult fit = fit_neural_surface(exact, options);
      print(fit.summary.cpu_seconds, fit.summary.steps, fit.surface);
    }
}
