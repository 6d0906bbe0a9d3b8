#pragma once
/// Fits without training: as many local functions as an error asks for or a time allows.
///
///   SeparableFitOptions options = closed_form_fit();
///   options.seconds = 10;
///   const SeparableFitResult fit = fit_closed_form(sampled_surface, options);
#include <dsns/nn/fit_separable.hpp>

namespace dsns {

/// Closed forms alone: without a limit of time every run gives the same surface. Points are what it is short of: with fewer
/// than five a local function it fits the samples better than what lies between them.
inline SeparableFitOptions closed_form_fit() {
  SeparableFitOptions o;
  o.points = 100000;
  o.harmonic_degree = 20;
  o.radial.functions = 20000;
  o.radial.ridge = 1e-7;
  o.width = 0;
  return o;
}

namespace detail {

/// The same fit with fewer local functions, of as many points each.
inline SeparableFitOptions with_functions(SeparableFitOptions options, int functions) {
  const double points = double(options.points) * functions / std::max(1, options.radial.functions);
  const Index least = std::max<Index>(functions, harmonic_count(std::max(0, options.harmonic_degree)));
  options.points = std::min(options.points, std::max(int(least), int(points)));
  options.radial.functions = functions;
  options.seconds = 0;
  options.target_msd = 0;
  options.checkpoint = {};
  return options;
}

}  // namespace detail

/// Fits of growing size until the error at other points is below target_msd, the next would not end within `seconds`, or
/// options.radial.functions are reached, with options.points to them. The last one is returned; each is handed to
/// options.checkpoint.write as soon as it is there. There is no training to go on with: from a checkpoint the fit begins again
/// and ends in the same surface.
/// options  width 0, see closed_form_fit
/// accuracy of `seconds`: a fit's time is foretold from the former's, to a fifth on an idle machine [docs/performance.md]
/// throws   InvalidArgument for unusable options, or a checkpoint of a training
template <AnimatedSurface F>
SeparableFitResult fit_closed_form(const F& target, const SeparableFitOptions& options = closed_form_fit(),
                                   const Progress& progress = {}) {
  detail::check_separable_options(options);
  require(options.width == 0 && options.radial.functions > 0, "fit_closed_form: a network of width ", options.width,
          " and ", options.radial.functions, " local functions, give 0 and at least 1");
  require(options.seconds >= 0 && options.target_msd >= 0, "fit_closed_form: ", options.seconds,
          " seconds and a target of ", options.target_msd, ", neither may be negative");
  require(options.checkpoint.resume == nullptr || !options.checkpoint.resume->contains("training.options"),
          options.checkpoint.resume == nullptr ? "" : options.checkpoint.resume->name(),
          " is of the training of a network; fit with the same options as there, or anew");
  const int most = options.radial.functions;
  const int smallest = std::max(100, most / 16);
  constexpr double power = 1.45;      // of the number of functions: what a fit's time grows with
  constexpr double share = 0.8;       // of the time that is left, for what is foretold
  constexpr double worthwhile = 1.3;  // times as many functions as before
  const bool limited = options.seconds > 0 || options.target_msd > 0;
  const detail::TrainingClock clock;
  const detail::Validation<F> validation(target, options, detail::fit_times(options.frames, options.frame_times));
  int functions = limited || options.checkpoint.write ? std::min(smallest, most) : most;
  for (;;) {
    report(progress, "fit", 0.5 * functions / most);
    const double started = clock.seconds();
    SeparableFitResult fit = fit_separable_surface(target, detail::with_functions(options, functions));
    const double now = clock.seconds();
    if (options.checkpoint.write) {
      Archive archive;
      store_surface(archive, fit.surface);
      options.checkpoint.write(archive);
    }
    FitSummary& summary = fit.summary.training;
    summary.cpu_seconds = clock.cpu_seconds();
    summary.stopped = FitStop::functions;
    double next = functions < most ? most : 0;
    if (options.target_msd > 0) {
      summary.validation_msd = validation.msd(fit.surface);
      next = std::min(next, 2.0 * functions);
    }
    if (options.seconds > 0 && next > 0) {
      const double left = share * std::max(0.0, options.seconds - now);
      const double affordable = functions * std::pow(left / (now - started), 1 / power);
      if (affordable < next) {
        next = affordable;
        summary.stopped = FitStop::seconds;
      }
    }
    if (options.target_msd > 0 && summary.validation_msd < options.target_msd) {
      next = 0;
      summary.stopped = FitStop::target_msd;
    }
    if (next < std::min<double>(most, worthwhile * functions)) {
      report(progress, "fit", 1);
      return fit;
    }
    functions = int(next);
  }
}

}  // namespace dsns
