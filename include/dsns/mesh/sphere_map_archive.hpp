#pragma once
/// Diffeomorphisms of the sphere to and from archives, both models.
///
///   Archive archive;
///   store_sphere_map(archive, gamma);
///   write_archive("gamma.dsns", archive);                                        // <dsns/io/archive_file.hpp>
///   const auto gamma = sphere_map_from<SphereDiffeomorphism>(read_archive("gamma.dsns"));
#include <dsns/core/archive.hpp>
#include <dsns/mesh/piecewise_linear_diffeomorphism.hpp>

namespace dsns {

/// Adds a map to an archive; what else is there stays.
inline void store_sphere_map(Archive& archive, const SphereDiffeomorphism& gamma) {
  archive.set("sphere_map", std::string("exponentials"));
  archive.set("sphere_map.rotation", Eigen::MatrixXd(gamma.rotation()));
  archive.set("sphere_map.increments", gamma.increments().size());
  for (std::size_t k = 0; k < gamma.increments().size(); ++k) {
    const SphereVectorField& v = gamma.increments()[k];
    Eigen::MatrixXd potentials(v.a.size(), 2);
    potentials << v.a, v.b;
    archive.set(message("sphere_map.increment.", k), std::move(potentials));
    if (v.step == FieldStep::inverse) archive.set(message("sphere_map.inverse.", k), std::int64_t(1));
  }
}
inline void store_sphere_map(Archive& archive, const PiecewiseLinearDiffeomorphism& gamma) {
  archive.set("sphere_map", std::string("triangles"));
  archive.set("sphere_map.vertices", Eigen::MatrixXd(gamma.vertices()));
  archive.set("sphere_map.images", Eigen::MatrixXd(gamma.images()));
  archive.set("sphere_map.faces", Archive::Integers(gamma.faces().cast<std::int64_t>()));
}

namespace detail {

template <class G>
struct SphereMapReader;
template <>
struct SphereMapReader<SphereDiffeomorphism> {
  static constexpr const char* kind = "exponentials";
  static SphereDiffeomorphism read(const Archive& archive) {
    const Mat3 rotation = archive.get<Eigen::MatrixXd>("sphere_map.rotation", 3, 3);
    require<FileError>((rotation.transpose() * rotation - Mat3::Identity()).norm() < 1e-9 && rotation.determinant() > 0,
                       archive.name(), ": the rotation of the map is none");
    SphereDiffeomorphism gamma(rotation);
    const std::int64_t increments = archive.integer("sphere_map.increments", 0, 100000);
    for (std::int64_t k = 0; k < increments; ++k) {
      const auto& v = archive.get<Eigen::MatrixXd>(message("sphere_map.increment.", k));
      require<FileError>(v.cols() == 2 && v.allFinite(), archive.name(), ": increment ", k, " of the map has ",
                         v.cols(), " potentials, or they are not finite: wanted are 2");
      const bool inverse = archive.contains(message("sphere_map.inverse.", k));
      gamma.append({harmonic_degree(v.rows()), v.col(0), v.col(1), inverse ? FieldStep::inverse : FieldStep::forward});
    }
    const DiffeomorphismCertificate certificate = certify(gamma);
    require<FileError>(certificate.holds(), archive.name(), ": the map folds, its Jacobian falls to ",
                       certificate.min_jacobian);
    return gamma;
  }
};
template <>
struct SphereMapReader<PiecewiseLinearDiffeomorphism> {
  static constexpr const char* kind = "triangles";
  static PiecewiseLinearDiffeomorphism read(const Archive& archive) {
    const auto& vertices = archive.get<Eigen::MatrixXd>("sphere_map.vertices");
    const auto& images = archive.get<Eigen::MatrixXd>("sphere_map.images", 3, vertices.cols());
    const auto& faces = archive.get<Archive::Integers>("sphere_map.faces");
    require<FileError>(vertices.rows() == 3 && faces.rows() == 3, archive.name(), ": vertices of ", vertices.rows(),
                       " coordinates and faces of ", faces.rows(), " corners, wanted are 3 each");
    require<FileError>(faces.size() > 0 && faces.minCoeff() >= 0 && faces.maxCoeff() < vertices.cols(), archive.name(),
                       ": faces of the map name vertices that do not exist");
    return {TriangleMesh{vertices, faces.cast<int>()}, images};
  }
};

}  // namespace detail

/// The map of an archive as G, one of the two models.
/// accuracy the same to the bit as the map that was stored [mesh/sphere_map_archive_test]
/// throws   FileError where the archive holds none, one of the other model, one that does not fit together, or one that folds
template <class G>
G sphere_map_from(const Archive& archive) {
  const std::string& kind = archive.text("sphere_map");
  require<FileError>(kind == detail::SphereMapReader<G>::kind, archive.name(), " holds a map made of ", kind,
                     ", wanted was one of ", detail::SphereMapReader<G>::kind);
  try {
    return detail::SphereMapReader<G>::read(archive);
  } catch (const FileError&) {
    throw;
  } catch (const Error& misfit) {
    fail<FileError>(archive.name(), ": ", misfit.what());
  }
}

}  // namespace dsns
