#pragma once
/// Which part of the sphere an open surface covers: the rest is caps over its holes, of which nothing is known.
#include <dsns/mesh/sphere_location.hpp>
#include <dsns/mesh/triangle_mesh.hpp>

#include <memory>
#include <vector>

namespace dsns {

/// 1 on the surface and its rims, 0 inside the caps. Copies share their tables.
///
///   options.spatial.mask = SphereMask(first, sphere);    // integrals over the surface alone
class SphereMask {
 public:
  /// sphere   3 x n, the images of the sequence's vertices
  /// throws   UnusableMesh where the sphere map is not one to one
  SphereMask(const MeshSequence& sequence, const Mat3X& sphere)
      : location_(std::make_shared<SphereLocation>(sphere, sequence.faces)),
        first_cap_(sequence.faces.cols() - sequence.cap_faces),
        of_caps_only_(static_cast<std::size_t>(sphere.cols()), 1) {
    for (const int v : sequence.faces.leftCols(first_cap_).reshaped()) of_caps_only_[static_cast<std::size_t>(v)] = 0;
  }

  double operator()(const Vec3d& s) const {
    const SphereHit hit = (*location_)(s);
    if (hit.face < first_cap_) return 1;
    double inner = 0;
    bool has_centre = false;
    for (int k = 0; k < 3; ++k) {
      const bool centre = of_caps_only_[static_cast<std::size_t>(location_->faces()(k, hit.face))] != 0;
      has_centre = has_centre || centre;
      if (centre) inner += hit.barycentric[k];
    }
    constexpr double on_edge = 1e-9;
    return (has_centre ? inner : hit.barycentric.minCoeff()) < on_edge ? 1 : 0;
  }
  /// At the unit columns of s, n values.
  Eigen::VectorXd operator()(const Mat3X& s) const {
    Eigen::VectorXd values(s.cols());
    for (Index i = 0; i < s.cols(); ++i) values[i] = (*this)(Vec3d(s.col(i)));
    return values;
  }

 private:
  std::shared_ptr<const SphereLocation> location_;
  Index first_cap_;
  std::vector<char> of_caps_only_;
};

}  // namespace dsns
