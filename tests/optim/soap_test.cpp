#include "catch.hpp"

#include <dsns/optim/schedule.hpp>
#include <dsns/optim/soap.hpp>

#include <cmath>
#include <random>

namespace soap_test {

using namespace dsns;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

MatrixXd random_matrix(Index rows, Index cols, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return MatrixXd::NullaryExpr(rows, cols, [&] { return normal(random); });
}

MatrixXd random_rotation(Index n, std::mt19937_64& random) {
  return Eigen::HouseholderQR<MatrixXd>(random_matrix(n, n, random)).householderQ();
}

/// The columns of a, each made orthogonal to those before it (twice, against round-off) and of length 1.
MatrixXd gram_schmidt(MatrixXd a) {
  for (Index j = 0; j < a.cols(); ++j) {
    for (int twice = 0; twice < 2; ++twice)
      for (Index k = 0; k < j; ++k) a.col(j) -= a.col(k).dot(a.col(j)) * a.col(k);
    a.col(j).normalize();
  }
  return a;
}

/// SOAP of one matrix by the letter, with its first moment in the original coordinates and no turning of it at all.
struct PlainSoap {
  SoapOptions o;
  MatrixXd first, second, l, r, ql, qr;
  int steps = 0;

  PlainSoap(Index rows, Index cols, const SoapOptions& options)
      : o(options), first(MatrixXd::Zero(rows, cols)), second(first) {}

  static MatrixXd eigenvectors(const MatrixXd& s) {
    return Eigen::SelfAdjointEigenSolver<MatrixXd>(s).eigenvectors().rowwise().reverse();
  }

  /// Orthogonal iteration on the columns in the order of their Rayleigh quotients.
  static MatrixXd iterated(const MatrixXd& s, const MatrixXd& q) {
    MatrixXd image(q.rows(), q.cols());
    std::vector<bool> used(static_cast<std::size_t>(q.cols()), false);
    for (Index place = 0; place < q.cols(); ++place) {
      Index best = -1;
      for (Index j = 0; j < q.cols(); ++j)
        if (!used[static_cast<std::size_t>(j)] &&
            (best < 0 || q.col(j).dot(s * q.col(j)) > q.col(best).dot(s * q.col(best))))
          best = j;
      used[static_cast<std::size_t>(best)] = true;
      image.col(place) = s * q.col(best);
    }
    return gram_schmidt(image);
  }

  /// Second moments of sums of uncorrelated variables: sum over i of (q_i . n_j)^2 v_i.
  static MatrixXd carried(const MatrixXd& q, const MatrixXd& next, const MatrixXd& second) {
    MatrixXd out = MatrixXd::Zero(second.rows(), second.cols());
    for (Index j = 0; j < next.cols(); ++j)
      for (Index i = 0; i < q.cols(); ++i) out.row(j) += std::pow(q.col(i).dot(next.col(j)), 2) * second.row(i);
    return out;
  }

  void step(MatrixXd& w, const MatrixXd& g, double rate) {
    ++steps;
    if (steps == 1) {
      l = (1 - o.factor_decay) * g * g.transpose();
      r = (1 - o.factor_decay) * g.transpose() * g;
      ql = eigenvectors(l);
      qr = eigenvectors(r);
      return;
    }
    first = o.beta1 * first + (1 - o.beta1) * g;
    const MatrixXd turned = ql.transpose() * g * qr, moment = ql.transpose() * first * qr;
    MatrixXd direction(g.rows(), g.cols());
    for (Index i = 0; i < g.rows(); ++i)
      for (Index j = 0; j < g.cols(); ++j) {
        second(i, j) = o.beta2 * second(i, j) + (1 - o.beta2) * turned(i, j) * turned(i, j);
        direction(i, j) = moment(i, j) / (1 - std::pow(o.beta1, steps - 1)) /
                          (std::sqrt(second(i, j) / (1 - std::pow(o.beta2, steps - 1))) + o.epsilon);
      }
    w -= rate * (o.weight_decay * w + ql * direction * qr.transpose());
    l = o.factor_decay * l + (1 - o.factor_decay) * g * g.transpose();
    r = o.factor_decay * r + (1 - o.factor_decay) * g.transpose() * g;
    if (steps % o.refresh == 0) {  // the left factor's turn is the first
      const MatrixXd next = iterated(l, ql);
      second = carried(ql, next, second);
      ql = next;
    }
    if ((steps - o.refresh / 2) % o.refresh == 0) {
      const MatrixXd next = iterated(r, qr);
      second = carried(qr, next, second.transpose()).transpose();
      qr = next;
    }
  }
};

/// Half the trace of (W - M)^T A (W - M) B with A and B of random axes and given eigenvalues.
struct KroneckerQuadratic {
  MatrixXd a, b, minimum;

  KroneckerQuadratic(Index rows, Index cols, double condition, std::mt19937_64& random)
      : a(spd(rows, condition, random)), b(spd(cols, condition, random)), minimum(random_matrix(rows, cols, random)) {}

  static MatrixXd spd(Index n, double condition, std::mt19937_64& random) {
    const MatrixXd q = random_rotation(n, random);
    VectorXd values(n);
    for (Index i = 0; i < n; ++i) values[i] = std::pow(condition, -double(i) / double(n - 1));
    return q * values.asDiagonal() * q.transpose();
  }
  double value(const MatrixXd& w) const { return (w - minimum).cwiseProduct(gradient(w)).sum() / 2; }
  MatrixXd gradient(const MatrixXd& w) const { return a * (w - minimum) * b; }
};

/// What an optimiser leaves of the quadratic after some steps at a rate that falls along a cosine.
template <class O>
double remaining(O optimizer, const KroneckerQuadratic& f, double rate, int steps) {
  VectorXd theta = VectorXd::Zero(f.minimum.size());
  const auto w = [&] { return MatrixXd(theta.reshaped(f.minimum.rows(), f.minimum.cols())); };
  for (int i = 0; i < steps; ++i)
    optimizer.step(theta, VectorXd(f.gradient(w()).reshaped()), rate * CosineRate{}(double(i) / steps));
  return f.value(w()) / f.value(MatrixXd::Zero(f.minimum.rows(), f.minimum.cols()));
}

}  // namespace

TEST_CASE("soap: follows its law written with loops", "[optim]") {
  const auto [rows, cols] = GENERATE(table<Index, Index>({{3, 3}, {4, 3}, {3, 4}}));
  SoapOptions options;
  options.refresh = GENERATE(1, 4);
  options.weight_decay = GENERATE(0.0, 0.2);
  std::mt19937_64 random(11);
  Soap<double> optimizer({{0, rows, cols}}, options);
  PlainSoap plain(rows, cols, options);
  MatrixXd expected = random_matrix(rows, cols, random);
  VectorXd theta = expected.reshaped();
  for (int i = 0; i < 40; ++i) {
    const MatrixXd g = random_matrix(rows, cols, random);
    optimizer.step(theta, VectorXd(g.reshaped()), 0.1);
    plain.step(expected, g, 0.1);
    CHECK((theta - expected.reshaped()).norm() == Approx(0).margin(1e-9));
  }
}

TEST_CASE("soap: vectors, and matrices whose sides are too long, take plain Adam", "[optim]") {
  SoapOptions options;
  options.max_dimension = 2;
  options.weight_decay = 0.1;
  AdamOptions adam;
  adam.beta1 = options.beta1;
  adam.beta2 = options.beta2;
  adam.epsilon = options.epsilon;
  adam.weight_decay = options.weight_decay;
  Soap<double> soap({{0, 5, 1}, {5, 3, 4}, {17, 1, 1}}, options);
  Adam<double> other(18, adam);
  std::mt19937_64 random(2);
  VectorXd theta = random_matrix(18, 1, random), copy = theta;
  for (int i = 0; i < 30; ++i) {
    const VectorXd g = random_matrix(18, 1, random);
    soap.step(theta, g, 0.1);
    other.step(copy, g, 0.1);
    CHECK((theta - copy).norm() == Approx(0).margin(1e-13));
  }
}

TEST_CASE("soap: does not see in which orthonormal coordinates a layer is written", "[optim][law]") {
  // With W' = U^T W V the gradient is U^T G V, the factors are U^T L U and V^T R V, and so the bases are U^T Q_L and
  // V^T Q_R up to signs, which cancel: the whole trajectory turns with the coordinates. Adam's does not.
  SoapOptions options;
  options.refresh = GENERATE(1, 3);
  const Index rows = 5, cols = 4;
  std::mt19937_64 random(3);
  const KroneckerQuadratic f(rows, cols, 100, random);
  const MatrixXd u = random_rotation(rows, random), v = random_rotation(cols, random);
  const auto trajectories_part_by = [&](auto optimizer) {
    auto other = optimizer;
    VectorXd w = VectorXd::Zero(rows * cols), turned = w;
    double distance = 0;
    std::mt19937_64 noise(4);
    for (int i = 0; i < 60; ++i) {
      const MatrixXd disturbance = 0.1 * random_matrix(rows, cols, noise);  // as of batches
      const MatrixXd g = f.gradient(w.reshaped(rows, cols)) + disturbance;
      const MatrixXd h =
          u.transpose() * (f.gradient(u * turned.reshaped(rows, cols) * v.transpose()) + disturbance) * v;
      optimizer.step(w, VectorXd(g.reshaped()), 0.05);
      other.step(turned, VectorXd(h.reshaped()), 0.05);
      distance = std::max(distance, (u * turned.reshaped(rows, cols) * v.transpose() - w.reshaped(rows, cols)).norm());
    }
    return distance;
  };
  CHECK(trajectories_part_by(Soap<double>({{0, rows, cols}}, options)) < 1e-9);
  CHECK(trajectories_part_by(Adam<double>(rows * cols)) > 0.1);
}

TEST_CASE("soap: beats Adam at its best rate on a rotated Kronecker quadratic", "[optim]") {
  std::mt19937_64 random(6);
  const KroneckerQuadratic f(12, 8, 1e3, random);  // condition number 1e6
  const int steps = 400;
  double adam = 1;
  for (const double rate : {1e-3, 3e-3, 1e-2, 3e-2, 0.1, 0.3})
    adam = std::min(adam, remaining(Adam<double>(96), f, rate, steps));
  CHECK(remaining(Soap<double>({{0, 12, 8}}), f, 0.1, steps) < 0.01 * adam);
}

TEST_CASE("soap: one basis at the shorter side already helps", "[optim]") {
  std::mt19937_64 random(6);
  const KroneckerQuadratic f(4, 16, 1e3, random);
  SoapOptions options;
  options.max_dimension = 4;
  const Soap<double> one_sided({{0, 4, 16}}, options);
  CHECK(one_sided.state().arrays[2].values.size() == 16);
  const int steps = 400;
  double adam = 1;
  for (const double rate : {3e-3, 1e-2, 3e-2, 0.1, 0.3})
    adam = std::min(adam, remaining(Adam<double>(64), f, rate, steps));
  CHECK(remaining(one_sided, f, 0.1, steps) < 0.5 * adam);
}

TEST_CASE("soap: bases stay orthonormal in single precision", "[optim]") {
  Soap<float> optimizer({{0, 16, 24}}, {.refresh = 2});
  std::mt19937_64 random(8);
  const MatrixXd scales =
      VectorXd::LinSpaced(16, 0, -12).unaryExpr([](double e) { return std::pow(10, e); }).asDiagonal();
  Eigen::VectorXf theta = Eigen::VectorXf::Zero(16 * 24);
  for (int i = 0; i < 300; ++i) {
    const Eigen::MatrixXf g = (scales * random_matrix(16, 24, random)).cast<float>();
    optimizer.step(theta, Eigen::VectorXf(g.reshaped()), 1e-3);
  }
  REQUIRE(theta.allFinite());
  const auto& bases = optimizer.state().arrays[3].values;
  const Eigen::MatrixXf left = bases.head(16 * 16).matrix().reshaped(16, 16);
  const Eigen::MatrixXf right = bases.tail(24 * 24).matrix().reshaped(24, 24);
  CHECK((left.transpose() * left - Eigen::MatrixXf::Identity(16, 16)).norm() < 1e-5f);
  CHECK((right.transpose() * right - Eigen::MatrixXf::Identity(24, 24)).norm() < 1e-5f);
}

TEST_CASE("soap: the size of the gradients does not matter, though their fourth powers vanish", "[optim]") {
  SoapOptions options;
  options.refresh = 2;
  options.epsilon = 0;
  Soap<float> optimizer({{0, 6, 4}}, options), small({{0, 6, 4}}, options);
  std::mt19937_64 random(8);
  Eigen::VectorXf theta = Eigen::VectorXf::Zero(24), other = theta;
  for (int i = 0; i < 50; ++i) {
    const Eigen::VectorXf g = random_matrix(24, 1, random).cast<float>();
    optimizer.step(theta, g, 1e-2);
    small.step(other, std::ldexp(1.0f, -45) * g, 1e-2);  // the factors are about 1e-27, the squares of theirs 1e-54
    CHECK((theta - other).norm() == Approx(0).margin(1e-6));
  }
}

TEST_CASE("soap: gradients of zero, at the start too, do no harm", "[optim]") {
  Soap<float> optimizer({{0, 3, 5}, {15, 3, 1}}, {.refresh = 2});
  Eigen::VectorXf theta = Eigen::VectorXf::Ones(18);
  for (int i = 0; i < 5; ++i) optimizer.step(theta, Eigen::VectorXf::Zero(18), 0.1);
  CHECK(theta == Eigen::VectorXf::Ones(18));
  std::mt19937_64 random(1);
  for (int i = 0; i < 20; ++i) optimizer.step(theta, Eigen::VectorXf(random_matrix(18, 1, random).cast<float>()), 0.1);
  CHECK(theta.allFinite());
}

TEST_CASE("soap: threads do not change a bit", "[optim]") {
  const std::vector<ParameterBlock> blocks = {{0, 20, 7}, {140, 20, 1}, {160, 5, 20}, {260, 5, 1}};
  const auto moved = [&](int threads) {
    std::mt19937_64 random(4);
    Soap<double> soap(blocks, {.refresh = 3, .threads = threads});
    VectorXd theta = VectorXd::Zero(265);
    for (int i = 0; i < 20; ++i) soap.step(theta, random_matrix(265, 1, random), 0.1);
    return theta;
  };
  const VectorXd one = moved(1);
  CHECK(moved(2) == one);
  CHECK(moved(7) == one);
}

TEST_CASE("soap: blocks that do not tile the parameters are refused", "[optim]") {
  using Blocks = std::vector<ParameterBlock>;
  CHECK_THROWS_AS(Soap<double>(Blocks{{1, 2, 2}}), InvalidArgument);
  CHECK_THROWS_AS(Soap<double>(Blocks{{0, 2, 2}, {3, 2, 1}}), InvalidArgument);
  CHECK_THROWS_AS(Soap<double>(Blocks{{0, 2, 2}, {5, 2, 1}}), InvalidArgument);
  CHECK_THROWS_AS(Soap<double>(Blocks{{0, 0, 2}}), InvalidArgument);
  CHECK_THROWS_AS(Soap<double>(Blocks{{0, 2, 2}}, {.refresh = 0}), InvalidArgument);
  CHECK_THROWS_AS(Soap<double>(Blocks{{0, 2, 2}}, {.threads = 0}), InvalidArgument);
  Soap<double> soap(Blocks{{0, 2, 2}, {4, 2, 1}});
  VectorXd theta = VectorXd::Zero(6);
  CHECK_THROWS_AS(soap.step(theta, VectorXd::Zero(5), 1), InvalidArgument);
}

}  // namespace soap_test
