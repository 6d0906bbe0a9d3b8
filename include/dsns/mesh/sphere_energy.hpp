#pragma once
/// The energy of a triangle on the sphere: how far it is from the shape and from the size of its surface triangle.
#include <dsns/mesh/collapsible_mesh.hpp>
#include <dsns/mesh/sphere_certificate.hpp>

namespace dsns::detail {

/// Cotangents of a triangle whose squared edges are all lengthened by eps times their mean: bounded for needles.
inline Vec3d regularized_cotangents(SquaredLengths l, double eps) {
  const double lift = eps * (l[0] + l[1] + l[2]) / 3;
  for (double& edge : l) edge += lift;
  const double four_areas = 4 * area_from_lengths(l);
  if (!(four_areas > 0)) return Vec3d::Zero();  // all three vertices in one point: no shape to keep
  return Vec3d(l[1] + l[2] - l[0], l[2] + l[0] - l[1], l[0] + l[1] - l[2]) / four_areas;
}

/// One face as a function of its corner p, with corners b and c fixed:
///   E = m [ D / (2V) + (r^2 + r^-2) / 2 ],
/// D = sum of cot |edge|^2 over the chords, V = det(p, b, c), r = a / (4 pi m), a = 2 atan2(V, 1 + pb + bc + cp).
/// The first term is 1 for a similar triangle and infinite for a flat one; the second is 1 where m, the face's share of
/// the surface, is also its share of the sphere. D (up to |p|^2), V and the atan2 denominator are linear in p.
/// source   the first term: Hormann and Greiner 2000 (MIPS)
struct MovingFace {
  Vec3d p, b, c;
  Vec3d cot;  // at p, b, c
  double mass;

  double dirichlet() const {
    return cot[0] * (b - c).squaredNorm() + cot[1] * (c - p).squaredNorm() + cot[2] * (p - b).squaredNorm();
  }
  double denominator() const { return 1 + p.dot(b) + b.dot(c) + c.dot(p); }

  /// Infinite where the triangle is flat or turned over.
  double energy() const {
    const double V = determinant(p, b, c);
    if (!(V > 0)) return std::numeric_limits<double>::infinity();
    const double r = 2 * std::atan2(V, denominator()) / (4 * pi * mass), r2 = r * r;
    return mass * (dirichlet() / (2 * V) + 0.5 * (r2 + 1 / r2));
  }
};

/// Second-order model of an energy of p on the sphere, in the tangent basis (e1, e2).
struct TangentModel {
  Vec3d e1, e2;
  double energy = 0;
  Eigen::Vector2d gradient = Eigen::Vector2d::Zero();
  Eigen::Matrix2d hessian = Eigen::Matrix2d::Zero();

  explicit TangentModel(const Vec3d& p) {
    e1 = (std::abs(p.x()) < 0.7 ? Vec3d(Vec3d::UnitX()) : Vec3d(Vec3d::UnitY())).cross(p).normalized();
    e2 = p.cross(e1);
  }

  /// Adds a face with V > 0. The Hessian on the sphere is the flat one less (gradient . p) times the identity.
  void add(const MovingFace& face) {
    const double V = determinant(face.p, face.b, face.c), d = face.denominator(), D = face.dirichlet();
    const double N = 1 / (V * V + d * d), target = 4 * pi * face.mass;
    const double r = 2 * std::atan2(V, d) / target, inverse = 1 / r, inverse2 = inverse * inverse;
    // derivatives of the area term by the area, of the area by V and d
    const double Q1 = (r - inverse2 * inverse) / target, Q2 = (1 + 3 * inverse2 * inverse2) / (target * target);
    const double aV = 2 * d * N, ad = -2 * V * N, aVV = -4 * d * V * N * N, aVd = 2 * (V * V - d * d) * N * N;
    // of the whole by D, V, d
    const double ED = 0.5 / V, EV = -D * ED / V + Q1 * aV, Ed = Q1 * ad, EDV = -ED / V;
    const double EVV = 2 * D * ED / (V * V) + Q2 * aV * aV + Q1 * aVV;
    const double EVd = Q2 * aV * ad + Q1 * aVd, Edd = Q2 * ad * ad - Q1 * aVV;

    const Vec3d gV = face.b.cross(face.c - face.b), gd = face.b + face.c;
    const Vec3d gD = -2 * (face.cot[2] * face.b + face.cot[1] * face.c);
    const Eigen::Vector2d tD(gD.dot(e1), gD.dot(e2)), tV(gV.dot(e1), gV.dot(e2)), td(gd.dot(e1), gd.dot(e2));
    const double m = face.mass, radial = ED * gD.dot(face.p) + EV * V + Ed * gd.dot(face.p);
    energy += m * (D * ED + 0.5 * (r * r + inverse2));
    gradient += m * (ED * tD + EV * tV + Ed * td);
    const Eigen::Vector2d by_V = EDV * tD + 0.5 * EVV * tV + EVd * td;  // twice its symmetric part with tV, plus dd
    hessian += m * (by_V * tV.transpose() + tV * by_V.transpose() + Edd * td * td.transpose());
    hessian.diagonal().array() -= m * radial;
  }

  /// Newton step of the Hessian made positive definite by a shift.
  Eigen::Vector2d step() const {
    const double trace = hessian.trace(), difference = hessian(0, 0) - hessian(1, 1);
    const double root = std::sqrt(difference * difference + 4 * hessian(0, 1) * hessian(0, 1));
    const double least = std::max(1e-3 * std::abs(trace + root) / 2, std::numeric_limits<double>::min());
    const double shift = std::max(0.0, least - (trace - root) / 2);
    const double a = hessian(0, 0) + shift, b = hessian(0, 1), c = hessian(1, 1) + shift;
    return Eigen::Vector2d(b * gradient[1] - c * gradient[0], b * gradient[0] - a * gradient[1]) / (a * c - b * b);
  }
};

}  // namespace dsns::detail
