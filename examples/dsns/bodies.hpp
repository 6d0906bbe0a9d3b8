#pragma once
/// From a name on the command line to a moving surface that the library can compare with others.
#include "report.hpp"

#include <dsns/core/archive.hpp>
#include <dsns/core/progress.hpp>
#include <dsns/elastic/normalization.hpp>
#include <dsns/elastic/spatial_options.hpp>
#include <dsns/elastic/temporal_options.hpp>
#include <dsns/mesh/own_mesh.hpp>
#include <dsns/mesh/repair.hpp>
#include <dsns/mesh/sphere_certificate.hpp>
#include <dsns/surface/any_surface.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace dsns::program {

enum class Representation { sampled, neural };
enum class Preset { fast, general, paper };  ///< of a fit, see fits.hpp

/// What all subcommands share.
struct Settings {
  int frames = 32;    ///< 0: a clip at 60 frames a second, frame files as they are
  double rate = 0;    ///< frames a second; 0: as many as `frames` of a clip, 24 of frame files
  std::string node;   ///< of a glTF file; empty: the whole scene
  std::string faces;  ///< mesh with the faces of NumPy arrays
  RepairOptions repair;
  bool join = false;  ///< comparable pieces
  std::uint64_t seed = 0;
  int threads = 1;
  std::string json;
  Representation representation = Representation::sampled;
  RotationSearch search = RotationSearch::upright;
  int views = 0;  ///< of registration in space alone: 0: one way; else both ways, so many times
  TemporalAlignment alignment = TemporalAlignment::whole;
  Preset preset = Preset::general;
  int steps = 0;            ///< of the fit; 0: the preset's
  double seconds = 0;       ///< of the fit; 0: no limit
  double target_msd = 0;    ///< ends the fit; 0: none
  std::string checkpoint;   ///< file in which a fit keeps what it needs to go on; empty: none
  bool resume = false;      ///< go on from it, where it is there
  bool keep_going = false;  ///< leave out animations that cannot be used
  std::string work;         ///< folder in which what is finished of a group is kept, to go on from; empty: none
};

/// A file's animation before anything is done to it.
struct Source {
  MeshSequence sequence;
  std::filesystem::path file;
  std::string clip;  ///< of a glTF file
  std::vector<std::string> notes;
};

enum class Still { refused, allowed };  ///< glTF files without animation, and single mesh files

Source read_source(const std::string& name, const Settings& settings, Still still = Still::refused);

/// One closed surface, with what the settings say of pieces.
RepairResult repaired_surface(const MeshSequence& sequence, const Settings& settings);

/// A repaired, centred, mapped animation with its surface.
struct Body {
  NormalizedSequence normalized;
  TriangleMesh sphere;  ///< its own triangles with their vertices on the unit sphere
  SphereMapCertificate certificate;
  AnyAnimatedSurface surface;
  std::filesystem::path file;  ///< where it came from
  OwnMesh own;                 ///< and how its vertices there hang on those here
  Faces own_faces;
};

struct LoadedBody {
  Body body;
  std::vector<std::string> done;  ///< what was done to it, a sentence each
};

/// Reads, repairs and maps; the surface is the sampled mesh.
LoadedBody read_body(const std::string& name, const Settings& settings, const Progress& progress);
/// The same, and says in the report what was done.
Body load_body(const std::string& name, const Settings& settings, Report& report, const Progress& progress);

/// Writes a sequence on the body's triangles as one on the mesh of its file: a GLB with its materials, a .npy, or a folder of
/// OBJ frames.
void write_on_own_mesh(const std::filesystem::path& out, const Body& body, const MeshSequence& result,
                       const Settings& settings);

/// Frames of a surface at the vertices of a sphere mesh, at equidistant times along a warp.
std::vector<Mat3X> frames_of(const AnyAnimatedSurface& surface, const Mat3X& sphere, int frames);

/// Puts size and root motion back: frames in normalised units become a sequence in those of `like`.
MeshSequence denormalize(const std::vector<Mat3X>& frames, const Faces& faces, const Mat3X& trajectory, double scale,
                         double duration, const std::string& name);

/// The trajectory at equidistant times along a warp, relative to its start, in units of the scale.
Mat3X relative_trajectory(const NormalizedSequence& body, const TimeWarp& warp, int frames);

}  // namespace dsns::program
