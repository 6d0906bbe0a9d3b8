#pragma once
/// The subcommands. Each prints its figures in a report; errors come as exceptions of the library.
#include "bodies.hpp"
#include "group.hpp"
#include "landmarks.hpp"

#include <dsns/stats/principal_modes.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace dsns::program {

void inspect(const std::string& source, const Settings& settings, Report& report);
/// Maps the body to the sphere.
void parameterize(const std::string& source, const std::filesystem::path& out, const Settings& settings,
                  Report& report);
/// Makes one moving mesh, on the triangles of the first, of a folder of frames that each have their own.
void track(const std::filesystem::path& folder, const std::filesystem::path& out, const Settings& settings,
           Report& report);
/// Fits a network to the body, which then is the network. `out` may be empty: nothing is written; likewise below.
void fit(Body& body, const std::filesystem::path& out, const Settings& settings, Report& report);
/// `own`: where to write the result on the first one's own mesh, or empty; likewise below.
void register_two(const Body& first, const Body& second, const std::filesystem::path& out,
                  const std::filesystem::path& own, const LandmarkFile& landmarks, const Settings& settings,
                  Report& report);
/// What a geodesic goes between: bodies registered in space and time, or, to see the difference, as their sphere maps and clocks
/// have them.
enum class GeodesicEnds { registered, as_they_are };
/// What the way between leads through: curves in the space of joint principal components, or square-root normal fields, each
/// time by itself, sent back to surfaces.
enum class GeodesicPath { components, srnf };
struct GeodesicOptions {
  int steps = 5;
  GeodesicEnds ends = GeodesicEnds::registered;
  GeodesicPath path = GeodesicPath::components;
  int degree = 12;                  ///< of the harmonics of the path through fields
  std::filesystem::path out, each;  ///< one file with all steps; a folder with a file for each; or empty
};
void geodesic(const Body& first, const Body& second, const GeodesicOptions& options, const Settings& settings,
              Report& report);
/// The motion of the first on the second, each triangle deformed as the corresponding piece of the first is from where both
/// stand alike; `own` is the second's.
void transfer(const Body& first, const Body& second, const std::filesystem::path& out, const std::filesystem::path& own,
              const Settings& settings, Report& report);
/// Where the results of a mean go; empty: nowhere.
struct MeanOutputs {
  std::filesystem::path mean, overview;  ///< alone; with all registered before it
  std::filesystem::path before;          ///< all as they are, with the mean that they have without registration
  std::filesystem::path own;             ///< on the first one's own mesh
  std::filesystem::path fitted;          ///< .dsns: a surface that is a function of point and time, fitted to the mean
};
void mean(const Group& group, const MeanOutputs& out, const Settings& settings, Report& report);
struct Study {
  std::optional<MotionPart> part =
      MotionPart::all;   ///< that is compared; none: the bodies, whatever they do (distances alone)
  int eigenvalues = 60;  ///< of each body that are compared, at most a tenth of its vertices
  int modes = 3;         ///< that are written and sampled
  int samples = 20;
  double spread = 1;  ///< of the samples, standard deviations
  std::optional<double>
      folded;  ///< share of the area that samples may fold; none: as the median member, see ValidityBounds
  std::vector<std::string> labels;  ///< one a file named, those left out among them, or none; likewise below
  std::vector<double> covariate;
  std::filesystem::path out;  ///< folder, or empty; likewise below
  std::filesystem::path csv;
};
/// The principal modes of the bodies around their mean, each as an animation of -3 to 3 standard deviations side by side.
void modes(const Group& group, const Study& study, const Settings& settings, Report& report);
/// Random members of the group that are valid: time goes forward, and no more is torn than in the members. Writes those found and
/// then throws where they are fewer than wanted.
void sample_bodies(const Group& group, const Study& study, const std::filesystem::path& out, const Settings& settings,
                   Report& report);
/// Who is near whom, and what labels and a covariate explain.
void distances(const Group& group, const Study& study, const Settings& settings, Report& report);
struct RepresentationEvaluation {
  int frames_trained = 30;    ///< of a second fit, tested on the other frames; 0: none
  std::filesystem::path out;  ///< folder for heat maps of the errors, or empty; likewise below
  std::filesystem::path csv, markdown;
};
/// Fits every sequence named, or in the folders named, and compares it with its mesh. What cannot be used is said on stderr
/// and does not stop the rest.
/// returns  how many could not be used
int evaluate_representation(const std::vector<std::string>& sources, const Settings& settings,
                            const RepresentationEvaluation& evaluation, Report& report);
/// Animations named, and for a folder every clip of every file in it.
std::vector<std::string> sequences_of(const std::vector<std::string>& sources);
enum class TemporalExperiment {
  warps,     ///< of each sequence, recovered
  pairs,     ///< each sequence against each other
  stretches  ///< each sequence against a part of it, and against more than one cycle
};
struct TemporalEvaluation {
  TemporalExperiment experiment = TemporalExperiment::warps;
  int warps = 10;             ///< random ones, of each sequence; of each pair that performs one clip
  int networks = 2;           ///< for so many of them the paper's network is trained
  bool strong = false;        ///< slopes from 0.03 to 4 instead of 0.2 to 2.3
  std::filesystem::path out;  ///< folder for the plot, or empty; likewise below
  std::filesystem::path csv, markdown;
};
/// Known warps of time are recovered, or sequences brought to the pace of others.
/// returns  how many could not be used
int evaluate_temporal(const std::vector<std::string>& sources, const Settings& settings,
                      const TemporalEvaluation& evaluation, Report& report);
/// The whole chain into a folder. With no sources, makes three bodies first.
void demo(std::vector<std::string> sources, const std::filesystem::path& folder, const Settings& settings,
          Report& report);

}  // namespace dsns::program
