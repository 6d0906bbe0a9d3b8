#include "catch.hpp"
#include "support/sphere_points.hpp"
#include "support/surfaces.hpp"

#include <dsns/nn/fit_separable.hpp>

namespace fit_radial_test {

using namespace dsns;

namespace {

struct Samples {
  Mat3X points = fibonacci_sphere(1500).points;
  Eigen::MatrixXf shape, fields;

  Samples() {
    shape = positions(test::limbed_body(), points, 0.3).cast<float>();
    fields = shape.topRows(2).array() * shape.bottomRows(2).array();
  }
};
RadialFitOptions options_for(int functions) {
  RadialFitOptions o;
  o.functions = functions;
  return o;
}

}  // namespace

TEST_CASE("patches find the nearest points that a search through all finds", "[nn]") {
  const Samples s;
  const detail::ShapePatches patches(s.shape, 40);
  for (Index i = 0; i < s.shape.cols(); i += 100) {
    const Eigen::Vector3f place = s.shape.col(i) + Eigen::Vector3f(0.01f, -0.02f, 0.005f);
    std::vector<std::pair<float, Index>> all;
    for (Index k = 0; k < s.shape.cols(); ++k) all.emplace_back((s.shape.col(k) - place).squaredNorm(), k);
    std::sort(all.begin(), all.end());
    const std::vector<Index> near = patches.nearest(place, 9);
    REQUIRE(near.size() == 9);
    for (std::size_t k = 0; k < near.size(); ++k) CHECK(near[k] == all[k].second);
  }
}

TEST_CASE("centres at equal weights are farthest points: none nearer to another than a sample is to one", "[nn]") {
  const Samples s;
  const std::vector<Index> centres = detail::centres_for(s.fields, s.shape, 100, 0);
  REQUIRE(centres.size() == 100);
  float apart = 1e9f, uncovered = 0;
  for (std::size_t a = 0; a < centres.size(); ++a)
    for (std::size_t b = 0; b < a; ++b)
      apart = std::min(apart, (s.shape.col(centres[a]) - s.shape.col(centres[b])).norm());
  for (Index i = 0; i < s.shape.cols(); ++i) {
    float nearest = 1e9f;
    for (const Index c : centres) nearest = std::min(nearest, (s.shape.col(i) - s.shape.col(c)).norm());
    uncovered = std::max(uncovered, nearest);
  }
  CHECK(apart >= uncovered);
}

TEST_CASE("overlapping functions meet in dissection only through what separates them", "[nn]") {
  const Samples s;
  const RadialBasis basis =
      detail::radial_basis(s.points, s.shape, detail::centres_for(s.fields, s.shape, 700, 0), options_for(700), 1);
  const detail::NeighbourGroups groups(s.points, 16);
  std::vector<std::vector<Index>> sets;
  for (Index g = 0; g < groups.size(); ++g)
    sets.push_back(basis.at<0>({s.points, s.points, s.points}, groups[g]).functions);
  const detail::Dissection d = detail::Dissector(basis, sets).result();
  std::vector<Index> sorted = d.order;
  std::sort(sorted.begin(), sorted.end());
  REQUIRE(sorted.size() == 700);
  for (Index k = 0; k < 700; ++k) CHECK(sorted[std::size_t(k)] == k);
  CHECK(d.starts.front() == 0);
  CHECK(d.starts.back() == 700);
  CHECK(std::is_sorted(d.starts.begin(), d.starts.end()));
}

TEST_CASE("local functions leave what a dense least squares of the same basis leaves, with any threads", "[nn]") {
  const Samples s;
  RadialFitOptions options = options_for(300);
  options.ridge = 1e-6;
  Eigen::MatrixXf left = s.fields, again = s.fields;
  const RadialSum fit = detail::take_radial(left, s.points, s.shape, options, 1);
  CHECK(detail::take_radial(again, s.points, s.shape, options, 3).coefficients == fit.coefficients);
  CHECK(left == again);

  const Eigen::MatrixXd values = radial_sum<Eigen::Dynamic>(fit.basis, Eigen::MatrixXd::Identity(300, 300), s.points);
  Eigen::MatrixXd gram = values * values.transpose();
  gram.diagonal().array() += options.ridge * gram.diagonal().mean();
  const Eigen::MatrixXd c = gram.llt().solve(values * s.fields.transpose().cast<double>());
  CHECK((c - fit.coefficients).norm() < 1e-8 * c.norm());
  CHECK((s.fields - (c.transpose() * values).cast<float>() - left).norm() < 1e-5f * s.fields.norm());
  CHECK(left.squaredNorm() < 1e-4f * s.fields.squaredNorm());
}

TEST_CASE("a separable surface of harmonics and local functions is their sum, and near the body it was fitted to",
          "[nn]") {
  SeparableFitOptions options;
  options.frames = 9;
  options.points = 3000;
  options.harmonic_degree = 6;
  options.radial.functions = 300;
  options.width = 0;
  const LimbedBody body = test::limbed_body();
  const SeparableFitResult fit = fit_separable_surface(body, options);
  CHECK(fit.summary.radial_residual < 0.2 * fit.summary.harmonic_residual);

  const SeparableSurface& f = fit.surface;
  const ChartBatch c = charts_at(test::sphere_points());
  const double t = 0.375;  // a frame
  const SurfaceJets j = jets(f, c, t);
  CHECK((j.f - positions(f, c.s, t)).norm() < 1e-12);
  CHECK((tangents(f, c, t).fv - j.fv).norm() < 1e-10);
  const SeparableSurface harmonic(f.time(), f.harmonics(), f.encoding(), {}, f.translation(), f.scale());
  const Eigen::VectorXd a = f.time()(t);
  Eigen::MatrixX3d contracted = Eigen::MatrixX3d::Zero(300, 3);
  for (Index k = 0; k < a.size(); ++k) contracted += f.scale() * a[k] * f.radial().coefficients.middleCols(3 * k, 3);
  const SurfaceJets base = jets(harmonic, c, t), local = jets(RadialSurface(f.radial().basis, contracted), c);
  CHECK((j.f - base.f - local.f).norm() < 1e-12);
  CHECK((j.fuu - base.fuu - local.fuu).norm() < 1e-9);
  const double msd = (j.f - positions(body, c.s, t)).squaredNorm() / double(3 * c.size()) / (f.scale() * f.scale());
  CHECK(msd < 10 * fit.summary.radial_residual);

  CHECK_THROWS_AS(SeparableSurface(f.time(), f.harmonics(), f.encoding(), {}, f.translation(), f.scale(),
                                   {f.radial().basis, Eigen::MatrixXd::Zero(300, 3)}),
                  InvalidArgument);
  options.radial.functions = 4000;
  CHECK_THROWS_AS(fit_separable_surface(body, options), InvalidArgument);
}

}  // namespace fit_radial_test
