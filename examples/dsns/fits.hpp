#pragma once
/// Fitting a body by one of the presets, and how far the result is from the mesh where the fit never saw it.
#include "bodies.hpp"

#include <dsns/nn/neural_surface.hpp>
#include <dsns/nn/separable_surface.hpp>
#include <dsns/surface/surface_error.hpp>

#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace dsns::program {

/// Lengths in units of the smallest ball around the origin that holds all centred frames; mean squares in its square.
struct FitFigures {
  SampledSurfaceError error;  ///< on points of the faces that the fit never saw
  int frames = 0;
  struct Separable {
    Index modes, functions;
    double mode_residual, harmonic_residual, radial_residual;
  };
  std::optional<Separable> separable;  ///< of the preset `fast`
  Index parameters = 0;                ///< of the network
  int steps = 0;
  std::string stop;
  double wall_seconds = 0, cpu_seconds = 0;  ///< of the fit alone
};

struct Fitted {
  std::variant<SeparableSurface, NeuralSurface> surface;
  FitFigures figures;
};

/// The frames that a fit may see: all of them, or so many, spread evenly, the first and the last among them.
std::vector<int> spread_frames(int of, int count);

/// Fits some frames of a body; `error` is against the motion through these frames, at their times.
///   fast     temporal modes, harmonics and local functions by least squares
///   general  one network of point and time
///   paper    the D-SNS paper's network and training
Fitted fit_frames(const Body& body, const std::vector<int>& frames, const Settings& settings, const Progress& progress);

/// All frames; the body then has the fitted surface.
Fitted fit_body(Body& body, const Settings& settings, const Progress& progress);

/// Points of the faces that no fit of this seed sees, 3 x n.
Mat3X held_out_points(const Body& body, const Settings& settings);
/// Some frames of a body, and their times in [0, 1].
MeshSequence frames_alone(const Body& body, const std::vector<int>& frames);
std::vector<double> frame_times(const Body& body, const std::vector<int>& frames);
/// Radius of the ball that is the unit of lengths.
double unit_of(const Body& body);

void report_fit(const FitFigures& figures, Report& report);
void say_fit_units(Report& report);
/// What the preset takes, where that is much.
void say_preset(const Settings& settings, Report& report);
std::string word(Preset preset);

}  // namespace dsns::program
