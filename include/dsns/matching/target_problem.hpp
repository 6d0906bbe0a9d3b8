#pragma once
/// The energy of images of an icosphere's vertices against targets, and the two kinds of steps that lower it: all vertices
/// together, and each by itself.
#include <dsns/matching/elastic_sphere.hpp>

#include <Eigen/LU>
#include <Eigen/SparseCholesky>
#include <array>

namespace dsns::detail {

/// Where observed points should go; with a finite `robust` some of the targets may be wrong.
struct Observations {
  Mat3X points, targets;
  Eigen::VectorXd weights;
  double robust = std::numeric_limits<double>::infinity();  ///< radians; the scale of Geman and McClure's estimator
};

/// For images y of the vertices, an observed point is a sum of three of them, and
///   E(y) = sum of w |observed - target|^2 + elastic * (y Q) . y + sum over faces of m b(J),
/// w being the robust weights at the place where the observations were added. Without the last term its minimum is one sparse
/// linear solve away, but may lie behind a fold.
class TargetProblem {
 public:
  TargetProblem(int level, const JacobianBarrier& barrier)
      : ico_(level), location_(ico_.vertices(), ico_.faces()), barrier_(barrier) {
    solver_.analyzePattern(ico_.energy());
  }

  const ElasticSphere& ico() const { return ico_; }
  std::vector<SphereHit> locate(const Mat3X& s) const { return location_.hits(s); }

  /// Images of located points, short of unit length by O(edge^2).
  Mat3X interpolate(const Mat3X& y, const std::vector<SphereHit>& hits) const {
    Mat3X out(3, static_cast<Index>(hits.size()));
    for (Index i = 0; i < out.cols(); ++i) {
      const SphereHit& hit = hits[static_cast<std::size_t>(i)];
      out.col(i) = ico_.corners(y, hit.face) * hit.barycentric;
    }
    return out;
  }

  /// Begins an energy at y with its elastic term, and a trace of inertia that keeps the minimum unique where nothing is observed.
  void begin(const Mat3X& y, double elastic) {
    constexpr double inertia = 1e-8;
    quadratic_ = elastic * ico_.energy();
    for (Index i = 0; i < ico_.size(); ++i) quadratic_.coeffRef(i, i) += inertia * ico_.masses()[i];
    linear_ = inertia * y * ico_.masses().asDiagonal();
    constant_ = inertia;
  }
  /// Adds observations, with weights as they are at y.
  void observe(const Mat3X& y, const Observations& o, const std::vector<SphereHit>& hits) {
    const Mat3X here = interpolate(y, hits);
    for (Index i = 0; i < here.cols(); ++i) {
      const SphereHit& hit = hits[static_cast<std::size_t>(i)];
      const double trust = 1 / (1 + (o.targets.col(i) - here.col(i)).squaredNorm() / (o.robust * o.robust));
      const double w = o.weights[i] * trust * trust;
      constant_ += w;
      for (int k = 0; k < 3; ++k) {
        const double share = w * hit.barycentric[k];
        if (share == 0) continue;
        const int row = ico_.faces()(k, hit.face);
        linear_.col(row) += share * o.targets.col(i);
        for (int l = 0; l < 3; ++l)
          if (hit.barycentric[l] != 0)
            quadratic_.coeffRef(row, ico_.faces()(l, hit.face)) += share * hit.barycentric[l];
      }
    }
  }

  double energy(const Mat3X& y) const {
    double barrier = 0;
    for (Index f = 0; f < ico_.faces().cols(); ++f) barrier += ico_.face_masses()[f] * barrier_(ico_.jacobian(y, f));
    return (y * quadratic_ - 2 * linear_).cwiseProduct(y).sum() + constant_ + barrier;
  }

  /// All vertices towards the minimum of the quadratic part, each as far as the faces around it stay upright.
  /// throws   Error where the factorisation fails, which finite input does not cause
  Mat3X global_step(const Mat3X& y) {
    solver_.factorize(quadratic_);
    require<Error>(solver_.info() == Eigen::Success, "fit_to_targets: the energy's matrix is not positive definite");
    const Eigen::MatrixX3d minimum = solver_.solve(Eigen::MatrixX3d(linear_.transpose()));
    return upright_step(y, minimum.transpose().colwise().normalized() - y);
  }

  /// Each vertex in turn to the minimum of the whole energy with all others held: closed form far from the barrier, a damped
  /// Newton step near it. E never rises.
  /// accuracy E against energy() 1e-12 [matching/target_problem_test]
  void settle(Mat3X& y, int sweeps) const {
    for (int sweep = 0; sweep < sweeps; ++sweep)
      for (Index k = 0; k < y.cols(); ++k) settle_vertex(y, sweep % 2 == 0 ? k : y.cols() - 1 - k);
  }

 private:
  /// y + t x with t = 1, but smaller around faces that would lose four fifths of a Jacobian below the threshold, or sink under
  /// the floor: settling lifts those again that the next step needs.
  Mat3X upright_step(const Mat3X& y, Mat3X x) const {
    constexpr double longest = 0.35, kept = 0.2, floor = 1e-3, shortening = 0.6;
    constexpr int rounds = 40, last_shortening = 25;
    for (Index i = 0; i < x.cols(); ++i) x.col(i) *= longest / std::max(x.col(i).norm(), longest);
    const Faces& faces = ico_.faces();
    std::vector<char> held(static_cast<std::size_t>(y.cols()));
    const auto hold = [&](Index f) {
      for (int k = 0; k < 3; ++k) held[static_cast<std::size_t>(faces(k, f))] = 1;
    };
    Eigen::VectorXd length = Eigen::VectorXd::Ones(y.cols());
    for (int round = 0; round < rounds; ++round) {
      const Mat3X z = (y + x * length.asDiagonal()).colwise().normalized();
      std::vector<Index> sinking;
      for (Index f = 0; f < faces.cols(); ++f)
        if (const double J = ico_.jacobian(z, f), was = ico_.jacobian(y, f);
            J < barrier_.threshold && J < std::max(kept * was, std::min(floor, was)))
          sinking.push_back(f);
      if (sinking.empty()) return z;
      std::fill(held.begin(), held.end(), char(0));
      for (const Index f : sinking)
        for (int k = 0; k < 3; ++k)
          for (const auto& corner : ico_.star(faces(k, f))) hold(corner.face);
      for (Index i = 0; i < y.cols(); ++i)
        if (held[static_cast<std::size_t>(i)]) length[i] *= round < last_shortening ? shortening : 0;
    }
    return y;
  }

  /// On the unit sphere the quadratic part as a function of one vertex is -2 c . p.
  void settle_vertex(Mat3X& y, Index i) const {
    Vec3d c = linear_.col(i);
    for (Eigen::SparseMatrix<double>::InnerIterator entry(quadratic_, i); entry; ++entry)
      if (entry.row() != i) c -= entry.value() * y.col(entry.row());
    const Vec3d p = y.col(i);
    Ring ring(*this, y, i);
    const auto [e1, e2] = tangent_frame(p);
    Eigen::Vector2d gradient(-2 * c.dot(e1), -2 * c.dot(e2));
    Eigen::Matrix2d hessian = 2 * (c.dot(p) > 0 ? c.dot(p) : c.norm()) * Eigen::Matrix2d::Identity();
    double energy = -2 * c.dot(p);
    bool free = true;
    for (int r = 0; r < ring.size; ++r) {
      const double J = ring.jacobian(r, p);
      if (J >= barrier_.threshold) continue;
      free = false;
      const Eigen::Vector2d slope(ring.gradient[std::size_t(r)].dot(e1), ring.gradient[std::size_t(r)].dot(e2));
      const double m = ring.mass[std::size_t(r)], b = m * barrier_.slope(J);
      energy += m * barrier_(J);
      gradient += b * slope;
      hessian += m * barrier_.curvature(J) * slope * slope.transpose();
      hessian.diagonal().array() -= b * J;
    }
    if (free && c.dot(p) > 0) {
      const Vec3d q = c.normalized();
      if (ring.lowest(q) >= barrier_.threshold) {
        y.col(i) = q;
        return;
      }
    }
    const Eigen::Vector2d step = -(hessian.inverse() * gradient);
    const double descent = gradient.dot(step);
    double length = 1;
    for (int halving = 0; halving < 10; ++halving, length /= 2) {
      const Vec3d q = (p + length * (step[0] * e1 + step[1] * e2)).normalized();
      if (!(-2 * c.dot(q) + ring.barrier(barrier_, q) <= energy + 1e-4 * length * descent)) continue;
      y.col(i) = q;
      return;
    }
  }

  /// The faces around a vertex, whose Jacobians are linear in it.
  struct Ring {
    static constexpr std::size_t most = 6;
    int size = 0;
    std::array<Vec3d, most> first, second, gradient;
    std::array<double, most> scale, mass;

    Ring(const TargetProblem& problem, const Mat3X& y, Index vertex) {
      for (const auto& corner : problem.ico_.star(vertex)) {
        const auto r = static_cast<std::size_t>(size++);
        first[r] = y.col(problem.ico_.faces()((corner.place + 1) % 3, corner.face));
        second[r] = y.col(problem.ico_.faces()((corner.place + 2) % 3, corner.face));
        scale[r] = 1 / problem.ico_.determinant_of(corner.face);
        mass[r] = problem.ico_.face_masses()[corner.face];
        gradient[r] = scale[r] * first[r].cross(second[r] - first[r]);
      }
    }
    double jacobian(int r, const Vec3d& p) const {
      return scale[std::size_t(r)] * determinant(p, first[std::size_t(r)], second[std::size_t(r)]);
    }
    double lowest(const Vec3d& p) const {
      double J = std::numeric_limits<double>::infinity();
      for (int r = 0; r < size; ++r) J = std::min(J, jacobian(r, p));
      return J;
    }
    double barrier(const JacobianBarrier& b, const Vec3d& p) const {
      double sum = 0;
      for (int r = 0; r < size; ++r) sum += mass[std::size_t(r)] * b(jacobian(r, p));
      return sum;
    }
  };

  ElasticSphere ico_;
  SphereLocation location_;
  JacobianBarrier barrier_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver_;
  Eigen::SparseMatrix<double> quadratic_;
  Mat3X linear_;
  double constant_ = 0;
};

}  // namespace dsns::detail
