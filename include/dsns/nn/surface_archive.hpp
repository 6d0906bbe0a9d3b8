#pragma once
/// Fitted surfaces to and from archives: encoding, network, normalisation, and of separable ones the modes and harmonics.
///
///   Archive archive;
///   store_surface(archive, fit.surface);
///   write_archive("walk.dsns", archive);
///   const AnyAnimatedSurface surface = surface_from(read_archive("walk.dsns"));
#include <dsns/core/archive.hpp>
#include <dsns/nn/separable_surface.hpp>
#include <dsns/surface/any_surface.hpp>

#include <array>

namespace dsns {

namespace detail {

inline constexpr std::array<const char*, 4> activation_words{"softplus", "silu", "tanh", "sine"};

inline void store_encoding(Archive& archive, const SurfaceEncoding& e) {
  archive.set("encoding.harmonic_degree", e.harmonic_degree);
  archive.set("encoding.harmonic_decay", e.harmonic_decay);
  archive.set("encoding.space_octaves", e.space_octaves);
  archive.set("encoding.space_base", e.space_base);
  archive.set("encoding.time_frequencies", e.time_frequencies);
  archive.set("encoding.time_octaves", e.time_octaves);
  archive.set("encoding.time_base", e.time_base);
}

/// Bounds are far above what anybody fits; they keep products of sizes from overflowing.
inline SurfaceEncoding encoding_from(const Archive& archive) {
  const auto count = [&](const char* name) { return static_cast<int>(archive.integer(name, 0, 1000)); };
  SurfaceEncoding e;
  e.harmonic_degree = count("encoding.harmonic_degree");
  e.harmonic_decay = archive.number("encoding.harmonic_decay");
  e.space_octaves = count("encoding.space_octaves");
  e.space_base = archive.number("encoding.space_base");
  e.time_frequencies = count("encoding.time_frequencies");
  e.time_octaves = count("encoding.time_octaves");
  e.time_base = archive.number("encoding.time_base");
  return e;
}

template <class T>
void store_network(Archive& archive, const Mlp<T>& network) {
  const MlpShape& shape = network.shape();
  archive.set("network.width", shape.width);
  archive.set("network.blocks", shape.blocks);
  archive.set("network.outputs", shape.outputs);
  archive.set("network.activation", std::string(activation_words[static_cast<std::size_t>(shape.activation)]));
  archive.set("network.parameters", Eigen::MatrixX<T>(network.parameters()));
}

template <class T>
Mlp<T> network_from(const Archive& archive, Index inputs) {
  MlpShape shape;
  shape.inputs = static_cast<int>(inputs);
  require<FileError>(inputs > 0, archive.name(), ": the encoding has no features");
  shape.width = static_cast<int>(archive.integer("network.width", 1, 100000));
  shape.blocks = static_cast<int>(archive.integer("network.blocks", 0, 1000));
  shape.outputs = static_cast<int>(archive.integer("network.outputs", 1, 100000));
  const std::string& word = archive.text("network.activation");
  const auto known = std::find(activation_words.begin(), activation_words.end(), word);
  require<FileError>(known != activation_words.end(), archive.name(), ": the activation '", word, "' is not known");
  shape.activation = static_cast<Activation>(known - activation_words.begin());
  const auto& parameters = archive.get<Eigen::MatrixX<T>>("network.parameters", shape.parameter_count(), 1);
  require<FileError>(parameters.allFinite(), archive.name(), ": parameters of the network are not finite");
  return {shape, Eigen::VectorX<T>(parameters)};
}

/// translation + scale (...)
struct Placement {
  Vec3d translation;
  double scale;
};
inline void store_placement(Archive& archive, const Vec3d& translation, double scale) {
  archive.set("translation", Eigen::MatrixXd(translation));
  archive.set("scale", scale);
}
inline Placement placement_from(const Archive& archive) {
  const Placement out{archive.get<Eigen::MatrixXd>("translation", 3, 1), archive.number("scale")};
  require<FileError>(out.translation.allFinite() && std::isfinite(out.scale), archive.name(),
                     ": the translation or scale is not finite");
  return out;
}

inline TemporalModes modes_from(const Archive& archive) {
  const auto& values = archive.get<Eigen::MatrixXd>("modes");
  require<FileError>(values.rows() > 0 && values.rows() <= 10000 && values.cols() > 0 && values.allFinite(),
                     archive.name(), ": ", values.cols(), " modes at ", values.rows(),
                     " knots, or not finite: wanted are 1 mode and 1 to 10000 knots at least");
  const auto& times = archive.get<Eigen::MatrixXd>("times", values.rows(), 1);
  require<FileError>(
      times.allFinite() && (times.bottomRows(times.rows() - 1).array() > times.topRows(times.rows() - 1).array()).all(),
      archive.name(), ": the times of the knots do not increase");
  return TemporalModes(values, std::vector<double>(times.data(), times.data() + times.size()));
}

inline Eigen::MatrixXd harmonics_from(const Archive& archive) {
  const auto& harmonics = archive.get<Eigen::MatrixXd>("harmonics");
  const auto side = static_cast<Index>(std::lround(std::sqrt(double(harmonics.rows()))));
  require<FileError>(side * side == harmonics.rows() && harmonics.allFinite(), archive.name(), ": ", harmonics.rows(),
                     " harmonics, or not finite: wanted are the square of a number");
  return harmonics;
}

inline RadialSum radial_from(const Archive& archive) {
  if (!archive.contains("radial.centres")) return {};
  const auto& centres = archive.get<Eigen::MatrixXd>("radial.centres");
  const auto& metrics = archive.get<Eigen::MatrixXd>("radial.metrics", 9, centres.cols());
  const auto& coefficients = archive.get<Eigen::MatrixXd>("radial.coefficients");
  require<FileError>(centres.rows() == 3 && centres.allFinite() && metrics.allFinite() && coefficients.allFinite() &&
                         coefficients.rows() == centres.cols(),
                     archive.name(), ": ", centres.cols(), " local functions with ", coefficients.rows(),
                     " coefficients, or not finite");
  try {
    return {RadialBasis(centres, metrics), coefficients};
  } catch (const InvalidArgument& unusable) {
    throw FileError(archive.name() + ": " + unusable.what());
  }
}

template <class S>
struct SurfaceReader;
template <class T>
struct SurfaceReader<BasicNeuralSurface<T>> {
  static constexpr const char* kind = "neural";
  static BasicNeuralSurface<T> read(const Archive& archive) {
    const SurfaceEncoding encoding = encoding_from(archive);
    const Placement place = placement_from(archive);
    return {encoding, network_from<T>(archive, encoding.features()), place.translation, place.scale};
  }
};
template <class T>
struct SurfaceReader<BasicSeparableSurface<T>> {
  static constexpr const char* kind = "separable";
  static BasicSeparableSurface<T> read(const Archive& archive) {
    const SurfaceEncoding encoding = encoding_from(archive);
    const Placement place = placement_from(archive);
    std::optional<Mlp<T>> network;
    if (archive.contains("network.parameters")) network = network_from<T>(archive, encoding.features());
    return {modes_from(archive), harmonics_from(archive), encoding, std::move(network), place.translation,
            place.scale,         radial_from(archive)};
  }
};

inline void require_kind(const Archive& archive, std::string_view kind) {
  require<FileError>(archive.text("surface") == kind, archive.name(), " holds a surface of the kind '",
                     archive.text("surface"), "', wanted was '", kind, "'");
}

}  // namespace detail

/// Adds a surface to an archive; what else is there stays.
template <class T>
void store_surface(Archive& archive, const BasicNeuralSurface<T>& surface) {
  archive.set("surface", std::string("neural"));
  detail::store_encoding(archive, surface.encoding());
  detail::store_network(archive, surface.network());
  detail::store_placement(archive, surface.translation(), surface.scale());
}
template <class T>
void store_surface(Archive& archive, const BasicSeparableSurface<T>& surface) {
  archive.set("surface", std::string("separable"));
  archive.set("modes", surface.time().values());
  const std::vector<double>& times = surface.time().times();
  archive.set("times", Eigen::MatrixXd(Eigen::MatrixXd::Map(times.data(), Index(times.size()), 1)));
  archive.set("harmonics", surface.harmonics());
  if (const RadialSum& radial = surface.radial(); radial.basis.size() > 0) {
    archive.set("radial.centres", Eigen::MatrixXd(radial.basis.centres()));
    archive.set("radial.metrics", Eigen::MatrixXd(radial.basis.metrics()));
    archive.set("radial.coefficients", radial.coefficients);
  }
  detail::store_encoding(archive, surface.encoding());
  if (surface.network()) detail::store_network(archive, *surface.network());
  detail::store_placement(archive, surface.translation(), surface.scale());
}

/// The surface of an archive as S: BasicNeuralSurface or BasicSeparableSurface of float or double.
/// accuracy the same to the bit as the surface that was stored [nn/surface_archive_test]
/// throws   FileError where the archive holds none, one of another kind or precision, or one that does not fit together
template <class S>
S surface_from(const Archive& archive) {
  detail::require_kind(archive, detail::SurfaceReader<S>::kind);
  try {
    return detail::SurfaceReader<S>::read(archive);
  } catch (const InvalidArgument& misfit) {
    fail<FileError>(archive.name(), ": ", misfit.what());
  }
}

/// The surface of an archive, whatever its kind and precision. Throws as above.
inline AnyAnimatedSurface surface_from(const Archive& archive) {
  const auto network = archive.arrays().find("network.parameters");
  const bool single = network != archive.arrays().end() && std::holds_alternative<Eigen::MatrixXf>(network->second);
  const auto read = [&]<template <class> class S>() {
    return single ? AnyAnimatedSurface(surface_from<S<float>>(archive))
                  : AnyAnimatedSurface(surface_from<S<double>>(archive));
  };
  if (archive.text("surface") == "separable") return read.template operator()<BasicSeparableSurface>();
  return read.template operator()<BasicNeuralSurface>();
}

}  // namespace dsns
