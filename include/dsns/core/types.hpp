#pragma once
/// Shapes that every module shares. Points are columns: a field over n points is a 3 x n matrix.
#include <Eigen/Core>
#include <Eigen/Geometry>

namespace dsns {

template <class T>
using Vec3 = Eigen::Matrix<T, 3, 1>;
using Vec3d = Vec3<double>;
using Mat3 = Eigen::Matrix3d;
using Mat3X = Eigen::Matrix<double, 3, Eigen::Dynamic>;
/// Triangles as columns of three vertex indices, counter-clockwise seen from outside.
using Faces = Eigen::Matrix<int, 3, Eigen::Dynamic>;
using Index = Eigen::Index;

inline constexpr double pi = 3.141592653589793238462643383279502884;

}  // namespace dsns
