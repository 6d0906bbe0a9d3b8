#pragma once
/// Co-registration of a group of moving surfaces: first to one of them, which is chosen whatever their order, then in space to
/// their own mean as it evolves. Cost linear in the number of members; one surface a thread is held at a time.
///
///   const auto load = [&](std::size_t i) -> const F& { return surfaces[i]; };        // or reads it from a file
///   const GroupTemplate chosen = choose_template(load, n);
///   const GroupRegistration group = register_group(load, chosen, sphere, options);
#include <dsns/stats/group_gauge.hpp>
#include <dsns/stats/group_template.hpp>
#include <dsns/stats/registration_archive.hpp>

#include <mutex>
#include <utility>

namespace dsns {

/// Gives the moving surface of a member, by value or by reference. Called from several threads at a time.
template <class L>
concept LoadsSurfaces = AnimatedSurface<std::remove_cvref_t<std::invoke_result_t<const L&, std::size_t>>>;

struct GroupOptions {
  RegistrationOptions registration;  ///< to the template; spatial.threads are the members registered at a time
  int iterations = 10;
  double tolerance = 0.02;  ///< converged when an iteration lowers the energy by less than this share of it, and
  double least = 1e-6;      ///< this share of what it was unregistered
  GaugeOptions gauge;
};

/// Energies are the sums over members and times of |O_i g_i - mean g|^2, g the half-density field of the last level.
struct GroupSummary {
  double energy_unregistered = 0;  ///< as sphere maps and clocks have them
  std::vector<double> energy;      ///< registered to the template, then after every iteration
  double norm = 0;                 ///< sum of |g_i|^2, to compare the energies with
  double gauge = 0;                ///< of the maps: root mean square of the mean field that is left, radians
  double min_jacobian = 1;         ///< of all maps
  bool converged = false;
};

struct GroupRegistration {
  GroupTemplate chosen;
  std::vector<MovingRegistration> members;  ///< O_i F_i(gamma_i(s), warp_i(t)) correspond, over i
  GroupSummary summary;
};

template <LoadsSurfaces Load>
GroupTemplate choose_template(const Load& load, std::size_t members, int threads = 1) {
  std::vector<Eigen::VectorXd> descriptors(members);
  parallel_for(static_cast<int>(members), threads,
               [&](int i) { descriptors[std::size_t(i)] = motion_descriptor(load(std::size_t(i))); });
  return choose_template(descriptors);
}

namespace detail {

/// compute(i) for every member on several threads, then fold(i, result) in the members' own order: sums are the same to the bit
/// whatever order they came in and however many threads there are, and few results are held.
template <class Compute, class Fold>
void fold_members(const GroupTemplate& chosen, int threads, const Compute& compute, const Fold& fold) {
  using Result = std::invoke_result_t<const Compute&, std::size_t>;
  const std::size_t batch = std::size_t(std::max(1, threads));
  for (std::size_t first = 0; first < chosen.order.size(); first += batch) {
    const std::size_t count = std::min(batch, chosen.order.size() - first);
    std::vector<std::optional<Result>> results(count);
    parallel_for(static_cast<int>(count), threads,
                 [&](int k) { results[std::size_t(k)] = compute(chosen.order[first + std::size_t(k)]); });
    for (std::size_t k = 0; k < count; ++k) fold(chosen.order[first + k], std::move(*results[k]));
  }
}

/// The mask of the template's sphere seen from the group's.
inline std::function<Eigen::VectorXd(const Mat3X&)> group_mask(const RegistrationOptions& options,
                                                               const SphereDiffeomorphism& gamma) {
  if (!options.spatial.mask) return {};
  return [mask = options.spatial.mask, gamma](const Mat3X& s) { return mask(gamma.displacement(charts_at(s)).y); };
}

/// The spatial stage: a group around the mean of its fields.
template <LoadsSurfaces Load>
class SpatialGroup {
 public:
  using Fields = std::vector<Eigen::MatrixXd>;
  struct Mean {
    Fields field;  ///< one a time
    double energy = 0, norm = 0;
  };

  SpatialGroup(const Load& load, const GroupTemplate& chosen, const GroupOptions& options)
      : load_(&load), chosen_(&chosen), options_(&options) {
    const RegistrationOptions& r = options.registration;
    require(!r.spatial.levels.empty(), "register_group: no levels, give at least one");
    require(r.spatial.landmarks.size() == 0, "register_group: landmarks belong to one pair of bodies, give none");
    level_ = r.spatial.refinement.empty() ? r.spatial.levels.back() : r.spatial.refinement.back();
  }

  /// The mean of the fields of all members, and how they lie around it.
  Mean mean_of(const std::vector<MovingRegistration>& members) const {
    Mean mean;
    const SpatialOptions spatial = options_of(members);
    Eigen::VectorXd weights;
    fold_members(
        *chosen_, threads(),
        [&](std::size_t i) {
          return with_problem(i, members[i], {}, spatial, [&](const auto& problem) {
            const SphereDisplacement at = members[i].spatial.gamma.displacement(charts_at(problem.points()));
            return std::pair(problem.fields(at.y, members[i].spatial.rotation), problem.quadrature().weights);
          });
        },
        [&](std::size_t, auto result) {
          auto& [fields, w] = result;
          weights = w;
          if (mean.field.empty()) mean.field.assign(fields.size(), Eigen::MatrixXd::Zero(6, weights.size()));
          for (std::size_t t = 0; t < fields.size(); ++t) {
            mean.norm += fields[t].colwise().squaredNorm() * weights;
            mean.field[t] += fields[t] / double(members.size());
          }
        });
    mean.energy = mean.norm;
    for (const auto& g : mean.field)
      mean.energy -= double(members.size()) * g.colwise().squaredNorm().dot(weights.transpose());
    mean.energy = std::max(mean.energy, 0.0);
    return mean;
  }

  /// Every member a step nearer to the mean; one that would come near to a fold stays where it is.
  std::vector<MovingRegistration> step(const std::vector<MovingRegistration>& members, const Fields& mean) const {
    std::vector<MovingRegistration> next = members;
    const SpatialOptions spatial = options_of(members);
    parallel_for(static_cast<int>(members.size()), threads(), [&](int k) {
      const auto i = std::size_t(k);
      SpatialResult& r = next[i].spatial;
      with_problem(i, members[i], mean, spatial, [&](const auto& problem) {
        const SphereDisplacement begin = r.gamma.displacement(charts_at(problem.points()));
        std::vector<SphereVectorField> steps;
        const RefinementState end = problem.minimise(problem.at(begin.y, begin.J, r.rotation), level_.field_degree, 1,
                                                     steps, r.summary.energies);
        for (SphereVectorField& v : steps) r.gamma.append(std::move(v));
        r.rotation = end.O;
        return 0;
      });
      r.summary.min_jacobian = certify(r.gamma).min_jacobian;
      // Between the nodes of the grid the Jacobian is smaller than on them: what is compressed much is not compressed further.
      if (r.summary.min_jacobian < std::min(0.1, members[i].spatial.summary.min_jacobian)) r = members[i].spatial;
    });
    return next;
  }

 private:
  int threads() const { return options_->registration.spatial.threads; }
  SpatialOptions options_of(const std::vector<MovingRegistration>& members) const {
    SpatialOptions spatial = options_->registration.spatial;
    spatial.mask = group_mask(options_->registration, members[chosen_->member].spatial.gamma);
    spatial.threads = 1;
    return spatial;
  }
  template <class Use>
  auto with_problem(std::size_t i, const MovingRegistration& member, const Fields& targets,
                    const SpatialOptions& spatial, const Use& use) const {
    const auto& surface = (*load_)(i);
    const auto clock = [&](double t) { return member.temporal.warp(t); };
    const MovingStack<std::remove_cvref_t<decltype(surface)>, decltype(clock)> stack{
        surface, clock, std::max(1, options_->registration.spatial_times), 1};
    return use(RefinementProblem(targets, 1, stack, level_, spatial));  // of mean area 1
  }

  const Load* load_;
  const GroupTemplate* chosen_;
  const GroupOptions* options_;
  SpatialLevel level_;
};

/// Turns and maps centred; the latter only where all stay free of folds.
/// returns  the mean field of the maps that is left, radians
inline double centre_in_space(std::vector<MovingRegistration>& members, const GroupTemplate& chosen,
                              const GaugeOptions& options, int threads) {
  std::vector<Mat3> turns;
  std::vector<SphereDiffeomorphism> maps;
  for (const std::size_t i : chosen.order) {
    turns.push_back(members[i].spatial.rotation);
    maps.push_back(members[i].spatial.gamma);
  }
  const Mat3 back = karcher_mean(turns).transpose();
  for (auto& member : members) member.spatial.rotation = back * member.spatial.rotation;
  CentredMaps spheres = centred(std::move(maps), options);
  std::vector<double> jacobians(members.size());
  parallel_for(static_cast<int>(members.size()), threads,
               [&](int k) { jacobians[std::size_t(k)] = certify(spheres.maps[std::size_t(k)]).min_jacobian; });
  if (*std::min_element(jacobians.begin(), jacobians.end()) <= 0) return spheres.before;
  for (std::size_t k = 0; k < chosen.order.size(); ++k) {
    SpatialResult& member = members[chosen.order[k]].spatial;
    member.gamma = std::move(spheres.maps[k]);
    member.summary.min_jacobian = jacobians[k];
  }
  return spheres.after;
}

inline void centre_in_time(std::vector<MovingRegistration>& members, const GroupTemplate& chosen) {
  std::vector<TimeWarp> clocks;
  for (const std::size_t i : chosen.order) clocks.push_back(members[i].temporal.warp);
  const TimeWarp clock = inverse(karcher_mean(clocks));
  for (auto& member : members) member.temporal.warp = compose(member.temporal.warp, clock);
}

/// After an iteration: the members first, then the word that they are there.
inline void keep_group(const GroupRegistration& group, const ResultStore& store) {
  const std::string name = message("iteration.", group.summary.energy.size() - 1);
  for (std::size_t i = 0; i < group.members.size(); ++i) {
    Archive archive;
    store_registration(archive, group.members[i]);
    store.keep(message(name, ".", i), archive);
  }
  const GroupSummary& s = group.summary;
  Archive archive;
  archive.set("energy", Eigen::MatrixXd(Eigen::Map<const Eigen::VectorXd>(s.energy.data(), Index(s.energy.size()))));
  archive.set("energy_unregistered", s.energy_unregistered);
  archive.set("gauge", s.gauge);
  archive.set("converged", int(s.converged));
  store.keep(name, archive);
}

/// Goes on after the last iteration that was kept.
/// returns  whether one was
inline bool continue_group(GroupRegistration& group, const ResultStore& store) {
  std::optional<Archive> last;
  std::string name;
  for (int k = 1;; ++k) {
    auto kept = store.find(message("iteration.", k));
    if (!kept) break;
    last = std::move(kept);
    name = message("iteration.", k);
  }
  if (!last) return false;
  for (std::size_t i = 0; i < group.members.size(); ++i) {
    const auto kept = store.find(message(name, ".", i));
    require<FileError>(kept.has_value(), last->name(), ": member ", i,
                       " of that iteration is missing, remove the file");
    group.members[i] = registration_from(*kept);
  }
  const auto& energy = last->get<Eigen::MatrixXd>("energy");
  group.summary.energy.assign(energy.data(), energy.data() + energy.size());
  group.summary.energy_unregistered = last->number("energy_unregistered");
  group.summary.gauge = last->number("gauge");
  group.summary.converged = last->integer("converged", 0, 1) == 1;
  return true;
}

}  // namespace detail

/// Every member's registration to the template, whose own is the identity.
template <LoadsSurfaces Load>
std::vector<MovingRegistration> register_to_template(const Load& load, const GroupTemplate& chosen,
                                                     const TriangleMesh& sphere, const GroupOptions& options = {},
                                                     const ResultStore& store = {}, const Progress& progress = {}) {
  std::vector<MovingRegistration> members(chosen.order.size());
  RegistrationOptions each = options.registration;
  each.spatial.threads = 1;
  each.temporal.alignment = TemporalAlignment::whole;
  std::mutex reporting;
  int done = 0;
  parallel_for(static_cast<int>(members.size()), options.registration.spatial.threads, [&](int k) {
    const auto i = std::size_t(k);
    if (i == chosen.member) return;
    const std::string name = message("registration.", i);
    if (const auto kept = store.find(name)) {
      members[i] = registration_from(*kept);
    } else {
      const auto& first = load(chosen.member);
      const auto& second = load(i);
      members[i] = register_moving(first, second, sphere, each);
      Archive archive;
      store_registration(archive, members[i]);
      store.keep(name, archive);
    }
    const std::lock_guard lock(reporting);
    report(progress, "registration to the template", double(++done) / double(members.size()));
  });
  return members;
}

/// sphere   unit vertices and triangles on which the template and the others are compared in time
/// returns  registrations with energies that never rise, centred
/// accuracy copies of one motion, warped and turned, come together to a thousandth of its size; another order of the members
///          gives the same [stats/group_registration_test]
template <LoadsSurfaces Load>
GroupRegistration register_group(const Load& load, const GroupTemplate& chosen, const TriangleMesh& sphere,
                                 const GroupOptions& options = {}, const ResultStore& store = {},
                                 const Progress& progress = {}) {
  GroupRegistration group{chosen, register_to_template(load, chosen, sphere, options, store, progress), {}};
  GroupSummary& summary = group.summary;
  const detail::SpatialGroup<Load> space(load, chosen, options);
  if (!detail::continue_group(group, store)) {
    summary.energy_unregistered = space.mean_of(std::vector<MovingRegistration>(group.members.size())).energy;
    detail::centre_in_time(group.members, chosen);
    summary.gauge = detail::centre_in_space(group.members, chosen, options.gauge, options.registration.spatial.threads);
  }
  auto mean = space.mean_of(group.members);
  if (summary.energy.empty()) summary.energy.push_back(mean.energy);
  while (int(summary.energy.size()) <= options.iterations && !summary.converged) {
    report(progress, "registration to the mean", double(summary.energy.size() - 1) / options.iterations);
    std::vector<MovingRegistration> next = space.step(group.members, mean.field);
    const double gauge = detail::centre_in_space(next, chosen, options.gauge, options.registration.spatial.threads);
    auto next_mean = space.mean_of(next);
    const double gain = mean.energy - next_mean.energy;
    summary.converged = gain <= options.tolerance * mean.energy + options.least * summary.energy_unregistered;
    if (gain > 0) {
      group.members = std::move(next);
      mean = std::move(next_mean);
      summary.gauge = gauge;
    }
    summary.energy.push_back(mean.energy);
    detail::keep_group(group, store);
  }
  summary.norm = mean.norm;
  for (const auto& member : group.members)
    summary.min_jacobian = std::min(summary.min_jacobian, member.spatial.summary.min_jacobian);
  report(progress, "registration to the mean", 1);
  return group;
}

}  // namespace dsns
