#pragma once
/// Fits a separable surface to a moving one: principal components over time, spherical harmonics and local functions
/// by least squares, and a network that learns what they leave. One pass over the samples costs the points, not the points
/// times the frames.
///
///   SeparableFitOptions options;
///   options.frames = 60;
///   options.seconds = 10;
///   const SeparableFitResult fit = fit_separable_surface(sampled_surface, options);
///   fit.surface(s, t);                               // a SeparableSurface, in the units of the target
#include <dsns/core/progress.hpp>
#include <dsns/nn/fit.hpp>
#include <dsns/nn/fit_radial.hpp>
#include <dsns/nn/separable_surface.hpp>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace dsns {

struct SeparableFitOptions {
  int frames = 48;  ///< equidistant times in [0, 1] at which the target is sampled, the knots of the splines
  std::vector<double> frame_times = {};  ///< these, increasing, instead of equidistant ones
  double mode_residual = 1e-9;           ///< as many modes as leave this MSD, in units of scale^2
  int max_modes = 80;
  int harmonic_degree = 30;  ///< of the least squares; -1: none
  double ridge = 1e-7;       ///< of the least squares, in units of the mean diagonal, at the highest degree

  RadialFitOptions radial = {};  ///< of what the harmonics leave

  /// The network on the rest.
  SurfaceEncoding encoding{.harmonic_degree = 20, .time_frequencies = 0};
  int width = 64;  ///< 0: no network
  int blocks = 2;
  Activation activation = Activation::silu;

  int points = 40000;  ///< of the sphere, drawn once
  int batch = 1024;    ///< points a step
  int steps = 3000;
  double seconds = 0;           ///< of wall time for all; 0: no limit. With a limit runs are not repeatable
  double target_msd = 0;        ///< stops where the error at other points is below, in units of scale^2; 0: never
  double learning_rate = 1e-2;  ///< at its highest; rises over the first hundredth and falls to 0 along half a cosine
  OptimizerOptions optimizer = {};
  std::uint64_t seed = 0;
  int threads = 1;  ///< the result does not depend on it; with more than one the target is asked from several at once
  /// Where points are drawn: n unit vectors, 3 x n. Empty: uniformly on the sphere.
  std::function<Mat3X(int n, std::mt19937_64& random)> sampler = {};
  CheckpointOptions checkpoint = {};  ///< of the network's training; all else is computed anew
};

struct SeparableFitSummary {
  FitSummary training;
  Index modes = 0;
  double mode_residual = 0;      ///< MSD left by the modes, in units of scale^2
  double harmonic_residual = 0;  ///< MSD left by the harmonics at the samples
  double radial_residual = 0;    ///< MSD left by the local functions too
  Index functions = 0;           ///< local ones
};

struct SeparableFitResult {
  SeparableSurface surface;
  SeparableFitSummary summary;
};

namespace detail {

/// The target at points and frames as sum_k values(frame, k) fields(point, k), the columns of values orthonormal: squared
/// errors of the fields add up to those over all frames.
struct SeparatedSamples {
  Eigen::MatrixXd values;  // frames x M; the first column is constant
  Eigen::MatrixXf fields;  // 3 M x points
  SampleBall ball;
  double residual = 0;  // MSD left out, in units of scale^2
};

template <class F>
SeparatedSamples separate(const F& target, const Mat3X& points, const std::vector<double>& times,
                          const SeparableFitOptions& options) {
  const Index n = points.cols(), frames = Index(times.size());
  Eigen::MatrixXf all(3 * n, frames);
  SeparatedSamples out;
  visit_positions(
      target, points, times,
      [&](Index k, const Mat3X& p) {
        require(p.allFinite(), "fit: the target is not finite at t = ", times[std::size_t(k)]);
        if (k == 0) out.ball.translation = p.rowwise().mean();  // near the final one, so that single precision suffices
        all.col(k) = (p.colwise() - out.ball.translation).reshaped().template cast<float>();
      },
      options.threads);
  Vec3d shift = Vec3d::Zero();
  for (Index k = 0; k < frames; ++k)
    shift += all.col(k).reshaped(3, n).template cast<double>().rowwise().mean() / double(frames);
  out.ball.translation += shift;
  out.ball.scale = 0;
  for (Index k = 0; k < frames; ++k) {
    auto frame = all.col(k).reshaped(3, n);
    frame.colwise() -= shift.cast<float>();
    out.ball.scale = std::max(out.ball.scale, double(frame.colwise().norm().maxCoeff()));
  }
  require(out.ball.scale > 0, "fit: the target is one point");
  all /= float(out.ball.scale);

  const Eigen::VectorXf mean = all.rowwise().mean();
  all.colwise() -= mean;
  constexpr Index tile = 4096;
  constexpr int groups = 2;  // summed in one order whatever the threads do
  std::vector<Eigen::MatrixXd> grams(groups, Eigen::MatrixXd::Zero(frames, frames));
  parallel_for(groups, options.threads, [&](int g) {
    for (Index first = g * tile; first < all.rows(); first += groups * tile) {
      const Eigen::MatrixXd part = all.middleRows(first, std::min(tile, all.rows() - first)).template cast<double>();
      grams[std::size_t(g)].template selfadjointView<Eigen::Lower>().rankUpdate(part.transpose());
    }
  });
  const Eigen::MatrixXd gram = grams[0] + grams[1];
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(gram);
  const double samples = 3 * double(n) * double(frames);
  double left = solver.eigenvalues().cwiseMax(0).sum();
  Index modes = 0;
  while (modes < std::min<Index>(options.max_modes, frames - 1) && left > options.mode_residual * samples)
    left -= std::max(0.0, solver.eigenvalues()[frames - 1 - modes++]);
  out.residual = std::max(0.0, left) / samples;
  out.values.resize(frames, modes + 1);
  out.values.col(0).setConstant(1 / std::sqrt(double(frames)));
  out.values.rightCols(modes) = solver.eigenvectors().rightCols(modes).rowwise().reverse();
  out.fields.resize(3 * (modes + 1), n);
  const Eigen::MatrixXf directions = out.values.rightCols(modes).template cast<float>();
  constexpr int parts = 64;
  parallel_for(parts, options.threads, [&](int part) {
    for (Index i = part; i < n; i += parts) {
      out.fields.col(i).template head<3>() = std::sqrt(float(frames)) * mean.segment<3>(3 * i);
      out.fields.col(i).tail(3 * modes).reshaped(3, modes).noalias() = all.middleRows<3>(3 * i) * directions;
    }
  });
  return out;
}

/// The harmonics up to a degree that are nearest to the fields at the points, (degree + 1)^2 x fields; the fields keep the rest.
inline Eigen::MatrixXd take_harmonics(Eigen::MatrixXf& fields, const Mat3X& points, int degree, double ridge,
                                      int threads) {
  const Index count = harmonic_count(degree), n = points.cols();
  constexpr Index tile = 256;
  const int groups = 2;
  std::vector<Eigen::MatrixXd> grams(groups, Eigen::MatrixXd::Zero(count, count)),
      moments(groups, Eigen::MatrixXd::Zero(count, fields.rows()));
  const auto tiles = [&](int g, const auto& body) {
    using ByPoint = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    ByPoint y;
    for (Index first = g * tile; first < n; first += groups * tile) {
      const Index size = std::min(tile, n - first);
      y = harmonics<ByPoint>(points.middleCols(first, size), degree, std::move(y));
      body(y, first, size);
    }
  };
  parallel_for(groups, threads, [&](int g) {
    tiles(g, [&](const auto& y, Index first, Index size) {
      grams[std::size_t(g)].selfadjointView<Eigen::Lower>().rankUpdate(y.transpose());
      moments[std::size_t(g)].noalias() += y.transpose() * fields.middleCols(first, size).transpose().cast<double>();
    });
  });
  Eigen::MatrixXd& gram = grams[0];
  for (std::size_t g = 1; g < grams.size(); ++g) gram += grams[g], moments[0] += moments[g];
  const Eigen::ArrayXd l = harmonic_degrees(degree);
  gram.diagonal().array() +=
      ridge * gram.diagonal().mean() * (l * (l + 1)).square() / std::pow(degree * (degree + 1.0), 2);
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> cholesky(gram);
  require<Error>(cholesky.info() == Eigen::Success, "fit: the least squares of degree ", degree, " at ", n,
                 " points are singular; give more points or a lower degree");
  const Eigen::MatrixXd coefficients = cholesky.solve(moments[0]);
  parallel_for(groups, threads, [&](int g) {
    tiles(g, [&](const auto& y, Index first, Index size) {
      fields.middleCols(first, size) -= (y * coefficients).transpose().template cast<float>();
    });
  });
  return coefficients;
}

/// Points and the fields there.
class FieldsProblem {
 public:
  static constexpr JetLayout layout = jet_layouts::value;

  /// The network learns fields / unit; the reported error is the MSD in units of scale^2.
  FieldsProblem(const SurfaceEncoding& encoding, const Mat3X& points, const Eigen::MatrixXf& fields, double frames)
      : fields_(&fields), space_(encoding.space_features(), points.cols()) {
    unit_ = std::sqrt(fields.squaredNorm() / float(fields.size()));
    if (!(unit_ > 0)) unit_ = 1;
    msd_ = double(unit_) * double(unit_) / (3 * frames);
    constexpr Index tile = 64;
    const ChartBatch charts{points, {}, {}};
    Eigen::MatrixXf x;
    for (Index first = 0; first < points.cols(); first += tile) {
      const Index n = std::min(tile, points.cols() - first);
      x.resize(encoding.features(), n);
      encoding.fill(charts, first, n, 0, jet_layouts::value, x);
      space_.middleCols(first, n) = x;
    }
  }

  float unit() const { return unit_; }
  Index samples() const { return space_.cols(); }
  std::uint64_t checksum() const { return checksum_of(*fields_, checksum_of(space_, 0)); }
  void fill(std::span<const Index> samples, Eigen::MatrixXf& inputs) const {
    for (std::size_t j = 0; j < samples.size(); ++j) inputs.col(Index(j)) = space_.col(samples[j]);
  }
  TileLoss<float> loss(MatrixTape<float>& tape, MatrixTape<float>::Node outputs, std::span<const Index> samples) const {
    Eigen::MatrixXf target(fields_->rows(), Index(samples.size()));
    for (std::size_t j = 0; j < samples.size(); ++j) target.col(Index(j)) = fields_->col(samples[j]) / unit_;
    const auto node = tape.squared_error(outputs, target);
    return {node, double(tape.value(node)(0, 0)) * msd_};
  }

 private:
  const Eigen::MatrixXf* fields_;
  Eigen::MatrixXf space_;
  float unit_;
  double msd_;
};

inline FitIdentity identity_of(const SeparableFitOptions& o, std::uint64_t target) {
  FitIdentity id;
  identify(id, o.encoding);
  id.add("frames", o.frame_times.empty() ? o.frames : double(o.frame_times.size()));
  id.add("mode residual", o.mode_residual);
  id.add("most modes", o.max_modes);
  id.add("degree of the harmonics", o.harmonic_degree);
  id.add("ridge", o.ridge);
  id.add("local functions", o.radial.functions);
  id.add("neighbours of a local function", o.radial.neighbours);
  id.add("width of a local function", o.radial.width);
  id.add("refinement of local functions", o.radial.refinement);
  id.add("ridge of local functions", o.radial.ridge);
  id.add("width", o.width);
  id.add("blocks", o.blocks);
  id.add("activation", static_cast<double>(o.activation));
  id.add("points", o.points);
  id.add("batch", o.batch);
  id.add("steps", o.steps);
  id.add("seconds", o.seconds);
  id.add("learning rate", o.learning_rate);
  identify(id, o.optimizer);
  identify_seed(id, o.seed);
  id.target = target;
  return id;
}

inline void check_separable_options(const SeparableFitOptions& o) {
  require(o.frames > 0 && o.points > 0 && o.steps > 0 && o.batch > 0 && o.threads > 0 && o.width >= 0,
          "fit: ", o.frames, " frames, ", o.points, " points, ", o.steps, " steps, a batch of ", o.batch, ", ",
          o.threads, " threads, width ", o.width, "; give at least 1, 1, 1, 1, 1 and 0");
  require(o.harmonic_degree >= -1 && (o.harmonic_degree < 0 || harmonic_count(o.harmonic_degree) <= o.points),
          "fit: harmonics of degree ", o.harmonic_degree, " from ", o.points, " points; give more points");
  require(o.radial.functions >= 0 && o.radial.functions <= o.points && o.radial.neighbours > 0 && o.radial.width > 0 &&
              o.radial.ridge >= 0,
          "fit: ", o.radial.functions, " local functions from ", o.points, " points, of ", o.radial.neighbours,
          " neighbours, width ", o.radial.width, ", ridge ", o.radial.ridge, "; give more points and positive numbers");
  require(o.harmonic_degree >= 0 || o.radial.functions > 0 || o.width > 0,
          "fit: neither harmonics nor local functions nor a network, give one");
  require(o.encoding.time_features() == 0,
          "fit: a separable surface has an encoding of space alone, set its time to 0");
}

}  // namespace detail

/// Trains in single precision and returns the surface in double precision.
/// target   AnimatedSurface
/// returns  the surface in the target's units, and how it went
/// throws   InvalidArgument for unusable options, Error where the training diverges
template <AnimatedSurface F>
SeparableFitResult fit_separable_surface(const F& target, const SeparableFitOptions& options = {},
                                         const Progress& progress = {}) {
  detail::check_separable_options(options);
  const detail::TrainingClock clock;
  std::mt19937_64 random(options.seed);
  const Mat3X points =
      options.sampler ? options.sampler(options.points, random) : detail::uniform_sphere_points(options.points, random);
  const std::vector<double> times = detail::fit_times(options.frames, options.frame_times);
  const double frames = double(times.size());
  const detail::Validation<F> validation(target, options, times);
  detail::SeparatedSamples samples = detail::separate(target, points, times, options);
  SeparableFitSummary summary;
  summary.modes = samples.values.cols();
  summary.mode_residual = samples.residual;

  constexpr Index shape_rows = 12;  // the mean and the three strongest modes tell parts of the shape apart
  const Eigen::MatrixXf places = samples.fields.topRows(std::min(shape_rows, samples.fields.rows()));
  const auto left = [&] {
    return double(samples.fields.squaredNorm()) / (3 * frames * double(points.cols())) + samples.residual;
  };
  Eigen::MatrixXd harmonics(0, samples.fields.rows());
  if (options.harmonic_degree >= 0)
    harmonics = detail::take_harmonics(samples.fields, points, options.harmonic_degree, options.ridge, options.threads);
  summary.harmonic_residual = left();
  RadialSum radial;
  if (options.radial.functions > 0)
    radial = detail::take_radial(samples.fields, points, places, options.radial, options.threads);
  summary.radial_residual = left();
  summary.functions = radial.basis.size();

  const auto surface = [&](std::optional<Mlp<double>> network) {
    return SeparableSurface(TemporalModes(samples.values, times), harmonics, options.encoding, std::move(network),
                            samples.ball.translation, samples.ball.scale, radial);
  };
  std::optional<Mlp<double>> network;
  if (options.width > 0) {
    const detail::FieldsProblem problem(options.encoding, points, samples.fields, frames);
    const MlpShape shape{static_cast<int>(options.encoding.features()), options.width, options.blocks,
                         static_cast<int>(samples.fields.rows()), options.activation};
    Trainer<float, detail::FieldsProblem> trainer(problem, Mlp<float>(shape, random()),
                                                  {options.batch, options.threads, 0, options.optimizer, options.seed});
    FitOptions budget;
    budget.steps = options.steps;
    budget.seconds = options.seconds > 0 ? std::max(1e-3, options.seconds - clock.seconds()) : 0;
    budget.target_msd = options.target_msd;
    budget.learning_rate = options.learning_rate;
    budget.checkpoint = options.checkpoint;
    const auto scaled = [&] {
      Mlp<double> out = trainer.network().template cast<double>();
      const Index last = shape.offset(shape.layers() - 1);
      out.parameters().tail(shape.parameter_count() - last) *= double(problem.unit());
      return out;
    };
    const double prepared = clock.cpu_seconds();
    summary.training = detail::train(
        trainer, budget, detail::identity_of(options, problem.checksum()), progress, [](int, double, double) {},
        [&](Archive& archive) { store_surface(archive, surface(scaled())); },
        [&] { return validation.msd(surface(scaled())); });
    summary.training.cpu_seconds += prepared;
    network = scaled();
  } else {
    summary.training.cpu_seconds = clock.cpu_seconds();
  }
  return {surface(std::move(network)), std::move(summary)};
}

}  // namespace dsns
