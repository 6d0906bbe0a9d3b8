#pragma once
/// Integrals over a surface by quadrature on the sphere: spectrally accurate where the surface is smooth. A sampled mesh is
/// flat in its faces: its areas and volumes converge slowly, its curvature sits in edges that no quadrature sees.
#include <dsns/geometry/curvature.hpp>
#include <dsns/sphere/quadrature.hpp>

#include <type_traits>

namespace dsns {

/// Integral over the surface of a function of the sphere's point, a number or a fixed-size vector.
template <Surface S, class G>
auto integral(const S& surface, const SphereQuadrature& q, const G& g) {
  const Eigen::VectorXd area = area_densities(tangents(surface, charts_at(q.points))).cwiseProduct(q.weights);
  using Value = std::remove_cvref_t<decltype(g(Vec3d()))>;
  Value sum = area[0] * g(Vec3d(q.points.col(0)));
  for (Index i = 1; i < q.size(); ++i) sum += area[i] * g(Vec3d(q.points.col(i)));
  return sum;
}

/// accuracy 1e-10 for an ellipsoid 1:2:3 at n = 60 [geometry/integrals_test]
template <Surface S>
double area(const S& surface, const SphereQuadrature& q) {
  return area_densities(tangents(surface, charts_at(q.points))).dot(q.weights);
}

/// By the divergence theorem, 1/3 of the flux of the position; negative for a surface turned inside out.
template <Surface S>
double volume(const S& surface, const SphereQuadrature& q) {
  const SurfaceTangents j = tangents(surface, charts_at(q.points));
  return (j.f.cwiseProduct(area_normals(j)).colwise().sum() * q.weights / 3).value();
}

/// Size, place and bending of a closed surface.
struct SurfaceMeasures {
  double area = 0;
  double volume = 0;                      ///< by the divergence theorem, 1/3 of the flux of the position
  Vec3d area_centroid = Vec3d::Zero();    ///< of the surface as a shell
  Vec3d volume_centroid = Vec3d::Zero();  ///< of the body it encloses, 1/4 of the flux of x (x . n) over the volume
  double total_curvature = 0;             ///< integral of K: 4 pi for every closed genus-0 surface (Gauss-Bonnet)
  double total_mean_curvature = 0;        ///< integral of H, a length; 4 pi r for a sphere
  double willmore_energy = 0;             ///< integral of H^2: at least 4 pi, the value of spheres (Willmore 1965)
};

/// accuracy 1e-10 for an ellipsoid 1:2:3 at n = 60 [geometry/integrals_test]
/// throws   DegenerateSurface where the surface is not immersed
template <Surface S>
SurfaceMeasures measure(const S& surface, const SphereQuadrature& q) {
  const SurfaceJets j = jets(surface, charts_at(q.points));
  const Mat3X normals = area_normals(j);
  const Eigen::VectorXd area = normals.colwise().norm().transpose().cwiseProduct(q.weights);
  const Eigen::VectorXd flux = j.f.cwiseProduct(normals).colwise().sum().transpose().cwiseProduct(q.weights);
  const Curvature c = curvature(j);
  SurfaceMeasures m;
  m.area = area.sum();
  m.volume = flux.sum() / 3;
  m.area_centroid = j.f * area / m.area;
  m.volume_centroid = j.f * flux / (4 * m.volume);
  m.total_curvature = c.gaussian.dot(area);
  m.total_mean_curvature = c.mean.dot(area);
  m.willmore_energy = c.mean.cwiseAbs2().dot(area);
  return m;
}

}  // namespace dsns
