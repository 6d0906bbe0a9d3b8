#pragma once
/// Questions to groups: who is near whom, do groups differ, does a covariate explain. All from distances or scores, whatever
/// these are of.
#include <dsns/core/errors.hpp>
#include <dsns/core/types.hpp>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <random>
#include <vector>

namespace dsns {

/// Euclidean distances of columns, n x n.
inline Eigen::MatrixXd distance_matrix(const Eigen::MatrixXd& members) {
  const Index n = members.cols();
  Eigen::MatrixXd distances = Eigen::MatrixXd::Zero(n, n);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < i; ++j) distances(i, j) = distances(j, i) = (members.col(i) - members.col(j)).norm();
  return distances;
}

struct PermutationTest {
  double statistic = 0;
  double p_value = 1;  ///< share of the permutations, this one included, with a statistic at least as large
};

struct Regression {
  Eigen::VectorXd slope;   ///< of each score, in its unit by unit of the covariate
  Eigen::VectorXd centre;  ///< scores at the covariate's mean
  double covariate_mean = 0;
  double explained = 0;  ///< share of the scores' variance
  PermutationTest test;  ///< of that share
};

/// A binary tree over the members: step k joins clusters a and b, numbered members first, then the steps' own.
struct Merge {
  Index a, b;
  double distance;
};

struct Clustering {
  std::vector<Merge> merges;
  std::vector<Index> order;  ///< of the leaves: neighbours in the tree stand side by side
};

struct Classification {
  std::vector<int> predicted;
  double accuracy = 0;
  double chance = 0;  ///< expected accuracy where labels have nothing to do with distances
};

namespace detail {

inline void require_distances(const Eigen::MatrixXd& distances, std::size_t labels, const char* what) {
  require(distances.rows() == distances.cols() && std::size_t(distances.rows()) == labels && labels >= 2, what, ": ",
          distances.rows(), " x ", distances.cols(), " distances for ", labels,
          " members, give a square matrix with a row for each of at least two");
}

/// The share of permutations whose statistic reaches that of the given order.
template <class Statistic, class T>
PermutationTest permuted(std::vector<T> values, int repetitions, std::uint64_t seed, const Statistic& statistic) {
  PermutationTest test{statistic(values), 1};
  const double reached = test.statistic * (1 - 1e-12);
  std::mt19937_64 random(seed);
  int as_large = 1;
  for (int r = 0; r < repetitions; ++r) {
    std::shuffle(values.begin(), values.end(), random);
    as_large += statistic(values) >= reached;
  }
  test.p_value = double(as_large) / (1 + repetitions);
  return test;
}

}  // namespace detail

/// Whether groups differ: the ratio of the squared distances between groups to those within, against the same with labels
/// shuffled. Two groups or more.
/// accuracy the nominal rate on shuffled labels, in 500 repetitions [stats/groups_test]
/// source   Anderson 2001 (pseudo F)
inline PermutationTest permutation_test(const Eigen::MatrixXd& distances, const std::vector<int>& labels,
                                        int repetitions = 999, std::uint64_t seed = 0) {
  detail::require_distances(distances, labels.size(), "permutation_test");
  std::map<int, int> sizes;
  for (const int label : labels) ++sizes[label];
  const Index n = distances.rows(), groups = Index(sizes.size());
  require(groups >= 2 && groups < n && repetitions > 0, "permutation_test: ", groups, " groups of ", n, " members, ",
          repetitions, " permutations; give two groups or more, fewer than members");
  const double all = distances.squaredNorm() / (2 * double(n));
  return detail::permuted(labels, repetitions, seed, [&](const std::vector<int>& l) {
    double within = 0;
    for (Index i = 0; i < n; ++i)
      for (Index j = 0; j < i; ++j)
        if (l[std::size_t(i)] == l[std::size_t(j)])
          within += distances(i, j) * distances(i, j) / sizes.at(l[std::size_t(i)]);
    return (all - within) / double(groups - 1) / std::max(within / double(n - groups), 1e-300);
  });
}

/// Labels by the k nearest others; of labels that tie, the nearest one's.
inline Classification classify_leave_one_out(const Eigen::MatrixXd& distances, const std::vector<int>& labels,
                                             int neighbours = 1) {
  detail::require_distances(distances, labels.size(), "classify_leave_one_out");
  const auto n = labels.size();
  require(neighbours >= 1 && std::size_t(neighbours) < n, "classify_leave_one_out: ", neighbours, " neighbours of ", n,
          " members, give at least one and fewer than members");
  Classification result;
  std::map<int, double> sizes;
  for (const int label : labels) sizes[label] += 1;
  for (std::size_t i = 0; i < n; ++i) {
    std::vector<std::size_t> others;
    for (std::size_t j = 0; j < n; ++j)
      if (j != i) others.push_back(j);
    std::stable_sort(others.begin(), others.end(), [&](std::size_t a, std::size_t b) {
      return distances(Index(i), Index(a)) < distances(Index(i), Index(b));
    });
    std::map<int, int> votes;
    int most = 0;
    for (int k = 0; k < neighbours; ++k) most = std::max(most, ++votes[labels[others[std::size_t(k)]]]);
    const auto winner =
        std::find_if(others.begin(), others.end(), [&](std::size_t j) { return votes[labels[j]] == most; });
    result.predicted.push_back(labels[*winner]);
    result.accuracy += (labels[*winner] == labels[i]) / double(n);
    result.chance += (sizes[labels[i]] - 1) / double(n - 1) / double(n);
  }
  return result;
}

/// How far a member is from the others: the median of its distances, divided by the median of these over all members.
inline Eigen::VectorXd outlier_scores(const Eigen::MatrixXd& distances) {
  detail::require_distances(distances, std::size_t(distances.rows()), "outlier_scores");
  const auto median = [](std::vector<double> v) {
    std::sort(v.begin(), v.end());
    return (v[(v.size() - 1) / 2] + v[v.size() / 2]) / 2;
  };
  std::vector<double> medians;
  for (Index i = 0; i < distances.rows(); ++i) {
    std::vector<double> others;
    for (Index j = 0; j < distances.cols(); ++j)
      if (j != i) others.push_back(distances(i, j));
    medians.push_back(median(std::move(others)));
  }
  const double typical = median(medians);
  return Eigen::Map<const Eigen::VectorXd>(medians.data(), Index(medians.size())) / (typical > 0 ? typical : 1.0);
}

/// Average linkage.
inline Clustering cluster(const Eigen::MatrixXd& distances) {
  detail::require_distances(distances, std::size_t(distances.rows()), "cluster");
  struct Cluster {
    Index number;
    std::vector<Index> leaves;
  };
  std::vector<Cluster> clusters;
  for (Index i = 0; i < distances.rows(); ++i) clusters.push_back({i, {i}});
  const auto between = [&](const Cluster& a, const Cluster& b) { return distances(a.leaves, b.leaves).mean(); };
  Clustering result;
  while (clusters.size() > 1) {
    std::size_t first = 0, second = 1;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t a = 0; a < clusters.size(); ++a)
      for (std::size_t b = a + 1; b < clusters.size(); ++b)
        if (const double d = between(clusters[a], clusters[b]); d < least) {
          least = d;
          first = a;
          second = b;
        }
    result.merges.push_back({clusters[first].number, clusters[second].number, least});
    auto& leaves = clusters[first].leaves;
    leaves.insert(leaves.end(), clusters[second].leaves.begin(), clusters[second].leaves.end());
    clusters[first].number = distances.rows() + Index(result.merges.size()) - 1;
    clusters.erase(clusters.begin() + std::ptrdiff_t(second));
  }
  result.order = clusters.front().leaves;
  return result;
}

/// Scores (modes x n) as a linear function of a covariate (n).
/// source   least squares; the test shuffles the covariate
inline Regression regress(const Eigen::MatrixXd& scores, const std::vector<double>& covariate, int repetitions = 999,
                          std::uint64_t seed = 0) {
  const Index n = scores.cols();
  require(n >= 3 && Index(covariate.size()) == n && repetitions > 0, "regress: ", covariate.size(),
          " values of the covariate for ", n, " members, ", repetitions,
          " permutations; give a value for each of at least three members");
  const Eigen::Map<const Eigen::VectorXd> x(covariate.data(), n);
  Regression result;
  result.covariate_mean = x.mean();
  const double spread = (x.array() - x.mean()).matrix().squaredNorm();
  require(std::isfinite(spread) && spread > 0, "regress: the covariate is the same for all, or not finite");
  result.centre = scores.rowwise().mean();
  const Eigen::MatrixXd centred = scores.colwise() - result.centre;
  const double total = centred.squaredNorm();
  result.slope = centred * (x.array() - x.mean()).matrix() / spread;
  result.test = detail::permuted(covariate, repetitions, seed, [&](const std::vector<double>& values) {
    const Eigen::Map<const Eigen::VectorXd> v(values.data(), n);
    return total > 0 ? (centred * (v.array() - v.mean()).matrix()).squaredNorm() / (spread * total) : 0.0;
  });
  result.explained = result.test.statistic;
  return result;
}

}  // namespace dsns
