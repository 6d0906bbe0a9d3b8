// expect: cast the constant one: b.cast<X>
#include <dsns/autodiff/linear_algebra.hpp>

const Eigen::Matrix2<dsns::Dual<double>> a = Eigen::Matrix2<dsns::Dual<double>>::Identity();
const auto x = dsns::solve(a, Eigen::Vector2d(1, 2));
