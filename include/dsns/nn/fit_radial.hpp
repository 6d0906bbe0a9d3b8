#pragma once
/// Local functions that take from sampled fields what harmonics leave: centres and metrics from the samples, coefficients by
/// least squares. The samples' fields are also where they lie in the space of the shape's motions, and there, unlike on the
/// sphere, a finger is as large as it is.
#include <dsns/core/block_cholesky.hpp>
#include <dsns/nn/shape_patches.hpp>
#include <dsns/surface/radial.hpp>

#include <Eigen/Eigenvalues>

namespace dsns {

struct RadialFitOptions {
  int functions = 0;         ///< 0: none
  int neighbours = 10;       ///< centres nearest in shape whose places on the sphere shape a support
  double width = 2;          ///< of a support, in units of 2 standard deviations of those places
  double refinement = 0.35;  ///< centres are closer by this power of the local mean square of what is to be fitted
  double ridge = 1e-9;       ///< of the least squares, in units of the mean diagonal
};

namespace detail {

/// Functions at samples, each round in the spread of its neighbours' places on the sphere.
inline RadialBasis radial_basis(const Mat3X& points, const Eigen::MatrixXf& shape, const std::vector<Index>& centres,
                                const RadialFitOptions& options, int threads) {
  const Index n = Index(centres.size());
  Eigen::MatrixXf places(shape.rows(), n);
  Mat3X at(3, n);
  for (Index j = 0; j < n; ++j) {
    places.col(j) = shape.col(centres[std::size_t(j)]);
    at.col(j) = points.col(centres[std::size_t(j)]).normalized();
  }
  const ShapePatches patches(places, std::max<Index>(1, n / 30));
  RadialBasis::Metrics metrics(9, n);
  constexpr int parts = 64;
  parallel_for(parts, threads, [&](int part) {
    for (Index j = part; j < n; j += parts) {
      Mat3 spread = Mat3::Zero();
      const std::vector<Index> near = patches.nearest(places.col(j), std::min<Index>(options.neighbours + 1, n));
      for (const Index k : near) {
        const Vec3d e = at.col(k) - at.col(j);
        spread += e * e.transpose() / double(near.size());
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

/// An order of functions in which those that separate two sides of the sphere follow both, in blocks that begin at starts.
struct Dissection {
  std::vector<Index> order, starts;
};

/// sets   functions that overlap: any two that are in no set together are apart
class Dissector {
 public:
  Dissector(const RadialBasis& basis, std::vector<std::vector<Index>> sets)
      : centres_(basis.centres()), side_(std::size_t(basis.size()), 0) {
    std::vector<Index> all(std::size_t(basis.size()));
    std::iota(all.begin(), all.end(), Index(0));
    dissect(std::move(all), sets);
    out_.starts.push_back(Index(out_.order.size()));
  }
  const Dissection& result() const { return out_; }

 private:
  static constexpr Index most_ = 128;

  void append(const std::vector<Index>& functions) {
    const NeighbourGroups groups(Mat3X(centres_(Eigen::all, functions)), most_);
    for (Index g = 0; g < groups.size(); ++g) {
      out_.starts.push_back(Index(out_.order.size()));
      for (const Index k : groups[g]) out_.order.push_back(functions[std::size_t(k)]);
    }
  }
  void dissect(std::vector<Index> functions, const std::vector<std::vector<Index>>& sets) {
    if (Index(functions.size()) <= most_) return append(functions);
    const Mat3X places = centres_(Eigen::all, functions);
    const NeighbourGroups halves(places, (places.cols() + 1) / 2);
    for (Index h = 0; h < halves.size(); ++h)
      for (const Index k : halves[h]) side_[std::size_t(functions[std::size_t(k)])] = h == 0 ? 1 : 2;
    for (const std::vector<Index>& set : sets) {  // functions of the first half that meet the second one separate
      const auto on = [&](int s) { return [&, s](Index j) { return side_[std::size_t(j)] == s; }; };
      if (std::any_of(set.begin(), set.end(), on(2)))
        for (const Index j : set)
          if (side_[std::size_t(j)] == 1) side_[std::size_t(j)] = 3;
    }
    std::array<std::vector<Index>, 3> parts;
    for (const Index j : functions) parts[std::size_t(std::exchange(side_[std::size_t(j)], 0) - 1)].push_back(j);
    std::array<std::vector<std::vector<Index>>, 2> inner;
    for (std::size_t h = 0; h < 2; ++h) {
      for (const Index j : parts[h]) side_[std::size_t(j)] = 1;
      for (const std::vector<Index>& set : sets) {
        std::vector<Index> kept;
        std::copy_if(set.begin(), set.end(), std::back_inserter(kept),
                     [&](Index j) { return side_[std::size_t(j)] == 1; });
        if (kept.size() > 1) inner[h].push_back(std::move(kept));
      }
      for (const Index j : parts[h]) side_[std::size_t(j)] = 0;
    }
    for (std::size_t h = 0; h < 2; ++h)
      if (!parts[h].empty()) dissect(std::move(parts[h]), inner[h]);
    if (!parts[2].empty()) append(parts[2]);
  }

  const Mat3X& centres_;
  std::vector<int> side_;
  Dissection out_;
};

/// The sums of local functions that are nearest to the fields at the points; the fields keep the rest.
/// fields   C x points
/// shape    coordinates x points, where the points lie on the shape
inline RadialSum take_radial(Eigen::MatrixXf& fields, const Mat3X& points, const Eigen::MatrixXf& shape,
                             const RadialFitOptions& options, int threads) {
  const ChartColumns at{points, points, points};
  const NeighbourGroups groups(points, 64);
  constexpr int parts = 64;
  RadialSum out;
  Dissection order;
  {
    const RadialBasis basis = radial_basis(
        points, shape, centres_for(fields, shape, options.functions, options.refinement), options, threads);
    std::vector<std::vector<Index>> sets(std::size_t(groups.size()));
    parallel_for(parts, threads, [&](int p) {
      RadialValues<0> values;
      for (Index g = p; g < groups.size(); g += parts) {
        values = basis.at<0>(at, groups[g], std::move(values));
        sets[std::size_t(g)] = values.functions;
      }
    });
    order = Dissector(basis, std::move(sets)).result();
    out.basis = RadialBasis(basis.centres()(Eigen::all, order.order), basis.metrics()(Eigen::all, order.order));
  }

  // Groups of neighbouring samples give small dense matrices, which are added in one order whatever the threads do.
  struct Share {
    RadialValues<0> values;
    Eigen::MatrixXd gram, moments;
  };
  BlockCholesky gram(order.starts);
  out.coefficients = Eigen::MatrixXd::Zero(out.basis.size(), fields.rows());
  std::vector<Share> shares(parts);
  for (Index first = 0; first < groups.size(); first += parts) {
    const Index size = std::min<Index>(parts, groups.size() - first);
    parallel_for(int(size), threads, [&](int b) {
      Share& share = shares[std::size_t(b)];
      const std::span<const Index> group = groups[first + b];
      share.values = out.basis.at<0>(at, group, std::move(share.values));
      Eigen::MatrixXd local(Index(group.size()), fields.rows());
      for (Index i = 0; i < local.rows(); ++i)
        local.row(i) = fields.col(group[std::size_t(i)]).transpose().cast<double>();
      const auto phi = share.values.part(0);
      share.gram.setZero(phi.cols(), phi.cols());
      share.gram.selfadjointView<Eigen::Lower>().rankUpdate(phi.transpose());
      share.moments.noalias() = phi.transpose() * local;
    });
    for (Index b = 0; b < size; ++b) {
      const Share& share = shares[std::size_t(b)];
      gram.add(share.values.functions, share.gram);
      for (Index j = 0; j < share.moments.rows(); ++j)
        out.coefficients.row(share.values.functions[std::size_t(j)]) += share.moments.row(j);
    }
  }
  gram.add_ridge(options.ridge);
  require<Error>(gram.factorize(threads), "fit: the least squares of ", options.functions, " local functions at ",
                 points.cols(), " points are singular; give more points, fewer functions or a larger ridge");
  gram.solve_in_place(out.coefficients);
  parallel_for(parts, threads, [&](int p) {
    RadialValues<0> values;
    Eigen::MatrixXd near;
    for (Index g = p; g < groups.size(); g += parts) {
      values = out.basis.at<0>(at, groups[g], std::move(values));
      near = out.coefficients(values.functions, Eigen::all);
      const Eigen::MatrixXf sums = (near.transpose() * values.part(0).transpose()).cast<float>();
      for (Index i = 0; i < sums.cols(); ++i) fields.col(groups[g][std::size_t(i)]) -= sums.col(i);
    }
  });
  return out;
}

}  // namespace detail

}  // namespace dsns
