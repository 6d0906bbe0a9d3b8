#pragma once
/// Where points of one body should go on the other, by distance in the space of eigenfunctions and descriptors.
#include <dsns/matching/functional_map.hpp>
#include <dsns/mesh/own_mesh.hpp>

namespace dsns {

/// What is known of a body for matching: eigenfunctions and descriptors at its vertices.
struct SpectralBody {
  MatchingBody body;
  IntrinsicSpectrum spectrum;
  Eigen::MatrixXd descriptors;

  SpectralPoints vertices() const { return {body.sphere(), spectrum.eigenfunctions, descriptors}; }
  SpectralPoints at(const Mat3X& s) const {
    const MatchingBody::Hits hits = body.location().hits(s);
    return {s, body.interpolate(spectrum.eigenfunctions, hits), body.interpolate(descriptors, hits)};
  }
};

/// Targets of fixed points of the first body on the sphere of the second: the points of its triangles nearest in the space of
/// features. Called with the points' present images it takes the functional map from them first, so that targets follow
/// the map that is fitted to them.
class SpectralTargets {
 public:
  /// points   of the first body; weights of them in the functional map
  SpectralTargets(SpectralPoints points, Eigen::VectorXd weights, const SpectralBody& second, int functions,
                  const FeatureWeights& features = {})
      : points_(std::move(points)),
        weights_(std::move(weights)),
        second_(&second),
        functions_(functions),
        feature_weights_(features),
        vertices_(second.vertices()),
        vertex_features_(spectral_features(vertices_, Eigen::MatrixXd::Identity(functions, functions), features)),
        faces_of_vertex_(std::size_t(vertices_.size())) {
    for (Index f = 0; f < second.body.faces().cols(); ++f)
      for (int k = 0; k < 3; ++k) faces_of_vertex_[std::size_t(second.body.faces()(k, f))].push_back(f);
  }

  /// Targets for images of the points, 3 x n unit vectors.
  Mat3X operator()(const Mat3X& images) const { return of_map(functional_map(images)); }

  /// The orthogonal map of the eigenfunctions under which the points have these images.
  Eigen::MatrixXd functional_map(const Mat3X& images) const {
    require(images.cols() == points_.size(), "SpectralTargets: ", images.cols(), " images of ", points_.size(),
            " points");
    const Eigen::MatrixXd there = second_->body.interpolate(second_->spectrum.eigenfunctions.leftCols(functions_),
                                                            second_->body.location().hits(images));
    return orthogonal_map(points_.functions.leftCols(functions_), there, weights_);
  }

  /// Targets under a given orthogonal map.
  Mat3X of_map(const Eigen::MatrixXd& map) const {
    const Eigen::MatrixXf features = spectral_features(points_, map, feature_weights_);
    const std::vector<Index> nearest = nearest_columns(features, vertex_features_);
    Mat3X targets(3, points_.size());
    for (Index i = 0; i < targets.cols(); ++i) targets.col(i) = nearest_point(features.col(i), nearest[std::size_t(i)]);
    return targets;
  }

 private:
  /// On the triangles around the nearest vertex.
  Vec3d nearest_point(const Eigen::VectorXf& p, Index vertex) const {
    const Faces& faces = second_->body.faces();
    float least = std::numeric_limits<float>::infinity();
    Vec3d best = vertices_.sphere.col(vertex);
    for (const Index f : faces_of_vertex_[std::size_t(vertex)]) {
      const Eigen::VectorXf a = vertex_features_.col(faces(0, f)), b = vertex_features_.col(faces(1, f)),
                            c = vertex_features_.col(faces(2, f));
      const Vec3d weights = detail::nearest_in_triangle(p, a, b, c);
      const Eigen::Vector3f w = weights.cast<float>();
      const float distance = (w[0] * a + w[1] * b + w[2] * c - p).squaredNorm();
      if (!(distance < least)) continue;
      least = distance;
      best.setZero();
      for (int k = 0; k < 3; ++k) best += weights[k] * vertices_.sphere.col(faces(k, f));
    }
    return best.normalized();
  }

  SpectralPoints points_;
  Eigen::VectorXd weights_;
  const SpectralBody* second_;
  int functions_;
  FeatureWeights feature_weights_;
  SpectralPoints vertices_;
  Eigen::MatrixXf vertex_features_;
  std::vector<std::vector<Index>> faces_of_vertex_;
};

}  // namespace dsns
