#pragma once
/// Surfaces given by formulas: the ground truth of tests, and bodies for demonstrations. Each works in lanes, and each whose
/// curvatures have a closed form has gaussian_curvature(surface, s) and mean_curvature(surface, s).
#include <dsns/surface/bodies.hpp>
#include <dsns/surface/quadrics.hpp>
#include <dsns/surface/star_shaped.hpp>
#include <dsns/surface/superquadric.hpp>
#include <dsns/surface/tube.hpp>
