#pragma once
/// Everything that needs Eigen alone. glTF is apart: <dsns/io/gltf.hpp> needs tinygltf.
#include <dsns/elastic/geodesic.hpp>
#include <dsns/elastic/normalization.hpp>
#include <dsns/geometry/integrals.hpp>
#include <dsns/io/obj.hpp>
#include <dsns/mesh/area_ratios.hpp>
#include <dsns/mesh/repair.hpp>
#include <dsns/mesh/sampling.hpp>
#include <dsns/mesh/sphere_mesh.hpp>
#include <dsns/mesh/spherical_parameterization.hpp>
#include <dsns/nn/fit.hpp>
#include <dsns/stats/moving_mean.hpp>
#include <dsns/surface/analytic.hpp>
#include <dsns/surface/any_surface.hpp>
#include <dsns/surface/sampled.hpp>
#include <dsns/surface/surface_error.hpp>
#include <dsns/version.hpp>
