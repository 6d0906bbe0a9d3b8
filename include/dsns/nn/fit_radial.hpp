#pragma once
/// Local functions that take from sampled fields what harmonics leave: centres and metrics from the samples, coefficients by
/// least squares. The samples' fields are also where they lie in the space of the shape's motions, and there, unlike on the
/// sphere, a finger is as large as it is.
#include <dsns/core/parallel.hpp>
#include <dsns/surface/radial.hpp>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace dsns {

struct RadialFitOptions {
  int functions = 2000;
  int neighbours = 10;        ///< centres nearest in shape whose places on the sphere shape a support
  double width = 2.5;         ///< of a support, in units of 2 standard deviations of those places
  double refinement = 0.25;   ///< centres are spaced as this power of 1 / (local mean square of what is to be fitted)
  double ridge = 1e-8;        ///< of the least squares, in units of the mean diagonal
  int threads = 1;            ///< the result does not depend on it
};

struct RadialFit {
  RadialBasis basis;
  Eigen::MatrixXd coefficients;  ///< functions x fields
};

namespace detail {

/// Squared distances of sample i from all samples; columns of points are coordinates.
inline Eigen::ArrayXf squared_distances(const Eigen::MatrixXf& points, Index i) {
  Eigen::ArrayXf out = (points.col(0).array() - points(i, 0)).square();
  for (Index k = 1; k < points.cols(); ++k) out += (points.col(k).array() - points(i, k)).square();
  return out;
}

/// Farthest-point sampling, distances multiplied by `weights`: each centre is where the weighted distance to those before
/// is largest.
/// points   samples x coordinates
struct FarthestPoints {
  std::vector<Index> centres;
  std::vector<Index> nearest;  // of each sample, the number of its centre
};
inline FarthestPoints farthest_points(const Eigen::MatrixXf& points, const Eigen::ArrayXf& weights, Index count) {
  FarthestPoints out;
  out.nearest.assign(std::size_t(points.rows()), 0);
  Eigen::ArrayXf distance = Eigen::ArrayXf::Constant(points.rows(), std::numeric_limits<float>::max());
  Index next = 0;
  for (Index k = 0; k < count; ++k) {
    out.centres.push_back(next);
    const Eigen::ArrayXf d = squared_distances(points, next);
    for (Index i = 0; i < points.rows(); ++i)
      if (d[i] < distance[i]) distance[i] = d[i], out.nearest[std::size_t(i)] = k;
    (distance * weights).maxCoeff(&next);
  }
  return out;
}

/// How much closer than elsewhere centres should be: the mean square of the fields over patches of the shape, to a power.
inline Eigen::ArrayXf refinement_weights(const Eigen::MatrixXf& fields, const Eigen::MatrixXf& shape, double power) {
  const Index patches = std::min<Index>(300, shape.rows());
  const FarthestPoints p = farthest_points(shape, Eigen::ArrayXf::Ones(shape.rows()), patches);
  Eigen::ArrayXd sum = Eigen::ArrayXd::Zero(patches), count = sum;
  for (Index i = 0; i < shape.rows(); ++i) {
    sum[p.nearest[std::size_t(i)]] += double(fields.col(i).squaredNorm());
    count[p.nearest[std::size_t(i)]] += 1;
  }
  const double mean = sum.sum() / count.sum();
  const Eigen::ArrayXf local = (sum / count / mean + 1e-3).pow(2 * power).cast<float>();
  Eigen::ArrayXf out(shape.rows());
  for (Index i = 0; i < shape.rows(); ++i) out[i] = local[p.nearest[std::size_t(i)]];
  return out;
}

/// Functions at samples, each round in the spread of its neighbours' places on the sphere.
inline RadialBasis radial_basis(const Mat3X& points, const Eigen::MatrixXf& shape, const std::vector<Index>& centres,
                                const RadialFitOptions& options) {
  const Index n = Index(centres.size()), near = std::min<Index>(options.neighbours + 1, n);
  Eigen::MatrixXf places(n, shape.cols());
  Mat3X at(3, n);
  for (Index j = 0; j < n; ++j) {
    places.row(j) = shape.row(centres[std::size_t(j)]);
    at.col(j) = points.col(centres[std::size_t(j)]).normalized();
  }
  RadialBasis::Metrics metrics(9, n);
  parallel_for(options.threads, options.threads, [&](int t) {
    std::vector<std::pair<float, Index>> order(static_cast<std::size_t>(n));
    for (Index j = t; j < n; j += options.threads) {
      const Eigen::ArrayXf d = squared_distances(places, j);
      for (Index k = 0; k < n; ++k) order[std::size_t(k)] = {d[k], k};
      std::nth_element(order.begin(), order.begin() + near - 1, order.end());
      Mat3 spread = Mat3::Zero();
      for (Index k = 0; k < near; ++k) {
        const Vec3d e = at.col(order[std::size_t(k)].second) - at.col(j);
        spread += e * e.transpose() / double(near);
      }
      // Across the sphere there is nothing to resolve, and no direction may be without length.
      const double size = spread.trace() + 1e-12;
      spread += size * (at.col(j) * at.col(j).transpose() + 0.01 * Mat3::Identity());
      const Eigen::SelfAdjointEigenSolver<Mat3> axes(spread);
      const Vec3d lengths = axes.eigenvalues().cwiseSqrt().cwiseInverse() / (2 * options.width);
      metrics.col(j) = (axes.eigenvectors() * lengths.asDiagonal() * axes.eigenvectors().transpose()).reshaped();
    }
  });
  return RadialBasis(std::move(at), std::move(metrics));
}

/// The sums of local functions that are nearest to the fields at the points; the fields keep the rest.
/// fields   C x points
/// shape    points x coordinates, where the points lie on the shape
inline RadialFit take_radial(Eigen::MatrixXf& fields, const Mat3X& points, const Eigen::MatrixXf& shape,
                             const RadialFitOptions& options) {
  const Index count = options.functions;
  const Eigen::ArrayXf weights = refinement_weights(fields, shape, options.refinement);
  RadialFit out{radial_basis(points, shape, farthest_points(shape, weights, count).centres, options), {}};

  // Groups of neighbouring samples give small dense blocks, which are added in one order whatever the threads do.
  const NeighbourGroups groups(points, 64);
  struct Block {
    RadialValues<0> values;
    Eigen::MatrixXd gram, moments;
  };
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(count, count);
  out.coefficients = Eigen::MatrixXd::Zero(count, fields.rows());
  std::vector<Block> blocks(64);
  for (Index first = 0; first < groups.size(); first += Index(blocks.size())) {
    const Index size = std::min(Index(blocks.size()), groups.size() - first);
    parallel_for(int(size), options.threads, [&](int b) {
      Block& block = blocks[std::size_t(b)];
      const std::span<const Index> group = groups[first + b];
      block.values = out.basis.at<0>({points, points, points}, group, std::move(block.values));
      Eigen::MatrixXd local(Index(group.size()), fields.rows());
      for (Index i = 0; i < local.rows(); ++i) local.row(i) = fields.col(group[std::size_t(i)]).transpose().cast<double>();
      const auto phi = block.values.part(0);
      block.gram.setZero(phi.cols(), phi.cols());
      block.gram.selfadjointView<Eigen::Lower>().rankUpdate(phi.transpose());
      block.moments.noalias() = phi.transpose() * local;
    });
    for (Index b = 0; b < size; ++b) {
      const Block& block = blocks[std::size_t(b)];
      const std::vector<Index>& at = block.values.functions;  // increasing, so that lower triangles meet
      for (Index j = 0; j < Index(at.size()); ++j) {
        double* const column = gram.col(at[std::size_t(j)]).data();
        for (Index i = j; i < Index(at.size()); ++i) column[at[std::size_t(i)]] += block.gram(i, j);
        out.coefficients.row(at[std::size_t(j)]) += block.moments.row(j);
      }
    }
  }
  gram.diagonal().array() += options.ridge * gram.diagonal().mean();
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> cholesky(gram);
  require<Error>(cholesky.info() == Eigen::Success, "fit: the least squares of ", count, " local functions at ",
                 points.cols(), " points are singular; give more points, fewer functions or a larger ridge");
  cholesky.solveInPlace(out.coefficients);
  const int parts = 16;
  parallel_for(parts, options.threads, [&](int p) {
    RadialValues<0> values;
    Eigen::MatrixXd near;
    for (Index g = p; g < groups.size(); g += parts) {
      values = out.basis.at<0>({points, points, points}, groups[g], std::move(values));
      near.resize(Index(values.functions.size()), fields.rows());
      for (Index k = 0; k < near.rows(); ++k) near.row(k) = out.coefficients.row(values.functions[std::size_t(k)]);
      const Eigen::MatrixXf sums = (near.transpose() * values.part(0).transpose()).cast<float>();
      for (Index i = 0; i < sums.cols(); ++i) fields.col(groups[g][std::size_t(i)]) -= sums.col(i);
    }
  });
  return out;
}

}  // namespace detail

}  // namespace dsns
