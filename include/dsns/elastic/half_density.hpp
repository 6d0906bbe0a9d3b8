#pragma once
/// The fields that spatial registration compares: stacks of three-vectors that a diffeomorphism moves as half-densities,
/// (g * gamma)(s) = sqrt(J) g(gamma(s)), and that a rotation turns block by block. A block is the SRNF of one surface, or its
/// area-weighted position sqrt|n| f: the first is the elastic metric, the second has a smoother landscape and leads there.
#include <dsns/core/parallel.hpp>
#include <dsns/elastic/srnf.hpp>
#include <dsns/surface/harmonic.hpp>

#include <vector>

namespace dsns {

/// Values and derivatives along the chart frames of a field with C components at n points; each C x n.
struct HalfDensityJets {
  Eigen::MatrixXd g, g1, g2;
};

/// The surfaces of several times seen as one field: SRNF blocks weighted by sqrt(1 - position_weight), and position blocks
/// weighted by sqrt(position_weight) * position_scale.
class HalfDensityField {
 public:
  /// position_scale  inverse length: 3 / sqrt(area) balances both kinds of block
  HalfDensityField(std::vector<HarmonicSurface> surfaces, double position_weight, double position_scale)
      : surfaces_(std::move(surfaces)),
        srnf_weight_(std::sqrt(1 - position_weight)),
        position_weight_(std::sqrt(position_weight) * position_scale) {}

  Index components() const {
    return Index(surfaces_.size()) * ((srnf_weight_ > 0 ? 3 : 0) + (position_weight_ > 0 ? 3 : 0));
  }

  HalfDensityJets operator()(const ChartBatch& charts) const {
    const Index n = charts.size();
    HalfDensityJets out{Eigen::MatrixXd(components(), n), Eigen::MatrixXd(components(), n),
                        Eigen::MatrixXd(components(), n)};
    Index row = 0;
    for (const auto& surface : surfaces_) {
      const SurfaceJets j = surface.jets(charts);
      const SrnfJets q = srnf(j);
      if (srnf_weight_ > 0) {
        out.g.middleRows(row, 3) = srnf_weight_ * q.h;
        out.g1.middleRows(row, 3) = srnf_weight_ * q.hu;
        out.g2.middleRows(row, 3) = srnf_weight_ * q.hv;
        row += 3;
      }
      if (position_weight_ > 0) {
        for (Index i = 0; i < n; ++i) {  // |h| = sqrt|n|
          const double m = q.h.col(i).norm();
          const double m1 = q.h.col(i).dot(q.hu.col(i)) / m, m2 = q.h.col(i).dot(q.hv.col(i)) / m;
          out.g.col(i).segment<3>(row) = position_weight_ * m * j.f.col(i);
          out.g1.col(i).segment<3>(row) = position_weight_ * (m1 * j.f.col(i) + m * j.fu.col(i));
          out.g2.col(i).segment<3>(row) = position_weight_ * (m2 * j.f.col(i) + m * j.fv.col(i));
        }
        row += 3;
      }
    }
    return out;
  }

 private:
  std::vector<HarmonicSurface> surfaces_;
  double srnf_weight_, position_weight_;
};

/// A stack of three-vectors with every block turned by O.
inline Eigen::MatrixXd rotate_blocks(const Mat3& O, const Eigen::MatrixXd& g) {
  Eigen::MatrixXd out(g.rows(), g.cols());
  for (Index r = 0; r < g.rows(); r += 3) out.middleRows(r, 3) = O * g.middleRows(r, 3);
  return out;
}

/// sum_i w_i sum_blocks a b^T: nearest_rotation of it minimises sum w |a - O b|^2.
inline Mat3 block_correlation(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, const Eigen::VectorXd& w) {
  Mat3 m = Mat3::Zero();
  for (Index r = 0; r < a.rows(); r += 3) m += a.middleRows(r, 3) * w.asDiagonal() * b.middleRows(r, 3).transpose();
  return m;
}

}  // namespace dsns
