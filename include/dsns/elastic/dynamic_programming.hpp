#pragma once
/// Registration in time by dynamic programming alone, as 4D Atlas has it: the best piecewise linear warp on a grid. It is where
/// register_temporally starts, and what it is compared with.
///
///   const PiecewiseLinearWarp zeta = dynamic_programming_warp(first, second, {.samples = 50});
#include <dsns/elastic/srvf.hpp>

#include <limits>
#include <numeric>

namespace dsns {

/// A warp through values at equidistant times, linear between them.
class PiecewiseLinearWarp {
 public:
  /// values   increasing, at least two
  explicit PiecewiseLinearWarp(Eigen::VectorXd values) : values_(std::move(values)) {
    require(values_.size() >= 2, "PiecewiseLinearWarp: ", values_.size(), " values, give at least two");
    for (Index k = 1; k < values_.size(); ++k)
      require(values_[k] > values_[k - 1], "PiecewiseLinearWarp: not increasing at node ", k);
  }

  const Eigen::VectorXd& values() const { return values_; }
  double operator()(double t) const {
    const Index k = piece(t);
    return values_[k] + (t * double(intervals()) - double(k)) * (values_[k + 1] - values_[k]);
  }
  double slope(double t) const {
    const Index k = piece(t);
    return (values_[k + 1] - values_[k]) * double(intervals());
  }

 private:
  Index intervals() const { return values_.size() - 1; }
  Index piece(double t) const {
    return std::clamp<Index>(static_cast<Index>(std::floor(t * double(intervals()))), 0, intervals() - 1);
  }

  Eigen::VectorXd values_;
};

struct DynamicProgrammingOptions {
  int samples = 200;   ///< of either curve, equidistant
  int max_slope = 7;   ///< slopes are the fractions of coprime numbers up to this
  double penalty = 0;  ///< times the norm and the integral of (1 - sqrt(zeta'))^2
};

namespace detail {

/// The cheapest path over the grid of samples from the first of both to the last of q1.
struct GridPath {
  Eigen::VectorXd values;  // of q2's samples, 0 for the first and 1 for the last, at those of q1
  double cost = 0;
};

/// source   Srivastava, Klassen 2016, section 4.8. Products of all samples are taken once, so that a path's cost does not
///          depend on the dimension; |q2|^2 and <q1, q2> between samples follow from those at them.
class GridSearch {
 public:
  /// q1, q2   K x n
  GridSearch(const Eigen::MatrixXd& q1, const Eigen::MatrixXd& q2, int max_slope, double penalty)
      : n_(static_cast<int>(q1.cols())),
        products_(q1.transpose() * q2),
        squares1_(q1.colwise().squaredNorm()),
        squares2_(q2.colwise().squaredNorm()),
        neighbours_(q2.leftCols(n_ - 1).cwiseProduct(q2.rightCols(n_ - 1)).colwise().sum()),
        penalty_(penalty) {
    for (int a = 1; a <= max_slope; ++a)
      for (int b = 1; b <= max_slope; ++b)
        if (std::gcd(a, b) == 1) moves_.push_back({a, b, std::sqrt(double(b) / a)});
    search();
  }

  double cost(int end) const { return cost_(n_ - 1, end); }
  int samples() const { return n_; }

  /// The path that ends at q2's sample `end`, which must have a finite cost.
  GridPath path(int end) const {
    const double h = 1.0 / (n_ - 1);
    GridPath out{Eigen::VectorXd(n_), cost(end)};
    out.values[n_ - 1] = h * end;
    for (int t = n_ - 1, z = end; t > 0;) {
      const Move& move = moves_[std::size_t(best_(t, z))];
      t -= move.dt;
      z -= move.dz;
      for (int s = 0; s < move.dt; ++s) out.values[t + s] = h * (z + double(move.dz) / move.dt * s);
    }
    return out;
  }

 private:
  struct Move {
    int dt, dz;
    double root;  // of the slope
  };

  double cost_of(int t, int z, const Move& move) const {
    const double slope = move.root * move.root;
    double sum = 0;
    for (int s = 0; s <= move.dt; ++s) {
      const double x = z + slope * s;
      const int left = std::min(static_cast<int>(x), n_ - 2);
      const double f = x - left, g = 1 - f, weight = s == 0 || s == move.dt ? 0.5 : 1;
      const double product = g * products_(t + s, left) + f * products_(t + s, left + 1);
      const double square = g * g * squares2_[left] + f * f * squares2_[left + 1] + 2 * f * g * neighbours_[left];
      sum += weight * (squares1_[t + s] - 2 * move.root * product + slope * square);
    }
    return (sum + penalty_ * move.dt * (1 - move.root) * (1 - move.root)) / (n_ - 1);
  }

  void search() {
    cost_ = Eigen::MatrixXd::Constant(n_, n_, std::numeric_limits<double>::infinity());
    best_ = Eigen::MatrixXi::Constant(n_, n_, -1);
    cost_(0, 0) = 0;
    for (int t = 1; t < n_; ++t)
      for (int z = 1; z < n_; ++z)
        for (std::size_t m = 0; m < moves_.size(); ++m) {
          const int t0 = t - moves_[m].dt, z0 = z - moves_[m].dz;
          if (t0 < 0 || z0 < 0 || !(cost_(t0, z0) < cost_(t, z))) continue;
          const double c = cost_(t0, z0) + cost_of(t0, z0, moves_[m]);
          if (c < cost_(t, z)) {
            cost_(t, z) = c;
            best_(t, z) = static_cast<int>(m);
          }
        }
  }

  int n_;
  Eigen::MatrixXd products_;
  Eigen::VectorXd squares1_, squares2_, neighbours_;
  double penalty_;
  std::vector<Move> moves_;
  Eigen::MatrixXd cost_;
  Eigen::MatrixXi best_;
};

}  // namespace detail

/// The best piecewise linear warp of the second curve to the first, from exact velocities at the samples.
/// accuracy a piecewise linear warp on the grid is met to two nodes [elastic/dynamic_programming_test]
/// throws   InvalidArgument for fewer than two samples, or curves of different dimensions
inline PiecewiseLinearWarp dynamic_programming_warp(const Curve& first, const Curve& second,
                                                    const DynamicProgrammingOptions& options = {}) {
  require(first.dimension() == second.dimension() && options.samples >= 2 && options.max_slope >= 1,
          "dynamic_programming_warp: curves in R^", first.dimension(), " and R^", second.dimension(), ", ",
          options.samples, " samples, slopes up to ", options.max_slope,
          "; give one dimension, at least two samples and a slope of 1");
  const TimeGrid grid = time_grid(options.samples - 1);
  const Eigen::MatrixXd q1 = warped_srvf(first, {}, grid), q2 = warped_srvf(second, {}, grid);
  const double penalty = options.penalty * (squared_norm(q1, grid) + squared_norm(q2, grid)) / 2;
  const detail::GridSearch search(q1, q2, options.max_slope, penalty);
  return PiecewiseLinearWarp(search.path(options.samples - 1).values);
}

/// The same from points of the curves alone, K x n at equidistant times: velocities are differences of neighbours.
inline PiecewiseLinearWarp dynamic_programming_warp(const Eigen::MatrixXd& first, const Eigen::MatrixXd& second,
                                                    int max_slope = DynamicProgrammingOptions{}.max_slope) {
  const Index n = first.cols();
  require(n >= 2 && second.cols() == n && second.rows() == first.rows() && max_slope >= 1,
          "dynamic_programming_warp: ", first.rows(), " x ", n, " and ", second.rows(), " x ", second.cols(),
          " points, give as many of both, at least two");
  const auto q = [&](const Eigen::MatrixXd& x) {
    Eigen::MatrixXd v(x.rows(), n);
    v.col(0) = x.col(1) - x.col(0);
    v.col(n - 1) = x.col(n - 1) - x.col(n - 2);
    v.middleCols(1, n - 2) = (x.rightCols(n - 2) - x.leftCols(n - 2)) / 2;
    return srvf(v * double(n - 1));
  };
  return PiecewiseLinearWarp(detail::GridSearch(q(first), q(second), max_slope, 0).path(int(n) - 1).values);
}

}  // namespace dsns
