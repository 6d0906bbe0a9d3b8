#pragma once
/// Mean-curvature flow of a surface as a function, without a mesh: dx/dt = Laplacian(x) = -2 H n with the outward
/// normal n and H = 1/r on a sphere of radius r, which so shrinks as sqrt(r^2 - 4 t).
///
/// The position is a sum of harmonics; a step solves (M_k + dt S_k) x_(k+1) = M_k x_k with mass and stiffness of the
/// surface as it is, implicit in x alone. Flowing by its own metric a thin part pinches off in finite time. The
/// conformalised flow keeps the stiffness of the start: it stays smooth where the other tears, and makes every surface
/// of genus 0 round.
#include <dsns/geometry/galerkin.hpp>
#include <dsns/surface/harmonic.hpp>

#include <Eigen/Cholesky>
#include <algorithm>
#include <limits>

namespace dsns {

enum class CurvatureFlow {
  exact,         ///< by mean curvature
  conformalized  ///< M of the surface, S of the start (Kazhdan, Solomon and Ben-Chen 2012)
};

enum class FlowArea {
  shrinking,  ///< as the flow has it: to a point, after a sphere's r^2 / 4 at the latest
  kept        ///< after each step the surface is scaled about its area centroid to the area it began with
};

struct MeanCurvatureFlowOptions {
  std::vector<double> times{0.1};  ///< ascending, length^2: when the surface is wanted
  double step = 1e-3;              ///< longest, length^2; equal steps lead from each time to the next
  int degree = 0;                  ///< of the harmonics; 0: the surface's own
  int nodes = 0;                   ///< as in GalerkinOptions
  CurvatureFlow variant = CurvatureFlow::exact;
  FlowArea area = FlowArea::shrinking;
  /// Radians between the normals of neighbouring nodes, beyond which the surface counts as folded; pi lets all pass.
  double largest_turn = pi / 2;
  int threads = 1;
};

/// Before the first step and after each: time, area, volume, and the Dirichlet energy 1/2 integral of |grad x|^2 with
/// the metric of the start. The energy is at least the area, and equal where the surface is conformal to the start. The
/// turn is the largest between normals of neighbouring nodes, in radians: large where the degree is too low for the
/// surface.
struct MeanCurvatureFlowSummary {
  std::vector<double> times, areas, volumes, energies, turns;
};

struct MeanCurvatureFlow {
  std::vector<HarmonicSurface> surfaces;  ///< by wanted time
  MeanCurvatureFlowSummary summary;
};

/// How round a surface is: 36 pi V^2 / A^3, which is 1 for spheres and less for all else.
inline double sphericity(double area, double volume) { return 36 * pi * volume * volume / (area * area * area); }

namespace detail {

/// A surface under flow with all that depends on where it is.
class FlowingSurface {
 public:
  FlowingSurface(const HarmonicSurface& start, const MeanCurvatureFlowOptions& options)
      : options_(options),
        degree_(options.degree > 0 ? options.degree : start.degree()),
        x_(Eigen::MatrixX3d::Zero(harmonic_count(degree_), 3)) {
    const Index common = std::min(x_.rows(), start.coefficients().rows());
    x_.topRows(common) = start.coefficients().topRows(common);
    const SphereQuadrature q = galerkin_nodes({degree_, options.nodes, options.threads});
    latitudes_ = static_cast<int>(std::lround(std::sqrt(double(q.size()) / 2)));
    sectors_ = 2 * latitudes_;
    for (int k = 0; k < galerkin_tile_count(q); ++k) tiles_.push_back(galerkin_tile(q, k, degree_, options.threads));
    measure();
    first_area_ = area_;
    stiffness_ = stiffness();
  }

  /// throws   DegenerateSurface where the surface is not immersed after the step, or cannot live as long as the step
  void advance(double step) {
    if (options_.area == FlowArea::shrinking)  // dA/dt = -4 integral of H^2, which Willmore 1965 bounds by -16 pi
      require<DegenerateSurface>(16 * pi * step < area_, "mean_curvature_flow: at time ", time_, " the area is ", area_,
                                 ", so that the surface is a point before the next step of ", step,
                                 " ends; end earlier, take shorter steps or FlowArea::kept");
    const Eigen::MatrixXd M = mass();
    const Eigen::MatrixXd A = M + step * (options_.variant == CurvatureFlow::exact ? stiffness() : stiffness_);
    x_ = A.llt().solve(M * x_);
    time_ += step;
    measure();
    if (options_.area == FlowArea::kept) rescale(std::sqrt(first_area_ / area_));
  }

  HarmonicSurface surface() const { return HarmonicSurface(x_); }

  void append_to(MeanCurvatureFlowSummary& summary) const {
    summary.times.push_back(time_);
    summary.areas.push_back(area_);
    summary.volumes.push_back(volume_);
    summary.turns.push_back(turn_);
    summary.energies.push_back((x_.transpose() * stiffness_ * x_).trace() / 2);
  }

 private:
  void measure() {
    tangents_.clear();
    densities_.clear();
    area_ = volume_ = 0;
    centroid_.setZero();
    Mat3X normals(3, latitudes_ * sectors_);
    Index node = 0;
    for (const GalerkinTile& tile : tiles_) {
      SurfaceTangents t(0);
      t.f = (tile.y * x_).transpose();
      t.fu = (tile.yu * x_).transpose();
      t.fv = (tile.yv * x_).transpose();
      const Eigen::VectorXd density = area_densities(t), area = density.cwiseProduct(tile.weights);
      area_ += area.sum();
      centroid_ += t.f * area;
      for (Index i = 0; i < t.size(); ++i, ++node) {
        normals.col(node) = Vec3d(t.fu.col(i)).cross(Vec3d(t.fv.col(i))) / density[i];
        volume_ += area[i] / 3 * t.f.col(i).dot(normals.col(node));
      }
      tangents_.push_back(std::move(t));
      densities_.push_back(density);
    }
    centroid_ /= area_;
    turn_ = sharpest_turn(normals);
    require<DegenerateSurface>(turn_ <= options_.largest_turn, "mean_curvature_flow: at time ", time_,
                               " normals of neighbouring nodes are ", turn_ * 180 / pi, " degrees apart, more than ",
                               options_.largest_turn * 180 / pi, ": the surface is folded or the degree of ", degree_,
                               " too low for it; take a higher one, end earlier, or allow a larger turn");
  }

  /// An area density vanishes at single points, between the nodes; but around them the normals turn over.
  double sharpest_turn(const Mat3X& normals) const {
    double turn = 0;
    for (int i = 0; i < latitudes_; ++i)
      for (int j = 0; j < sectors_; ++j) {
        const Index row = Index(i) * sectors_, here = row + j, east = row + (j + 1) % sectors_;
        const Index north = std::min(here + sectors_, (latitudes_ - 1) * Index(sectors_) + j);
        for (const Index there : {east, north})
          turn = std::max(turn, angle_between(normals.col(here), normals.col(there)));
      }
    return turn;
  }

  void rescale(double factor) {
    x_.row(0) -= std::sqrt(4 * pi) * centroid_.transpose();
    x_ *= factor;
    x_.row(0) += std::sqrt(4 * pi) * centroid_.transpose();
    measure();
  }

  Eigen::MatrixXd mass() const {
    GramSum sum(x_.rows());
    for (std::size_t k = 0; k < tiles_.size(); ++k) sum.add(mass_rows(tiles_[k], densities_[k]), options_.threads);
    return sum.full();
  }
  Eigen::MatrixXd stiffness() const {
    GramSum sum(x_.rows());
    for (std::size_t k = 0; k < tiles_.size(); ++k)
      sum.add(stiffness_rows(tiles_[k], tangents_[k], densities_[k]), options_.threads);
    return sum.full();
  }

  MeanCurvatureFlowOptions options_;
  int degree_, latitudes_ = 0, sectors_ = 0;
  Eigen::MatrixX3d x_;
  std::vector<GalerkinTile> tiles_;
  std::vector<SurfaceTangents> tangents_;
  std::vector<Eigen::VectorXd> densities_;
  Eigen::MatrixXd stiffness_;  ///< of the start
  double time_ = 0, area_ = 0, volume_ = 0, first_area_ = 0, turn_ = 0;
  Vec3d centroid_ = Vec3d::Zero();
};

}  // namespace detail

/// The surface at the wanted times, and its measures after each step.
/// accuracy first order in the step: a sphere follows sqrt(r^2 - 4 t) [geometry/mean_curvature_flow_test]; in space
///          that of the harmonics, which hold the tables of their values and slopes at all nodes, 150 MB at degree 30
/// throws   InvalidArgument unless the step is positive and the times ascend from 0 on; DegenerateSurface where the
///          surface shrinks to a point before a step ends, has no area at a node, or folds by options.largest_turn
inline MeanCurvatureFlow mean_curvature_flow(const HarmonicSurface& start, const MeanCurvatureFlowOptions& options) {
  require(options.step > 0, "mean_curvature_flow: step is ", options.step, ", give a positive one");
  require(!options.times.empty() && options.times.front() >= 0 &&
              std::is_sorted(options.times.begin(), options.times.end()),
          "mean_curvature_flow: ", options.times.size(), " times, give at least one, ascending from 0 on");
  detail::FlowingSurface flowing(start, options);
  MeanCurvatureFlow result;
  flowing.append_to(result.summary);
  double now = 0;
  for (const double time : options.times) {
    const int steps = static_cast<int>(std::ceil((time - now) / options.step - 1e-9));
    for (int k = 0; k < steps; ++k) {
      flowing.advance((time - now) / steps);
      flowing.append_to(result.summary);
    }
    now = time;
    result.surfaces.push_back(flowing.surface());
  }
  return result;
}

}  // namespace dsns
