#pragma once
// The same by hand: what differentiation could cost at best.
#include "workloads.hpp"

namespace hand {

using workloads::Charts, workloads::FirstOrder, workloads::Rows, workloads::Samples, workloads::SecondOrder;

FirstOrder first_order(double u, double v, double t);
SecondOrder second_order(double u, double v, double t);

/// Values; the gradient goes to g, of the size of x.
double rosenbrock(const std::vector<double>& x, std::vector<double>& g);
double arrow(const std::vector<double>& x, std::vector<double>& g);
double log_cosh(const std::vector<double>& x, const Rows& a, std::vector<double>& g);
double network_loss(const std::vector<double>& p, const Samples& samples, std::vector<double>& g);
double curvature_loss(const std::vector<double>& p, const Charts& charts, std::vector<double>& g);

/// Rosenbrock's value, gradient and the 3 n - 2 entries of its tridiagonal Hessian, column by column.
double rosenbrock_hessian(const std::vector<double>& x, std::vector<double>& g, std::vector<double>& h);

}  // namespace hand
