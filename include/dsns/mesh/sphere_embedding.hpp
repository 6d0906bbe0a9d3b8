#pragma once
/// From a tetrahedron on the sphere back to the whole mesh: vertices return one by one inside the kernel of their ring,
/// and every vertex moves by Newton steps that never turn a triangle over.
#include <dsns/mesh/sphere_energy.hpp>

namespace dsns::detail {

class SphereEmbedding {
 public:
  /// regularization   of the cotangents, relative to the mean squared edge
  SphereEmbedding(CollapsibleMesh& mesh, const ConcatenatedFrames& frames, double regularization)
      : mesh_(mesh),
        frames_(frames),
        regularization_(regularization),
        points_(Mat3X::Zero(3, mesh.vertex_slots())),
        cotangents_(3, mesh.face_slots()) {
    place_tetrahedron();
    regularize(regularization);
    for (int sweep = 0; sweep < 20; ++sweep) relax_all(false);
  }

  const Mat3X& points() const { return points_; }
  Index vertex_count() const { return static_cast<Index>(order_.size()); }

  /// Undoes a collapse and settles the vertex and its ring.
  void insert(const CollapsibleMesh::Collapse& step) {
    const int v = step.vertex;
    mesh_.undo(step);
    for (const int f : mesh_.star(v)) set_cotangents(f);
    points_.col(v) = kernel_point(v, step.target);
    order_.push_back(v);
    for (int k = 0; k < 3; ++k) relax(v);
    for (const int w : mesh_.ring(v)) relax(w);
    relax(v);
  }

  /// One Gauss-Seidel pass over all vertices. Returns by how much the energy fell.
  double relax_all(bool backwards) {
    double gain = 0;
    for (std::size_t i = 0; i < order_.size(); ++i) gain += relax(order_[backwards ? order_.size() - 1 - i : i]);
    return gain;
  }

  void regularize(double regularization) {
    regularization_ = regularization;
    for (int f = 0; f < mesh_.face_slots(); ++f)
      if (mesh_.has_face(f)) set_cotangents(f);
  }

  /// Sum over the faces present; the masses sum to 1, so 2 is the least there can be.
  double energy() const {
    double sum = 0;
    for (int f = 0; f < mesh_.face_slots(); ++f)
      if (mesh_.has_face(f)) sum += moving_face(f, 0).energy();
    return sum;
  }

 private:
  void place_tetrahedron() {
    int f = 0;
    while (!mesh_.has_face(f)) ++f;
    int apex = 0;
    while (!mesh_.has_vertex(apex) || mesh_.contains(f, apex)) ++apex;
    const double c = 1 / std::sqrt(3.0);
    points_.col(mesh_.vertex(f, 0)) << c, c, c;
    points_.col(mesh_.vertex(f, 1)) << -c, c, -c;
    points_.col(mesh_.vertex(f, 2)) << c, -c, -c;
    points_.col(apex) << -c, -c, c;
    if (!(moving_face(f, 0).energy() < std::numeric_limits<double>::infinity()))
      points_.col(mesh_.vertex(f, 0)).swap(points_.col(mesh_.vertex(f, 1)));
    order_ = {mesh_.vertex(f, 0), mesh_.vertex(f, 1), mesh_.vertex(f, 2), apex};
  }

  void set_cotangents(int f) {
    cotangents_.col(f) = regularized_cotangents(
        frames_.squared_lengths(mesh_.vertex(f, 0), mesh_.vertex(f, 1), mesh_.vertex(f, 2)), regularization_);
  }

  MovingFace moving_face(int f, int k) const {
    const int k1 = (k + 1) % 3, k2 = (k + 2) % 3;
    return {points_.col(mesh_.vertex(f, k)), points_.col(mesh_.vertex(f, k1)), points_.col(mesh_.vertex(f, k2)),
            Vec3d(cotangents_(k, f), cotangents_(k1, f), cotangents_(k2, f)), mesh_.mass(f)};
  }

  /// Energy of the faces at v if v were at p.
  double star_energy(int v, const Vec3d& p) const {
    double sum = 0;
    for (const int f : mesh_.star(v)) {
      MovingFace face = moving_face(f, mesh_.corner(f, v));
      face.p = p;
      sum += face.energy();
      if (!(sum < std::numeric_limits<double>::infinity())) break;
    }
    return sum;
  }

  /// One damped Newton step of v (Armijo). Returns by how much the energy fell.
  double relax(int v) {
    const Vec3d p = points_.col(v);
    TangentModel model(p);
    for (const int f : mesh_.star(v)) {
      const MovingFace face = moving_face(f, mesh_.corner(f, v));
      if (!(determinant(face.p, face.b, face.c) > 0)) return 0;
      model.add(face);
    }
    const Eigen::Vector2d step = model.step();
    const double slope = model.gradient.dot(step);
    if (!(slope < 0)) return 0;
    double length = 1;
    for (int halving = 0; halving < 12; ++halving, length /= 2) {
      const Vec3d q = (p + length * (step[0] * model.e1 + step[1] * model.e2)).normalized();
      const double moved = star_energy(v, q);
      if (!(moved < model.energy + 1e-4 * length * slope)) continue;
      points_.col(v) = q;
      return model.energy - moved;
    }
    return 0;
  }

  /// The best of a few points in the kernel of the ring of v, whose triangles u alone saw before: the ring's centroid,
  /// blends of u towards it, and points off u along the bisector of its two ring edges, which lie in it if near enough.
  Vec3d kernel_point(int v, int u) const {
    const Vec3d at_u = points_.col(u);
    Vec3d centroid = Vec3d::Zero(), bisector = Vec3d::Zero(), best = at_u;
    for (const int f : mesh_.star(v)) {
      const int a = mesh_.next(f, v), b = mesh_.previous(f, v);
      centroid += points_.col(a);
      if (a == u || b == u) bisector += Vec3d(points_.col(a)).cross(Vec3d(points_.col(b))).normalized();
    }
    bisector.normalize();
    double best_energy = std::numeric_limits<double>::infinity();
    const auto attempt = [&](const Vec3d& point) {
      const Vec3d p = point.normalized();
      const double energy = star_energy(v, p);
      if (energy < best_energy) best_energy = energy, best = p;
    };
    if (centroid.norm() > 1e-9) {
      centroid.normalize();
      attempt(centroid);
    }
    double reach = 2 * (at_u - centroid).norm(), blend = 1;
    for (int k = 0; k < 40 && (k < 6 || !(best_energy < std::numeric_limits<double>::infinity())); ++k) {
      attempt(at_u + reach * bisector);
      attempt(at_u + blend * (centroid - at_u));
      reach /= 2;
      blend /= 2;
    }
    return best;
  }

  CollapsibleMesh& mesh_;
  const ConcatenatedFrames& frames_;
  double regularization_;
  Mat3X points_;
  Mat3X cotangents_;
  std::vector<int> order_;
};

}  // namespace dsns::detail
