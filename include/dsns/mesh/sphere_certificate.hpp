#pragma once
/// Proof that a map from a closed mesh to the sphere is one to one.
#include <dsns/mesh/sphere_topology.hpp>

#include <cmath>
#include <limits>

namespace dsns {

/// What certify() found. The central projection of a closed genus-0 mesh onto the sphere covers it exactly once if no
/// triangle is turned over and the signed spherical areas sum to one sphere: then no vertex can be wound around twice.
struct SphereMapCertificate {
  Index flips = 0;            ///< triangles with det(p0, p1, p2) <= 0, the sign being exact
  double area_defect = 0;     ///< |sum of spherical areas - 4 pi|; an exact map's is a multiple of 4 pi
  double min_area_ratio = 0;  ///< smallest of (share of the sphere) / (share of the surface) over the triangles

  bool bijective() const { return flips == 0 && area_defect < 1e-6; }
};

namespace detail {

/// Adds x to a sum kept without rounding as parts that do not overlap, in rising order (Shewchuk 1997, figure 7).
inline void add_exactly(std::vector<double>& parts, double x) {
  std::size_t kept = 0;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const double a = parts[k], sum = a + x, from_x = sum - a;
    const double tail = (a - (sum - from_x)) + (x - from_x);
    if (tail != 0) parts[kept++] = tail;
    x = sum;
  }
  parts.resize(kept);
  parts.push_back(x);
}

/// Sign of det(a, b, c) without rounding error (barring underflow): the 6 triple products as 24 exact parts.
inline int exact_determinant_sign(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  std::vector<double> parts;
  const auto add = [&](double x, double y, double z) {
    const double high = x * y, low = std::fma(x, y, -high);
    for (const double factor : {high, low}) {
      const double product = factor * z;
      add_exactly(parts, product);
      add_exactly(parts, std::fma(factor, z, -product));
    }
  };
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    add(a[i], b[j], c[k]);
    add(-a[i], b[k], c[j]);
  }
  return parts.back() > 0 ? 1 : parts.back() < 0 ? -1 : 0;
}

/// det(a, b, c) of nearby unit vectors: differences first, so that the error is relative to the triangle, not to 1.
inline double determinant(const Vec3d& a, const Vec3d& b, const Vec3d& c) { return (a - b).dot(b.cross(c - b)); }

inline bool positively_oriented(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const double value = determinant(a, b, c), rounding = 1e-14 * (a - b).norm() * (c - b).norm();
  return std::abs(value) > rounding ? value > 0 : exact_determinant_sign(a, b, c) > 0;
}

}  // namespace detail

/// Signed area of the spherical triangle of three unit vectors, in (-2 pi, 2 pi).
/// source   Van Oosterom and Strackee 1983
inline double spherical_area(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  return 2 * std::atan2(detail::determinant(a, b, c), 1 + a.dot(b) + b.dot(c) + c.dot(a));
}

/// Certifies a sphere map.
/// sphere   3 x n unit vectors, the images of the vertices
/// shares   of the surface, one non-negative value a face, any common factor; a face without share has no ratio
/// throws   UnusableMesh unless the faces triangulate a sphere
///          InvalidArgument where sizes differ or a vector is not of unit length
inline SphereMapCertificate certify(const Mat3X& sphere, const Faces& faces, const Eigen::VectorXd& shares) {
  require(shares.size() == faces.cols(), "certify: ", shares.size(), " shares for ", faces.cols(), " faces");
  require_sphere_topology(faces, sphere.cols());
  for (Index v = 0; v < sphere.cols(); ++v)
    require(std::abs(sphere.col(v).norm() - 1) < 1e-9, "certify: vertex ", v, " has length ", sphere.col(v).norm(),
            ", give unit vectors");
  SphereMapCertificate certificate;
  certificate.min_area_ratio = std::numeric_limits<double>::infinity();
  const double total = shares.sum();
  double sum = 0;
  for (Index f = 0; f < faces.cols(); ++f) {
    const Vec3d a = sphere.col(faces(0, f)), b = sphere.col(faces(1, f)), c = sphere.col(faces(2, f));
    const double area = spherical_area(a, b, c);
    sum += area;
    if (!detail::positively_oriented(a, b, c)) ++certificate.flips;
    if (shares[f] > 0)
      certificate.min_area_ratio = std::min(certificate.min_area_ratio, area / (4 * pi) * total / shares[f]);
  }
  certificate.area_defect = std::abs(sum - 4 * pi);
  return certificate;
}

/// The same with equal shares for all faces.
inline SphereMapCertificate certify(const Mat3X& sphere, const Faces& faces) {
  return certify(sphere, faces, Eigen::VectorXd::Ones(faces.cols()));
}

}  // namespace dsns
