#pragma once
/// Networks that PyTorch trained, in the reference's architecture: sines and cosines of 0.1 2^k x of each of x, y, z and t,
/// a linear layer, residual blocks a(W2 a(W1 y + b1) + b2 + y), a linear layer to three coordinates.
///
///   const auto surface = import_state_dict(read_state_dict("weights.npz"));
#include <dsns/core/archive.hpp>
#include <dsns/core/natural_order.hpp>
#include <dsns/nn/neural_surface.hpp>

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace dsns {

/// Which coordinates are embedded together: a group's features are the sines of its coordinates (of the first all
/// frequencies, of the second ...), then their cosines; groups follow one another.
enum class EmbeddingOrder { by_coordinate, space_then_time, all_together };

struct StateDictOptions {
  /// Empty: the one with which the network gives "probe.outputs" (n x 3) at "probe.inputs" (n x 4) if these are there, else
  /// by_coordinate.
  std::optional<EmbeddingOrder> order = {};
  /// The layers in the order of evaluation, names without ".weight". Empty: found by shapes, the hidden ones in the order
  /// of their names, numbers in them compared as numbers.
  std::vector<std::string> layers = {};
  Activation activation = Activation::softplus;
  Vec3d translation = Vec3d::Zero();  ///< of the surface: F = translation + scale * network
  double scale = 1;
};

namespace detail {

/// The layers of a state dict in the order of evaluation, each a matrix and an offset.
class StateDictLayers {
 public:
  StateDictLayers(const Archive& dict, const StateDictOptions& options) : dict_(&dict), names_(options.layers) {
    const bool named = !names_.empty();
    std::size_t weights = 0;
    for (const auto& [array, value] : dict.arrays()) {
      if (const auto layer = without(array, ".weight")) {
        ++weights;
        if (!named) names_.push_back(*layer);
      }
      const bool belongs = without(array, ".weight") || without(array, ".bias") || without(array, "frequencies") ||
                           array == "probe.inputs" || array == "probe.outputs";
      require<FileError>(belongs, dict.name(), ": '", array, "' belongs to no layer of the reference network");
    }
    require<FileError>(weights == names_.size(), dict.name(), " has ", weights, " layers, ", names_.size(),
                       " are named");
    if (!named) sort();
    check();
  }

  Index count() const { return Index(names_.size()); }
  const Eigen::MatrixXd& weight(Index l) const { return matrix(names_[std::size_t(l)], ".weight"); }
  const Eigen::MatrixXd& bias(Index l) const { return matrix(names_[std::size_t(l)], ".bias"); }

 private:
  static std::optional<std::string> without(const std::string& name, std::string_view ending) {
    if (name.size() < ending.size() || name.substr(name.size() - ending.size()) != ending) return {};
    return name.substr(0, name.size() - ending.size());
  }
  const Eigen::MatrixXd& matrix(const std::string& layer, const char* part) const {
    return dict_->get<Eigen::MatrixXd>(layer + part);
  }

  void sort() {
    std::sort(names_.begin(), names_.end(), natural_less);
    const auto only = [&](const char* what, auto condition) {
      const auto found = std::find_if(names_.begin(), names_.end(), condition);
      require<FileError>(found != names_.end() && std::find_if(found + 1, names_.end(), condition) == names_.end(),
                         dict_->name(), ": no layer, or not one alone, is ", what, "; name the layers in their order");
      return found;
    };
    const auto last =
        only("the one to 3 coordinates", [&](const std::string& n) { return matrix(n, ".weight").rows() == 3; });
    std::rotate(last, last + 1, names_.end());
    const Index width = weight(count() - 1).cols();
    const auto first = only("the one of the features", [&](const std::string& n) {
      return n != names_.back() && matrix(n, ".weight").cols() != width;
    });
    std::rotate(names_.begin(), first, first + 1);
  }

  void check() const {
    require<FileError>(count() >= 2 && count() % 2 == 0, dict_->name(), " has ", count(),
                       " layers, wanted were the first, two a block, and the last");
    for (Index l = 0; l < count(); ++l) {
      const Index rows = l + 1 == count() ? 3 : weight(0).rows(), cols = l == 0 ? weight(0).cols() : weight(0).rows();
      const auto& w = dict_->get<Eigen::MatrixXd>(names_[std::size_t(l)] + ".weight", rows, cols);
      const auto& b = dict_->get<Eigen::MatrixXd>(names_[std::size_t(l)] + ".bias", rows, 1);
      require<FileError>(w.allFinite() && b.allFinite(), dict_->name(), ": '", names_[std::size_t(l)],
                         "' has numbers that are not finite");
    }
    require<FileError>(weight(0).cols() > 0 && weight(0).cols() % 8 == 0 && weight(0).cols() <= 8000, dict_->name(),
                       ": the first layer has ", weight(0).cols(),
                       " features, wanted were a sine and a cosine of each frequency for x, y, z and t");
    require<FileError>(weight(0).rows() > 0, dict_->name(), ": the first layer is empty");
    for (const auto& [array, value] : dict_->arrays()) {
      if (!without(array, "frequencies")) continue;
      const Index octaves = weight(0).cols() / 8;
      Eigen::ArrayXd ours(octaves);
      for (Index k = 0; k < octaves; ++k) ours[k] = std::ldexp(0.1, int(k));
      const auto& theirs = dict_->get<Eigen::MatrixXd>(array).reshaped();
      require<FileError>(theirs.size() == octaves && ((theirs.array() - ours).abs() <= 1e-5 * ours).all(),
                         dict_->name(), ": '", array, "' are not the ", octaves, " frequencies 0.1 2^k");
    }
  }

  const Archive* dict_;
  std::vector<std::string> names_;
};

/// For each of our features the column of the same one in an order.
inline std::vector<Index> embedding_columns(EmbeddingOrder order, Index octaves) {
  struct Group {
    Index first, size;
  };
  const auto group_of = [&](Index coordinate) {
    if (order == EmbeddingOrder::all_together) return Group{0, 4};
    if (order == EmbeddingOrder::space_then_time && coordinate < 3) return Group{0, 3};
    return Group{coordinate, 1};
  };
  std::vector<Index> columns;
  const auto append = [&](Index octave, Index coordinate) {
    const auto [first, size] = group_of(coordinate);
    const Index sine = 2 * octaves * first + (coordinate - first) * octaves + octave;
    columns.push_back(sine);
    columns.push_back(sine + size * octaves);
  };
  for (Index k = 0; k < octaves; ++k)
    for (Index coordinate = 0; coordinate < 3; ++coordinate) append(k, coordinate);
  for (Index k = 0; k < octaves; ++k) append(k, 3);
  return columns;
}

template <class T>
BasicNeuralSurface<T> surface_of(const StateDictLayers& layers, EmbeddingOrder order, const StateDictOptions& options) {
  const Index features = layers.weight(0).cols();
  SurfaceEncoding encoding = paper_encoding();
  encoding.space_octaves = encoding.time_octaves = static_cast<int>(features / 8);
  const MlpShape shape{static_cast<int>(features), static_cast<int>(layers.weight(0).rows()),
                       static_cast<int>(layers.count() / 2 - 1), 3, options.activation};
  Eigen::VectorX<T> parameters(shape.parameter_count());
  for (int l = 0; l < shape.layers(); ++l) {
    Eigen::Map<Eigen::MatrixX<T>> all(parameters.data() + shape.offset(l), shape.rows(l), shape.cols(l) + 1);
    if (l == 0)
      all.leftCols(features) = layers.weight(0)(Eigen::all, embedding_columns(order, features / 8)).template cast<T>();
    else
      all.leftCols(shape.cols(l)) = layers.weight(l).template cast<T>();
    all.rightCols(1) = layers.bias(l).template cast<T>();
  }
  return {encoding, Mlp<T>(shape, std::move(parameters)), options.translation, options.scale};
}

/// Whether the network gives the probe's outputs, to 1e-4 of the largest: single precision.
template <class T>
bool passes_probe(const BasicNeuralSurface<T>& surface, const Eigen::MatrixXd& inputs, const Eigen::MatrixXd& outputs) {
  double error = 0;
  for (Index i = 0; i < inputs.rows(); ++i) {
    const Vec3d s = inputs.row(i).head<3>(), wanted = outputs.row(i);
    const Vec3d got = (surface(s, inputs(i, 3)) - surface.translation()) / surface.scale();
    error = std::max(error, (got - wanted).cwiseAbs().maxCoeff());
  }
  return error <= 1e-4 * outputs.cwiseAbs().maxCoeff();
}

}  // namespace detail

/// accuracy 1e-12 against loops over the layers in double precision [nn/state_dict_test]
/// throws   FileError where names, shapes or the probe do not fit the reference network
template <class T = float>
BasicNeuralSurface<T> import_state_dict(const Archive& dict, const StateDictOptions& options = {}) {
  require(options.scale > 0, "import_state_dict: a scale of ", options.scale, ", give a positive one");
  const detail::StateDictLayers layers(dict, options);
  if (!dict.contains("probe.inputs"))
    return detail::surface_of<T>(layers, options.order.value_or(EmbeddingOrder::by_coordinate), options);
  const auto& inputs = dict.get<Eigen::MatrixXd>("probe.inputs");
  const auto& outputs = dict.get<Eigen::MatrixXd>("probe.outputs", inputs.rows(), 3);
  require<FileError>(inputs.rows() > 0 && inputs.cols() == 4, dict.name(), ": 'probe.inputs' is ", inputs.rows(), " x ",
                     inputs.cols(), ", wanted were rows of x, y, z, t");
  for (const EmbeddingOrder order :
       {EmbeddingOrder::by_coordinate, EmbeddingOrder::space_then_time, EmbeddingOrder::all_together}) {
    if (options.order.value_or(order) != order) continue;
    const auto surface = detail::surface_of<T>(layers, order, options);
    if (detail::passes_probe(surface, inputs, outputs)) return surface;
  }
  fail<FileError>(dict.name(),
                  ": the network does not give 'probe.outputs' at 'probe.inputs': its embedding, activation "
                  "or blocks are not those of the reference");
}

}  // namespace dsns
