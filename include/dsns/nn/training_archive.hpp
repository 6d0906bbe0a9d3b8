#pragma once
/// Trainings to and from archives, so that a fit that was stopped goes on to the result it would have had.
#include <dsns/core/archive.hpp>
#include <dsns/nn/encodings.hpp>
#include <dsns/nn/trainer.hpp>

#include <functional>

namespace dsns {

/// When a fit hands out what it needs to go on, and where it goes on from.
struct CheckpointOptions {
  /// Called before the first step, then about every `every` seconds, and after the last step. The archive holds the surface
  /// learnt so far, see surface_from, and the state of the training. What is learnt does not depend on when it is called.
  std::function<void(const Archive&)> write = {};
  double every = 10;
  /// A checkpoint of the same fit: the same options (threads and target_msd may differ) and target. Must outlive the call.
  const Archive* resume = nullptr;
};

namespace detail {

/// What a fit is one of: two fits with the same identity take the same steps.
struct FitIdentity {
  std::vector<std::pair<std::string, double>> options;
  std::uint64_t target = 0;  ///< checksum of what is learnt

  void add(std::string name, double value) { options.emplace_back(std::move(name), value); }
};

inline void identify(FitIdentity& id, const SurfaceEncoding& e) {
  id.add("harmonics of the encoding", e.harmonic_degree);
  id.add("harmonic decay of the encoding", e.harmonic_decay);
  id.add("space octaves", e.space_octaves);
  id.add("space base", e.space_base);
  id.add("time frequencies", e.time_frequencies);
  id.add("time octaves", e.time_octaves);
  id.add("time base", e.time_base);
}

inline void identify(FitIdentity& id, const OptimizerOptions& o) {
  id.add("optimiser", static_cast<double>(o.kind));
  switch (o.kind) {
    case OptimizerKind::rmsprop:
      id.add("decay", o.rmsprop.decay);
      id.add("momentum", o.rmsprop.momentum);
      id.add("epsilon", o.rmsprop.epsilon);
      break;
    case OptimizerKind::adam:
      id.add("beta1", o.adam.beta1);
      id.add("beta2", o.adam.beta2);
      id.add("epsilon", o.adam.epsilon);
      id.add("weight decay", o.adam.weight_decay);
      break;
    case OptimizerKind::soap:
      id.add("beta1", o.soap.beta1);
      id.add("beta2", o.soap.beta2);
      id.add("factor decay", o.soap.factor_decay);
      id.add("epsilon", o.soap.epsilon);
      id.add("weight decay", o.soap.weight_decay);
      id.add("refresh", o.soap.refresh);
      id.add("largest dimension", double(o.soap.max_dimension));
  }
}

inline void identify_seed(FitIdentity& id, std::uint64_t seed) {  // a double holds half of it
  id.add("seed", double(seed & 0xffffffffu));
  id.add("seed's upper half", double(seed >> 32));
}

/// Checksum of a matrix on top of another's.
template <class M>
std::uint64_t checksum_of(const M& m, std::uint64_t before) {
  return xxh64({reinterpret_cast<const char*>(m.data()), std::size_t(m.size()) * sizeof(typename M::Scalar)}, before);
}

/// How far a training is, beside its trainer.
struct TrainingProgress {
  double seconds = 0, cpu_seconds = 0;
  double budget = 0;       ///< seconds for all steps; 0: no limit
  double window_loss = 0;  ///< of the stretch of steps that is not complete
  std::vector<double> loss;
};

template <class T, class Problem>
void store_training(Archive& archive, const FitIdentity& id, const Trainer<T, Problem>& trainer,
                    const TrainingProgress& progress) {
  std::string names;
  Eigen::MatrixXd values(Index(id.options.size()), 1);
  for (std::size_t k = 0; k < id.options.size(); ++k) {
    names += id.options[k].first + '\n';
    values(Index(k)) = id.options[k].second;
  }
  archive.set("training.options", names);
  archive.set("training.option_values", values);
  archive.set("training.target", id.target);
  archive.set("training.steps", trainer.steps());
  archive.set("training.seconds", progress.seconds);
  archive.set("training.cpu_seconds", progress.cpu_seconds);
  archive.set("training.budget", progress.budget);
  archive.set("training.window_loss", progress.window_loss);
  archive.set("training.loss",
              Eigen::MatrixXd(Eigen::MatrixXd::Map(progress.loss.data(), Index(progress.loss.size()), 1)));
  archive.set("training.parameters", Eigen::MatrixX<T>(trainer.network().parameters()));
  archive.set("optimizer.steps", trainer.optimizer_state().steps);
  for (const auto& array : trainer.optimizer_state().arrays)
    archive.set("optimizer." + array.name, Eigen::MatrixX<T>(array.values));
}

inline void require_same_fit(const Archive& archive, const FitIdentity& id) {
  std::string_view names = archive.text("training.options");
  const auto& values = archive.get<Eigen::MatrixXd>("training.option_values");
  for (Index k = 0; k < Index(id.options.size()); ++k) {
    const auto& [name, wanted] = id.options[std::size_t(k)];
    const std::string_view found = names.substr(0, names.find('\n'));
    names.remove_prefix(std::min(found.size() + 1, names.size()));
    require(found == name && k < values.size(), archive.name(), " is of another kind of fit: it says '", found,
            "' where this one has '", name, "'; fit anew");
    require(values(k) == wanted, archive.name(), " is of another fit: '", name, "' is ", values(k), " there and ",
            wanted, " here; fit with the same options, or anew");
  }
  require(archive.integer("training.target") == static_cast<std::int64_t>(id.target), archive.name(),
          " is of a fit to another surface, or its samples were computed elsewhere: fit anew");
}

/// Puts the trainer where the archive's stood.
/// throws   InvalidArgument where the archive is of another fit, FileError where it holds none
template <class T, class Problem>
TrainingProgress resume_training(const Archive& archive, const FitIdentity& id, Trainer<T, Problem>& trainer) {
  require_same_fit(archive, id);
  OptimizerState<T> state = trainer.optimizer_state();
  state.steps = archive.integer("optimizer.steps", 0);
  for (auto& array : state.arrays)
    array.values = archive.get<Eigen::MatrixX<T>>("optimizer." + array.name, array.values.size(), 1).array();
  const Index parameters = trainer.network().parameters().size();
  trainer.restore(archive.get<Eigen::MatrixX<T>>("training.parameters", parameters, 1), std::move(state),
                  archive.integer("training.steps", 0, std::numeric_limits<int>::max()));
  TrainingProgress progress{archive.number("training.seconds"),
                            archive.number("training.cpu_seconds"),
                            archive.number("training.budget"),
                            archive.number("training.window_loss"),
                            {}};
  const auto& loss = archive.get<Eigen::MatrixXd>("training.loss");
  progress.loss.assign(loss.data(), loss.data() + loss.size());
  for (const double x : {progress.seconds, progress.cpu_seconds, progress.budget})
    require<FileError>(x >= 0 && x < 1e9, archive.name(), ": a training of ", x, " seconds");
  return progress;
}

}  // namespace detail
}  // namespace dsns
