#include "catch.hpp"
#include "support/surfaces.hpp"

#include <dsns/nn/closed_form.hpp>
#include <dsns/nn/surface_archive.hpp>
#include <dsns/surface/surface_error.hpp>

namespace closed_form_test {

using namespace dsns;

namespace {

SeparableFitOptions small_fit() {
  SeparableFitOptions o = closed_form_fit();
  o.frames = 5;
  o.points = 4000;
  o.harmonic_degree = 6;
  o.radial.functions = 800;
  return o;
}

Mat3X probe() { return fibonacci_sphere(500).points; }

double msd(const SeparableSurface& fitted) {
  const Mat3X s = probe();
  double sum = 0;
  for (const double t : {0.0, 0.25, 0.5, 1.0})
    sum += (fitted.positions(s, t) - positions(test::limbed_body(), s, t)).squaredNorm();
  return sum / (12 * double(s.cols()) * std::pow(fitted.scale(), 2));
}

}  // namespace

TEST_CASE("closed form: without limits it is the separable fit without a network", "[nn]") {
  const SeparableFitResult a = fit_closed_form(test::limbed_body(), small_fit()),
                           b = fit_separable_surface(test::limbed_body(), small_fit());
  CHECK(a.surface.positions(probe(), 0.3) == b.surface.positions(probe(), 0.3));
  CHECK(a.summary.functions == 800);
  CHECK(a.summary.training.stopped == FitStop::functions);
  CHECK(msd(a.surface) < 1e-7);
}

TEST_CASE("closed form: a target error ends it with fewer functions, and holds at points it never saw", "[nn]") {
  SeparableFitOptions o = small_fit();
  o.target_msd = 1e-5;
  const SeparableFitResult fit = fit_closed_form(test::limbed_body(), o);
  CHECK(fit.summary.training.stopped == FitStop::target_msd);
  CHECK(fit.summary.functions < 800);
  CHECK(fit.summary.training.validation_msd < 1e-5);
  CHECK(msd(fit.surface) == Approx(fit.summary.training.validation_msd).epsilon(0.5));
  o.target_msd = 1e-30;
  CHECK(fit_closed_form(test::limbed_body(), o).summary.training.stopped == FitStop::functions);
}

TEST_CASE("closed form: a time that is over leaves the smallest fit, ample time allows all functions", "[nn]") {
  SeparableFitOptions o = small_fit();
  o.seconds = 1e-6;
  const SeparableFitSummary hasty = fit_closed_form(test::limbed_body(), o).summary;
  CHECK(hasty.training.stopped == FitStop::seconds);
  CHECK(hasty.functions == 100);
  o.seconds = 1e6;
  const SeparableFitSummary patient = fit_closed_form(test::limbed_body(), o).summary;
  CHECK(patient.training.stopped == FitStop::functions);
  CHECK(patient.functions == 800);
}

TEST_CASE("closed form: every size is handed out as a surface, and a training's checkpoint is refused", "[nn]") {
  SeparableFitOptions o = small_fit();
  std::vector<Archive> written;
  o.checkpoint.write = [&](const Archive& archive) { written.push_back(archive); };
  const SeparableFitResult fit = fit_closed_form(test::limbed_body(), o);
  REQUIRE(written.size() == 2);
  std::vector<double> errors;
  for (const Archive& archive : written) {
    const AnyAnimatedSurface surface = surface_from(archive);
    errors.push_back((surface.positions(probe(), 0.3) - fit.surface.positions(probe(), 0.3)).norm());
  }
  CHECK(errors[0] > 0);
  CHECK(errors[1] == 0);

  o.checkpoint.resume = &written[0];
  CHECK(fit_closed_form(test::limbed_body(), o).surface.positions(probe(), 0.3) == fit.surface.positions(probe(), 0.3));
  Archive training = written[0];
  training.set("training.options", std::string("width\n"));
  o.checkpoint.resume = &training;
  CHECK_THROWS_AS(fit_closed_form(test::limbed_body(), o), InvalidArgument);
}

TEST_CASE("closed form: options that ask for a network or for nothing are refused", "[nn]") {
  SeparableFitOptions o = small_fit();
  o.width = 16;
  CHECK_THROWS_AS(fit_closed_form(test::limbed_body(), o), InvalidArgument);
  o = small_fit();
  o.radial.functions = 0;
  CHECK_THROWS_AS(fit_closed_form(test::limbed_body(), o), InvalidArgument);
  o = small_fit();
  o.seconds = -1;
  CHECK_THROWS_AS(fit_closed_form(test::limbed_body(), o), InvalidArgument);
}

}  // namespace closed_form_test
