#pragma once
/// Registrations to and from archives, so that long work can go on where it was stopped.
#include <dsns/mesh/sphere_map_archive.hpp>
#include <dsns/stats/co_registration.hpp>

#include <functional>
#include <optional>

namespace dsns {

/// Where a long computation keeps what it has finished, by name. Both are called from several threads at a time; empty: nothing
/// is kept.
struct ResultStore {
  std::function<std::optional<Archive>(const std::string& name)> read;
  std::function<void(const std::string& name, const Archive& archive)> write;

  std::optional<Archive> find(const std::string& name) const { return read ? read(name) : std::nullopt; }
  void keep(const std::string& name, const Archive& archive) const {
    if (write) write(name, archive);
  }
};

/// Adds a registration of whole motions to an archive; what else is there stays.
inline void store_registration(Archive& archive, const MovingRegistration& r) {
  const SpatialSummary& s = r.spatial.summary;
  const TemporalSummary& t = r.temporal.summary;
  store_sphere_map(archive, r.spatial.gamma);
  archive.set("registration.rotation", Eigen::MatrixXd(r.spatial.rotation));
  archive.set("registration.spatial",
              Eigen::MatrixXd(Eigen::Vector4d(s.energy_before, s.energy_after, s.norm, s.min_jacobian)));
  archive.set("registration.spatial_steps", s.steps);
  archive.set("registration.spatial_stop", s.stop);
  Eigen::MatrixXd warp(r.temporal.warp.values().size(), 2);
  warp << r.temporal.warp.values(), r.temporal.warp.slopes();
  archive.set("registration.warp", std::move(warp));
  archive.set("registration.temporal",
              Eigen::MatrixXd(Eigen::Vector4d(t.energy_before, t.energy_after, t.norm, t.min_slope)));
  archive.set("registration.temporal_steps", t.steps);
  archive.set("registration.temporal_stop", t.stop);
  archive.set("registration.advice", t.advice);
}

/// accuracy the same maps to the bit as those that were stored [stats/group_registration_test]
/// throws   FileError where the archive holds none, or one that does not fit together
inline MovingRegistration registration_from(const Archive& archive) {
  MovingRegistration r;
  SpatialSummary& s = r.spatial.summary;
  TemporalSummary& t = r.temporal.summary;
  r.spatial.gamma = sphere_map_from<SphereDiffeomorphism>(archive);
  r.spatial.rotation = archive.get<Eigen::MatrixXd>("registration.rotation", 3, 3);
  const auto& spatial = archive.get<Eigen::MatrixXd>("registration.spatial", 4, 1);
  const auto& temporal = archive.get<Eigen::MatrixXd>("registration.temporal", 4, 1);
  s = {spatial(0), spatial(1), spatial(2), spatial(3), 0, {}, archive.text("registration.spatial_stop")};
  s.steps = static_cast<int>(archive.integer("registration.spatial_steps", 0, 100000));
  const auto& warp = archive.get<Eigen::MatrixXd>("registration.warp");
  require<FileError>(warp.cols() == 2, archive.name(), ": the warp of time has ", warp.cols(),
                     " columns, wanted are 2");
  try {
    r.temporal.warp = TimeWarp(warp.col(0), warp.col(1));
  } catch (const InvalidArgument& misfit) {
    fail<FileError>(archive.name(), ": ", misfit.what());
  }
  t.energy_before = temporal(0);
  t.energy_after = temporal(1);
  t.norm = temporal(2);
  t.min_slope = temporal(3);
  t.steps = static_cast<int>(archive.integer("registration.temporal_steps", 0, 100000));
  t.stop = archive.text("registration.temporal_stop");
  t.advice = archive.text("registration.advice");
  return r;
}

}  // namespace dsns
