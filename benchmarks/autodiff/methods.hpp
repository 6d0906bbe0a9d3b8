#pragma once
// A method of differentiation: what it can do of the workloads.
#include "workloads.hpp"

#include <functional>
#include <string>
#include <vector>

struct Data {
  workloads::SurfacePoints points;  // 1024
  std::vector<double> x;            // 1000, for R, A and L
  workloads::Rows rows;             // 256
  std::vector<double> parameters;   // of the network
  workloads::Samples samples;       // 256
  workloads::Charts charts;         // 256
};
const Data& data();

struct Method {
  using Gradient = std::function<double(const std::vector<double>& x, std::vector<double>& g)>;
  std::string name;
  std::function<void(const workloads::SurfacePoints&, std::vector<workloads::FirstOrder>&)> first_order{};
  std::function<void(const workloads::SurfacePoints&, std::vector<workloads::SecondOrder>&)> second_order{};
  Gradient rosenbrock{}, arrow{}, log_cosh{}, network{}, curvature{};
  std::function<double(const std::vector<double>& x, std::vector<double>& g, std::vector<double>& h)> sparse_hessian{};
  std::function<std::size_t()> network_tape_bytes{};  // of one recording of the network's loss
};

// Each in a translation unit of its own.
std::vector<Method> dsns_methods();
std::vector<Method> ceres_methods();
std::vector<Method> eigen_methods();
std::vector<Method> adolc_methods();
