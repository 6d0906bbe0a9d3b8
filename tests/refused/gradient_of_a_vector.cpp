// expect: the function returns more than one number: use jacobian
#include <dsns/autodiff/gradient.hpp>

const Eigen::Vector2d x(1, 2);
const auto g = dsns::gradient([](const auto& v) { return (2 * v).eval(); }, dsns::wrt(x), dsns::at(x));
