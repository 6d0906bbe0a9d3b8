#pragma once
/// All analytic surfaces, resting and moving, for laws that hold of each.
///
///   test::for_each_surface([](const std::string& name, const auto& surface) { INFO(name); ... });
#include <dsns/surface/analytic.hpp>
#include <dsns/surface/motion.hpp>

#include <string>

namespace dsns::test {

/// Radius 1 with harmonics of degree up to 4, between about 0.6 and 1.4.
inline StarShaped star_shaped() {
  Eigen::VectorXd c(harmonic_count(4));
  const Eigen::ArrayXd l = harmonic_degrees(4);
  for (Index k = 0; k < c.size(); ++k) c[k] = 0.2 * std::sin(2.7 * double(k)) / (1 + l[k]);
  c[0] = std::sqrt(4 * pi);
  return StarShaped(c);
}

inline LimbedBody limbed_body() {
  LimbedBody body;
  body.axes = {1, 0.7, 0.5};
  body.limbs = {{Vec3d(1, 1, 0.3).normalized(), 4, Vec3d(0.6, 0.1, 0.2), Vec3d(0, 0.3, 0.3), 0.1},
                {Vec3d(-1, 0.2, 0.4).normalized(), 5, Vec3d(-0.4, 0.1, 0.1), Vec3d(0.1, 0, 0.2), 0.6}};
  body.pace = 0.4;
  return body;
}

/// Calls visit(name, surface) for every resting analytic surface, all with closed-form curvatures.
template <class Visit>
void for_each_surface(const Visit& visit) {
  visit("unit sphere", Sphere{});
  visit("sphere", Sphere{3.7});
  visit("prolate spheroid", Spheroid{0.8, 2.5});
  visit("oblate spheroid", Spheroid{2, 0.5});
  visit("ellipsoid", Ellipsoid{1, 2, 5});
  visit("ellipsoid as a superquadric", Superquadric({1, 1.5, 0.7}, 2));
  visit("superquadric of exponent 4", Superquadric({1, 1.5, 0.7}, 4));
  visit("superquadric of exponent 6", Superquadric({2, 1, 1}, 6));
  visit("bumpy sphere", BumpySphere{0.15, 4});
  visit("bumpier sphere", BumpySphere{-0.3, 6});
  visit("star-shaped surface", star_shaped());
  visit("straight tube", Tube({3, 0}, 0.5, 3));
  visit("bent tube", Tube({4, 0.9}, 0.4, 2));
  visit("strongly bent tube", Tube({4, -1.4}, 0.5, 4));
}

/// Calls visit(name, surface) for moving surfaces of every kind.
template <class Visit>
void for_each_moving_surface(const Visit& visit) {
  visit("limbed body", limbed_body());
  visit("breathing sphere", animated([]<class T>(const T& t) { return SphereOf<T>{1.0 + 0.3 * t}; }));
  visit("stretching spheroid", animated([]<class T>(const T& t) { return SpheroidOf<T>{1.0 - 0.3 * t, 1.0 + t * t}; }));
  visit("turning ellipsoid", animated([]<class T>(const T& t) {
          using std::cos, std::sin;
          return EllipsoidOf<T>{1.0 + 0.2 * sin(3.0 * t), T(1.3), 1.0 + 0.2 * cos(3.0 * t)};
        }));
  visit("growing superquadric", animated([]<class T>(const T& t) {
          return SuperquadricOf<T>(Vec3<T>(1.0 + 0.5 * t, T(0.8), 1.0 - 0.3 * t), 4);
        }));
  visit("rippling sphere", animated([]<class T>(const T& t) {
          using std::sin;
          return BumpySphereOf<T>{0.3 * sin(6.0 * t), 4};
        }));
  visit("bending tube", animated([]<class T>(const T& t) {  // straight at t = 0.3
          return TubeOf<T>(ArcOf<T>{3.0 + 0.5 * t, 2.0 * t - 0.6}, T(0.4), 3);
        }));
  visit("resting tube", resting(Tube({4, 0.9}, 0.4, 2)));
  visit("star-shaped blend", sum(modulated(star_shaped(), [](const auto& t) { return 1.0 - t * t; }),
                                 modulated(Sphere{1.2}, [](const auto& t) { return t * t; })));
}

}  // namespace dsns::test
