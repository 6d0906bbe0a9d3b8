// expect: the function returns one number: use gradient
#include <dsns/autodiff/gradient.hpp>

const Eigen::Vector2d x(1, 2);
const auto g = dsns::jacobian([](const auto& v) { return v.squaredNorm(); }, dsns::wrt(x), dsns::at(x));
