#pragma once
/// Functional maps: a correspondence seen as the orthogonal matrix that carries eigenfunctions of one body to those of the
/// other, and its refinement by alternating matches and matrix over a growing number of eigenfunctions.
#include <dsns/matching/intrinsic_laplacian.hpp>
#include <dsns/matching/nearest_neighbours.hpp>

#include <Eigen/SVD>
#include <span>

namespace dsns {

/// Points of a body with what matching knows of them; a row or column for each of n points.
struct SpectralPoints {
  Mat3X sphere;                 ///< 3 x n, unit
  Eigen::MatrixXd functions;    ///< eigenfunctions, n x K
  Eigen::MatrixXd descriptors;  ///< n x channels, normalised over the pair

  Index size() const { return sphere.cols(); }
};

/// How much the channels count in distances. Eigenfunctions have mean square 1, so a share of their sum over k is taken.
struct FeatureWeights {
  double spectral = 0.3;      ///< times 1 / sqrt(k)
  double descriptors = 0.02;  ///< each
};

/// The orthogonal C that minimises |W^1/2 (first C - second)|, k x k.
/// first, second  functions at corresponding points, a row for each; weights of the rows
/// source   Schoenemann 1966
inline Eigen::MatrixXd orthogonal_map(const Eigen::MatrixXd& first, const Eigen::MatrixXd& second,
                                      const Eigen::VectorXd& weights) {
  require(first.rows() == second.rows() && first.cols() == second.cols() && weights.size() == first.rows(),
          "orthogonal_map: ", first.rows(), " x ", first.cols(), " against ", second.rows(), " x ", second.cols(),
          " values with ", weights.size(), " weights");
  const Eigen::BDCSVD<Eigen::MatrixXd> svd(first.transpose() * (weights.asDiagonal() * second),
                                           Eigen::ComputeFullU | Eigen::ComputeFullV);
  return svd.matrixU() * svd.matrixV().transpose();
}

/// Coordinates in which distances are taken, a column for each point: the first k functions, carried over by `map` (the identity
/// for the second body), and the descriptors.
inline Eigen::MatrixXf spectral_features(const SpectralPoints& points, const Eigen::MatrixXd& map,
                                         const FeatureWeights& weights) {
  const Index k = map.rows(), channels = points.descriptors.cols();
  require(k >= 1 && k <= points.functions.cols() && map.cols() == k, "spectral_features: a map of ", k, " x ",
          map.cols(), " for ", points.functions.cols(), " functions");
  Eigen::MatrixXf out(k + channels, points.size());
  out.topRows(k) =
      (weights.spectral / std::sqrt(double(k)) * (points.functions.leftCols(k) * map).transpose()).cast<float>();
  out.bottomRows(channels) = (weights.descriptors * points.descriptors.transpose()).cast<float>();
  return out;
}

struct FunctionalMap {
  Eigen::MatrixXd map;         ///< k x k, orthogonal: first functions times map are second functions at the matches
  std::vector<Index> matches;  ///< of each first point, an index of a second one
  double residual = 0;         ///< mean squared distance of the features at the end
};

/// Alternates the map of `sizes[i]` functions from the matches and the matches from the map.
/// weights  of the first points
/// source   Melzi et al. 2019
inline FunctionalMap zoom_out(const SpectralPoints& first, const Eigen::VectorXd& weights, const SpectralPoints& second,
                              std::vector<Index> matches, std::span<const int> sizes, const FeatureWeights& features) {
  require(static_cast<Index>(matches.size()) == first.size() && !sizes.empty(), "zoom_out: ", matches.size(),
          " matches of ", first.size(), " points and ", sizes.size(), " sizes");
  FunctionalMap out{{}, std::move(matches), 0};
  for (std::size_t step = 0; step < sizes.size(); ++step) {
    const Index k = sizes[step];
    require(k >= 1 && k <= std::min(first.functions.cols(), second.functions.cols()), "zoom_out: size ", k,
            ", there are ", first.functions.cols(), " and ", second.functions.cols(), " functions");
    const Eigen::MatrixXd matched = second.functions(out.matches, Eigen::seqN(Index(0), k));
    out.map = orthogonal_map(first.functions.leftCols(k), matched, weights);
    const Eigen::MatrixXf from = spectral_features(first, out.map, features),
                          to = spectral_features(second, Eigen::MatrixXd::Identity(k, k), features);
    out.matches = nearest_columns(from, to);
    if (step + 1 == sizes.size()) {
      const Eigen::VectorXd squares =
          (from - to(Eigen::all, out.matches)).colwise().squaredNorm().transpose().cast<double>();
      out.residual = weights.dot(squares) / weights.sum();
    }
  }
  return out;
}

}  // namespace dsns
