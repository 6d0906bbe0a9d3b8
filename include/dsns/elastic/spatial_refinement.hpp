#pragma once
/// Sharpening a spatial registration. Projecting a surface on harmonics and warping it do not commute: what is registered
/// after the projection misses by an error that grows with the warp and with what lies above the degree. Here the surface is
/// warped first,
///   E(O, gamma) = sum over times of |g(P f1) - O g(P(f2 o gamma))|^2,
/// P the projection and g the field of half_density.hpp, so that the truth has energy 0 whatever P takes away. The derivative
/// of P(f2 o gamma) along a field v is P(df2 v(gamma)), which needs first derivatives of f2 alone.
#include <dsns/elastic/half_density.hpp>
#include <dsns/elastic/landmark_term.hpp>
#include <dsns/elastic/surface_stack.hpp>

#include <array>

namespace dsns {

namespace detail {

/// The images of the projection's nodes under gamma, landmarks behind them or left out, the turn of the body, and what follows.
struct RefinementState {
  Mat3X y;
  Eigen::VectorXd J;
  Mat3 O;
  std::vector<HarmonicSurface> surfaces;  ///< P(f2 o gamma), centred
  double energy = 0;
};

template <SurfaceStack Second>
class RefinementProblem {
 public:
  template <SurfaceStack First>
  RefinementProblem(const First& first, const Second& second, const SpatialLevel& level, const SpatialOptions& options)
      : RefinementProblem({}, 1, second, level, options) {
    const std::vector<HarmonicSurface> surfaces = projected(first.positions(nodes_.points));
    require(!surfaces.empty(), "register_spatially: no surfaces, give at least one of both");
    double area = 0;
    for (const HarmonicSurface& f : surfaces) area += area_densities(at_nodes(f)).dot(q_.weights);
    position_weight_ /= std::sqrt(area / double(surfaces.size()));
    for (const HarmonicSurface& f : surfaces) targets_.push_back(field(at_nodes(f)));
    landmarks_ = LandmarkTerm(options.landmarks, norm());
    points_ = landmarks_.behind(nodes_.points);
  }
  /// Against fields at the nodes of quadrature(), as fields() gives them, one a time, without landmarks. `area` balances positions against the SRNF.
  RefinementProblem(std::vector<Eigen::MatrixXd> targets, double area, const Second& second, const SpatialLevel& level,
                    const SpatialOptions& options)
      : second_(&second),
        options_(&options),
        degree_(level.surface_degree),
        heat_((-level.smoothing * harmonic_degrees(degree_) * (harmonic_degrees(degree_) + 1)).exp()),
        nodes_(projection_nodes(degree_)),
        points_(nodes_.points),
        q_(masked(sphere_quadrature(options.latitudes), options)),
        basis_(harmonic_tangents<RowMajor>(charts_at(q_.points), degree_)),
        projection_(harmonics(nodes_.points, degree_).transpose() * nodes_.weights.asDiagonal()),
        targets_(std::move(targets)),
        srnf_weight_(std::sqrt(1 - level.position_weight)),
        position_weight_(std::sqrt(level.position_weight) * 3 / std::sqrt(area)) {}

  /// The projection's nodes, and behind them the landmarks.
  const Mat3X& points() const { return points_; }
  double norm() const {
    double sum = 0;
    for (const Eigen::MatrixXd& g : targets_) sum += g.colwise().squaredNorm() * q_.weights;
    return sum;
  }
  const SphereQuadrature& quadrature() const { return q_; }
  /// O g(P f2(y)), one a time.
  std::vector<Eigen::MatrixXd> fields(const Mat3X& y, const Mat3& O) const {
    std::vector<Eigen::MatrixXd> out;
    for (const HarmonicSurface& f : projected(second_->positions(y)))
      out.push_back(rotate_blocks(O, field(at_nodes(f))));
    return out;
  }

  RefinementState at(Mat3X y, Eigen::VectorXd J, const Mat3& O) const {
    RefinementState p{std::move(y), std::move(J), O, {}, 0};
    p.surfaces = projected(second_->positions(p.y.leftCols(nodes_.size())));
    require(p.surfaces.size() == targets_.size(), "register_spatially: ", targets_.size(), " surfaces against ",
            p.surfaces.size(), ", give as many of both");
    for (std::size_t t = 0; t < targets_.size(); ++t)
      p.energy += (targets_[t] - rotate_blocks(O, field(at_nodes(p.surfaces[t])))).colwise().squaredNorm() * q_.weights;
    p.energy += landmarks_.energy(p.y, nodes_.size());
    return p;
  }

  RefinementState minimise(RefinementState p, int degree, int steps, std::vector<SphereVectorField>& fields,
                           std::vector<double>& energies) const {
    return descend(*this, std::move(p), degree, steps, *options_, fields, energies);
  }

  NormalEquations linearise(const RefinementState& p, const ChartBatch& charts, int degree) const;

 private:
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  std::vector<HarmonicSurface> projected(const std::vector<Mat3X>& values) const {
    std::vector<HarmonicSurface> out;
    for (const Mat3X& x : values) {
      Eigen::MatrixX3d c = heat_.matrix().asDiagonal() * (projection_ * x.transpose());
      const SurfaceTangents f = at_nodes(HarmonicSurface(c));
      const Eigen::VectorXd w = area_densities(f).cwiseProduct(q_.weights);
      c.row(0) -= (f.f * w / w.sum()).transpose() * std::sqrt(4 * pi);
      out.emplace_back(std::move(c));
    }
    return out;
  }

  SurfaceTangents at_nodes(const HarmonicSurface& f) const {
    SurfaceTangents out(0);
    out.f = (basis_.y * f.coefficients()).transpose();
    out.fu = (basis_.yu * f.coefficients()).transpose();
    out.fv = (basis_.yv * f.coefficients()).transpose();
    return out;
  }

  /// [a h; b sqrt|n| f], 6 x n.
  Eigen::MatrixXd field(const SurfaceTangents& f) const {
    Eigen::MatrixXd g(6, f.f.cols());
    g.topRows<3>() = srnf_weight_ * srnf(f);
    g.bottomRows<3>() = position_weight_ * (f.f * area_densities(f).cwiseSqrt().asDiagonal());
    return g;
  }

  /// The derivative of the field at one node by f, f_u and f_v there, 6 x 9.
  Eigen::Matrix<double, 6, 9> field_derivative(const SurfaceTangents& s, Index i) const {
    const auto skew = [](const Vec3d& a) {
      Mat3 m;
      m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
      return m;
    };
    const Vec3d f = s.f.col(i), fu = s.fu.col(i), fv = s.fv.col(i), n = fu.cross(fv);
    const double root = std::sqrt(n.norm());
    const Vec3d unit = n / (root * root);
    const Mat3 of_h = (Mat3::Identity() - 0.5 * unit * unit.transpose()) / root;
    const Mat3 of_position = f * unit.transpose() / (2 * root);
    Eigen::Matrix<double, 6, 9> out;
    out.topLeftCorner<3, 3>().setZero();
    out.block<3, 3>(0, 3) = -srnf_weight_ * of_h * skew(fv);
    out.block<3, 3>(0, 6) = srnf_weight_ * of_h * skew(fu);
    out.bottomLeftCorner<3, 3>() = position_weight_ * root * Mat3::Identity();
    out.block<3, 3>(3, 3) = -position_weight_ * of_position * skew(fv);
    out.block<3, 3>(3, 6) = position_weight_ * of_position * skew(fu);
    return out;
  }

  /// Takes the shift of the centroid out of derivatives of the coefficients, one matrix a coordinate: of sum w |n| f / sum w |n|
  /// with d|n| = (f_v x n) . df_u + (n x f_u) . df_v, n unit.
  void hold_centroid(const SurfaceTangents& s, std::array<Eigen::MatrixXd, 3>& moved) const {
    const Eigen::VectorXd density = area_densities(s), w = density.cwiseProduct(q_.weights) / density.dot(q_.weights);
    const Mat3X normal = unit_normals(s);
    Mat3X of_u(3, w.size()), of_v(3, w.size());
    for (Index i = 0; i < w.size(); ++i) {
      of_u.col(i) = s.fv.col(i).cross(normal.col(i)) * (w[i] / density[i]);
      of_v.col(i) = normal.col(i).cross(s.fu.col(i)) * (w[i] / density[i]);
    }
    Eigen::MatrixXd shift(3, moved[0].cols());
    for (int a = 0; a < 3; ++a) {
      shift.row(a) = (w.transpose() * basis_.y) * moved[std::size_t(a)];
      for (int c = 0; c < 3; ++c)
        shift.row(a) +=
            (of_u.row(c).cwiseProduct(s.f.row(a)) * basis_.yu + of_v.row(c).cwiseProduct(s.f.row(a)) * basis_.yv) *
            moved[std::size_t(c)];
    }
    for (int a = 0; a < 3; ++a) moved[std::size_t(a)].row(0) -= std::sqrt(4 * pi) * shift.row(a);
  }

  /// The fields' derivatives at the nodes from the derivatives of the surface's coefficients: of E at one time.
  NormalEquations linearise_time(std::size_t t, const RefinementState& p, const SurfaceTangents& second,
                                 const HarmonicTangents& fields, int degree) const;

  const Second* second_;
  const SpatialOptions* options_;
  int degree_;
  Eigen::ArrayXd heat_;
  SphereQuadrature nodes_;
  Mat3X points_;
  SphereQuadrature q_;
  HarmonicTangentsOf<RowMajor> basis_;    // at q_
  Eigen::MatrixXd projection_;            // values at nodes_ to coefficients
  std::vector<Eigen::MatrixXd> targets_;  // fields of the first surfaces at q_
  double srnf_weight_ = 0, position_weight_ = 0;
  LandmarkTerm landmarks_;
};

template <SurfaceStack Second>
NormalEquations RefinementProblem<Second>::linearise(const RefinementState& p, const ChartBatch& charts,
                                                     int degree) const {
  const Index n = nodes_.size();
  const ChartBatch at{charts.s.leftCols(n), charts.e1.leftCols(n), charts.e2.leftCols(n)};
  const HarmonicTangents fields = harmonic_tangents(at, degree);
  const std::vector<SurfaceTangents> second = second_->tangents(at);
  std::vector<NormalEquations> of_times(second.size());
  parallel_for(static_cast<int>(second.size()), options_->threads, [&](int time) {
    const auto t = std::size_t(time);
    of_times[t] = linearise_time(t, p, second[t], fields, degree);
  });
  NormalEquations sum = std::move(of_times.front());
  for (std::size_t t = 1; t < of_times.size(); ++t) {
    sum.matrix += of_times[t].matrix;
    sum.right += of_times[t].right;
  }
  landmarks_.add_to(sum, charts, n);
  return sum;
}

template <SurfaceStack Second>
NormalEquations RefinementProblem<Second>::linearise_time(std::size_t t, const RefinementState& p,
                                                          const SurfaceTangents& second, const HarmonicTangents& fields,
                                                          int degree) const {
  const Index count = harmonic_count(degree) - 1, unknowns = 2 * count + 3;
  const auto yu = fields.yu.rightCols(count), yv = fields.yv.rightCols(count);
  // Coefficients of P(df2 v) for every field v, one matrix a coordinate.
  std::array<Eigen::MatrixXd, 3> moved;
  for (int k = 0; k < 3; ++k) {
    const Eigen::VectorXd fu = second.fu.row(k), fv = second.fv.row(k);
    auto& m = moved[std::size_t(k)] = Eigen::MatrixXd(heat_.size(), 2 * count);
    m.leftCols(count).noalias() = projection_ * (fu.asDiagonal() * yu + fv.asDiagonal() * yv);
    m.rightCols(count).noalias() = projection_ * (fv.asDiagonal() * yu - fu.asDiagonal() * yv);
    m.array().colwise() *= heat_;
  }
  const SurfaceTangents here = at_nodes(p.surfaces[t]);
  hold_centroid(here, moved);
  const Eigen::MatrixXd g = field(here);
  const Eigen::MatrixXd residual = rotate_blocks(p.O.transpose(), targets_[t]) - g;
  NormalEquations system{Eigen::MatrixXd::Zero(unknowns, unknowns), Eigen::VectorXd::Zero(unknowns), degree};
  constexpr Index tile = 64;
  for (Index first = 0; first < q_.size(); first += tile) {
    const Index points = std::min(tile, q_.size() - first);
    std::array<RowMajor, 9> parts;  // of f, f_u and f_v, each in three coordinates
    for (std::size_t k = 0; k < 3; ++k) {
      parts[k].noalias() = basis_.y.middleRows(first, points) * moved[k];
      parts[3 + k].noalias() = basis_.yu.middleRows(first, points) * moved[k];
      parts[6 + k].noalias() = basis_.yv.middleRows(first, points) * moved[k];
    }
    Eigen::MatrixXd rows(6 * points, unknowns);
    Eigen::VectorXd wanted(6 * points);
    RowMajor stack(9, 2 * count);
    for (Index j = 0; j < points; ++j) {
      const Index i = first + j;
      const double root = std::sqrt(q_.weights[i]);
      for (std::size_t k = 0; k < 9; ++k) stack.row(Index(k)) = parts[k].row(j);
      rows.block(6 * j, 0, 6, 2 * count).noalias() = root * field_derivative(here, i) * stack;
      for (Index block = 0; block < 6; block += 3)
        for (int k = 0; k < 3; ++k)
          rows.block<3, 1>(6 * j + block, 2 * count + k) =
              root * Vec3d::Unit(k).cross(Vec3d(g.col(i).segment<3>(block)));
      wanted.segment<6>(6 * j) = root * residual.col(i);
    }
    system.matrix.selfadjointView<Eigen::Lower>().rankUpdate(rows.transpose());
    system.right.noalias() += rows.transpose() * wanted;
  }
  return system;
}

}  // namespace detail
}  // namespace dsns
