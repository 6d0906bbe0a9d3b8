#include "catch.hpp"

#include <dsns/nn/fit.hpp>
#include <dsns/nn/fit_separable.hpp>
#include <dsns/surface/analytic.hpp>
#include <dsns/surface/surface_error.hpp>

namespace fit_test {

using namespace dsns;

namespace {

/// An ellipsoid whose axes pulse and that drifts.
struct PulsingEllipsoid {
  template <class T>
  Vec3<T> operator()(const Vec3<T>& s, const T& t) const {
    using std::sin;
    const T a = 2 + 0.3 * sin(2 * pi * t);
    return {a * s.x() + 5, (3 - a / 2) * s.y() - t, s.z()};
  }
};
static_assert(AnimatedSurface<PulsingEllipsoid>);

/// Cubic in time; notes the times at which its positions are asked.
struct Watched {
  std::vector<double>* asked = nullptr;
  template <class T>
  Vec3<T> operator()(const Vec3<T>& s, const T& t) const {
    return {(2.0 + t * t * t - t) * s.x(), s.y(), (1.0 + t * t) * s.z()};
  }
  Mat3X positions(const Mat3X& s, double t) const {
    asked->push_back(t);
    Mat3X out(3, s.cols());
    for (Index i = 0; i < s.cols(); ++i) out.col(i) = (*this)(Vec3d(s.col(i)), t);
    return out;
  }
};

FitOptions quick() {
  FitOptions o;
  o.encoding.harmonic_degree = 2;
  o.encoding.time_frequencies = 2;
  o.width = 16;
  o.blocks = 1;
  o.points = 1000;
  o.times = 16;
  o.batch = 256;
  o.steps = 2000;
  o.learning_rate = 1e-2;
  return o;
}

/// Mean squared coordinate error in units of the fit's scale, at points and times the fit never saw.
double held_out_error(const NeuralSurface& fitted) {
  std::mt19937_64 random(99);
  const Mat3X s = detail::uniform_sphere_points(400, random);
  double sum = 0;
  for (int k = 0; k < 7; ++k) {
    const double t = (k + 0.41) / 7;
    sum += (fitted.positions(s, t) - positions(PulsingEllipsoid{}, s, t)).squaredNorm();
  }
  return sum / (3.0 * 400 * 7) / (fitted.scale() * fitted.scale());
}

}  // namespace

TEST_CASE("fit: a moving ellipsoid is reached to 1e-5 of its size squared", "[nn]") {
  double last_fraction = -1;
  const FitResult fit = fit_neural_surface(PulsingEllipsoid{}, quick(), [&](std::string_view stage, double fraction) {
    CHECK(stage == "fit");
    CHECK(fraction >= last_fraction);
    last_fraction = fraction;
  });
  CHECK(last_fraction == 1);
  CHECK(held_out_error(fit.surface) < 1e-5);
  CHECK(fit.summary.steps == 2000);
  CHECK(fit.summary.stopped == FitStop::steps);
  CHECK(fit.summary.parameters == fit.surface.network().parameters().size());
  CHECK(fit.summary.loss.size() == 100);
  CHECK(fit.summary.loss.back() < 1e-3 * fit.summary.loss.front());
  CHECK(fit.summary.cpu_seconds > 0);
  CHECK(fit.surface.scale() == Approx(2.4).epsilon(0.1));
  CHECK(fit.surface.translation().x() == Approx(5).epsilon(0.05));
}

TEST_CASE("fit: the same seed gives the same bits with any number of threads, another seed does not", "[nn]") {
  FitOptions o = quick();
  o.steps = 50;
  const auto parameters = [&] { return fit_neural_surface(PulsingEllipsoid{}, o).surface.network().parameters(); };
  const Eigen::VectorXd one = parameters();
  o.threads = 3;
  CHECK(parameters() == one);
  o.seed = 1;
  CHECK(parameters() != one);
}

TEST_CASE("fit: a budget of time ends it", "[nn]") {
  FitOptions o = quick();
  o.steps = 100000000;
  o.seconds = 0.1;
  const FitSummary summary = fit_neural_surface(PulsingEllipsoid{}, o).summary;
  CHECK(summary.stopped == FitStop::seconds);
  CHECK(summary.steps > 0);
}

TEST_CASE("fit: points come from the caller's sampler", "[nn]") {
  FitOptions o = quick();
  o.steps = 1;
  int asked = 0;
  o.sampler = [&](int n, std::mt19937_64& random) {
    asked = n;
    Mat3X s = detail::uniform_sphere_points(n, random);
    s.row(2) = s.row(2).cwiseAbs();
    return s;
  };
  const FitResult fit = fit_neural_surface(PulsingEllipsoid{}, o);
  CHECK(asked == 1000);
  CHECK(fit.surface.translation().z() > 0.4);
  o.sampler = [](int n, std::mt19937_64&) { return Mat3X(Mat3X::Ones(3, n)); };
  CHECK_THROWS_AS(fit_neural_surface(PulsingEllipsoid{}, o), InvalidArgument);
}

TEST_CASE("fit: options without meaning are refused, divergence is reported", "[nn]") {
  FitOptions o = quick();
  o.batch = 0;
  CHECK_THROWS_AS(fit_neural_surface(PulsingEllipsoid{}, o), InvalidArgument);
  o = quick();
  o.times = 0;
  CHECK_THROWS_AS(fit_neural_surface(PulsingEllipsoid{}, o), InvalidArgument);
  o = quick();
  o.learning_rate = 1e30;
  CHECK_THROWS_AS(fit_neural_surface(PulsingEllipsoid{}, o), Error);
}

TEST_CASE("fit: a loss of tangents or normals makes better normals in as many steps", "[nn]") {
  FitOptions o = quick();
  o.encoding.harmonic_degree = 6;
  o.points = 300;  // few points leave the normals between them open
  o.steps = 300;
  o.batch = 512;
  std::mt19937_64 random(5);
  const Mat3X s = detail::uniform_sphere_points(300, random);
  const auto normal_error = [&](double tangents, double normals) {
    o.loss = {tangents, normals};
    return compare(fit_neural_surface(PulsingEllipsoid{}, o).surface, PulsingEllipsoid{}, s, {0.2, 0.7})
        .normal_angle_mean_deg;
  };
  const double positions_alone = normal_error(0, 0), with_tangents = normal_error(0.3, 0),
               with_normals = normal_error(0, 0.3);
  INFO("degrees: " << positions_alone << ", " << with_tangents << ", " << with_normals);
  CHECK(with_tangents < 0.5 * positions_alone);
  CHECK(with_normals < 0.5 * positions_alone);
}

TEST_CASE("fit: a surface at rest needs one time", "[nn]") {
  FitOptions o = quick();
  o.encoding.time_frequencies = 0;
  o.times = 1;
  o.steps = 300;
  const FitResult fit = fit_neural_surface(PulsingEllipsoid{}, o);
  std::mt19937_64 random(5);
  const SurfaceError e =
      compare(fit.surface, PulsingEllipsoid{}, detail::uniform_sphere_points(100, random), {0}, fit.surface.scale());
  CHECK(e.msd < 1e-5);
}

TEST_CASE("fit: an observer sees the fit come closer, and a target ends it", "[nn]") {
  FitOptions o = quick();
  std::vector<double> errors;
  o.observe_every = 1e-9;
  o.steps = 200;
  o.observer = [&](const FitState& state) {
    CHECK(state.steps == int(errors.size()));
    errors.push_back(held_out_error(state.surface));
  };
  fit_neural_surface(PulsingEllipsoid{}, o);
  REQUIRE(errors.size() == 200);
  CHECK(errors.back() < 0.01 * errors.front());
  o.observer = {};
  o.target_msd = 1e-3;
  o.steps = 2000;
  const FitSummary summary = fit_neural_surface(PulsingEllipsoid{}, o).summary;
  CHECK(summary.stopped == FitStop::target_msd);
  CHECK(summary.loss.back() < 1e-3);
  CHECK(summary.validation_msd < 1e-3);
  CHECK(summary.steps < 2000);
}

TEST_CASE("fit: chosen frames alone are learnt, and cubics in time go on between them", "[nn]") {
  std::vector<double> asked;
  const std::vector<double> times{0, 0.1, 0.3, 0.55, 0.6, 0.92, 1};
  SeparableFitOptions o;
  o.frame_times = times;
  o.harmonic_degree = 4;
  o.width = 0;
  o.points = 500;
  const SeparableFitResult fit = fit_separable_surface(Watched{&asked}, o);
  CHECK(asked == times);
  CHECK(fit.surface.time().times() == times);
  for (const double t : {0.05, 0.45, 0.8, 1.0})
    for (const Vec3d& s : {Vec3d(1, 0, 0), Vec3d(0, 0.6, 0.8)})
      CHECK((fit.surface(s, t) - Watched{}(s, t)).norm() < 1e-4);

  FitOptions network = quick();
  network.frame_times = times;
  network.steps = 10;
  asked.clear();
  fit_neural_surface(Watched{&asked}, network);
  CHECK(asked == times);
  network.frame_times = {0, 0.5, 0.5};
  CHECK_THROWS_AS(fit_neural_surface(PulsingEllipsoid{}, network), InvalidArgument);
  o.frame_times = {0, std::nan("")};
  CHECK_THROWS_AS(fit_separable_surface(PulsingEllipsoid{}, o), InvalidArgument);
  CHECK_THROWS_AS(TemporalModes(Eigen::MatrixXd::Zero(3, 2), {0, 1}), InvalidArgument);
}

TEST_CASE("fit: a target error is judged at points that are not trained on", "[nn]") {
  // Ten points, which a network learns by heart without learning the surface.
  SeparableFitOptions o;
  o.frames = 4;
  o.points = 10;
  o.harmonic_degree = -1;
  o.encoding.harmonic_degree = 8;
  o.width = 32;
  o.steps = 300;
  o.target_msd = 1e-5;
  const SeparableFitSummary by_heart = fit_separable_surface(PulsingEllipsoid{}, o).summary;
  CHECK(by_heart.training.loss.back() < o.target_msd);
  CHECK(by_heart.training.validation_msd > o.target_msd);
  CHECK(by_heart.training.stopped == FitStop::steps);
  o.points = 2000;
  o.steps = 3000;
  o.batch = 256;
  o.encoding.harmonic_degree = 4;
  const SeparableFitResult learnt = fit_separable_surface(PulsingEllipsoid{}, o);
  CHECK(learnt.summary.training.stopped == FitStop::target_msd);
  CHECK(learnt.summary.training.validation_msd < o.target_msd);
  std::mt19937_64 random(17);
  CHECK(compare(learnt.surface, PulsingEllipsoid{}, detail::uniform_sphere_points(400, random), {0, 1. / 3, 1},
                learnt.surface.scale())
            .msd < 1.5 * o.target_msd);
}

TEST_CASE("fit: the paper's configuration has its size", "[nn]") {
  const FitOptions o = paper_fit();
  MlpShape shape;
  shape.inputs = static_cast<int>(o.encoding.features());
  shape.width = o.width;
  shape.blocks = o.blocks;
  CHECK(shape.parameter_count() == 12681219);
  CHECK(o.batch == 80000);
  CHECK(o.learning_rate == 1e-4);
  CHECK(o.optimizer.kind == OptimizerKind::rmsprop);
}

}  // namespace fit_test
