#include "catch.hpp"
#include "support/temporary_folder.hpp"

#include <dsns/io/state_dict_file.hpp>
#include <dsns/nn/state_dict.hpp>

#include <array>

namespace state_dict_test {

using namespace dsns;

namespace {

/// The reference network written down again, as loops over plain arrays.
struct Reference {
  int octaves = 3, width = 5, blocks = 6;
  EmbeddingOrder order = EmbeddingOrder::by_coordinate;
  std::vector<Eigen::MatrixXd> weights;
  std::vector<Eigen::VectorXd> biases;

  explicit Reference(EmbeddingOrder o, int b = 6) : blocks(b), order(o) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> uniform(-0.5, 0.5);
    for (int l = 0; l < 2 + 2 * blocks; ++l) {
      const int rows = l == 1 + 2 * blocks ? 3 : width, cols = l == 0 ? 8 * octaves : width;
      Eigen::MatrixXd w(rows, cols);
      for (double& x : w.reshaped()) x = uniform(random);
      weights.push_back(w);
      Eigen::VectorXd v(rows);
      for (double& x : v) x = uniform(random);
      biases.push_back(v);
    }
  }

  std::vector<double> embedded(const std::array<double, 4>& x) const {
    std::vector<std::vector<double>> groups;
    if (order == EmbeddingOrder::by_coordinate) groups = {{x[0]}, {x[1]}, {x[2]}, {x[3]}};
    if (order == EmbeddingOrder::space_then_time) groups = {{x[0], x[1], x[2]}, {x[3]}};
    if (order == EmbeddingOrder::all_together) groups = {{x[0], x[1], x[2], x[3]}};
    std::vector<double> out;
    for (const auto& group : groups) {
      for (const double c : group)
        for (int k = 0; k < octaves; ++k) out.push_back(std::sin(c * 0.1 * std::pow(2.0, k)));
      for (const double c : group)
        for (int k = 0; k < octaves; ++k) out.push_back(std::cos(c * 0.1 * std::pow(2.0, k)));
    }
    return out;
  }
  std::vector<double> layer(std::size_t l, const std::vector<double>& x) const {
    std::vector<double> y;
    for (int i = 0; i < weights[l].rows(); ++i) {
      double sum = biases[l][i];
      for (int j = 0; j < weights[l].cols(); ++j) sum += weights[l](i, j) * x[std::size_t(j)];
      y.push_back(sum);
    }
    return y;
  }
  static std::vector<double> softplus_of(std::vector<double> x) {
    for (double& v : x) v = std::log(1 + std::exp(v));
    return x;
  }
  Vec3d operator()(const std::array<double, 4>& x) const {
    std::vector<double> y = softplus_of(layer(0, embedded(x)));
    for (std::size_t b = 0; b < std::size_t(blocks); ++b) {
      std::vector<double> z = layer(2 + 2 * b, softplus_of(layer(1 + 2 * b, y)));
      for (std::size_t i = 0; i < z.size(); ++i) z[i] += y[i];
      y = softplus_of(z);
    }
    const std::vector<double> p = layer(weights.size() - 1, y);
    return {p[0], p[1], p[2]};
  }

  /// The names are such that their alphabetical order is not that of the layers.
  std::string name(std::size_t l) const {
    if (l == 0) return "start";
    if (l + 1 == weights.size()) return "head";
    return "residual." + std::to_string((l - 1) / 2 + 5) + ".fc" + std::to_string(1 + (l - 1) % 2);
  }
  Archive dict() const {
    Archive d("weights.npz");
    for (std::size_t l = 0; l < weights.size(); ++l) {
      d.set(name(l) + ".weight", weights[l]);
      d.set(name(l) + ".bias", Eigen::MatrixXd(biases[l]));
    }
    Eigen::MatrixXd frequencies(octaves, 1);
    for (int k = 0; k < octaves; ++k) frequencies(k) = double(0.1f) * std::pow(2.0, k);
    d.set("embedding.frequencies", frequencies);
    return d;
  }
  Archive with_probe() const {
    Archive d = dict();
    Eigen::MatrixXd inputs = 2 * Eigen::MatrixXd::Random(4, 4), outputs(4, 3);
    for (int i = 0; i < 4; ++i)
      outputs.row(i) = (*this)({inputs(i, 0), inputs(i, 1), inputs(i, 2), inputs(i, 3)}).transpose();
    d.set("probe.inputs", inputs);
    d.set("probe.outputs", outputs);
    return d;
  }
};

template <class T>
double largest_error(const Reference& reference, const BasicNeuralSurface<T>& surface) {
  const Mat3X s = Mat3X(Mat3X::Random(3, 5)).colwise().normalized();
  double error = 0;
  for (const double t : {0.0, 0.3, 1.0}) {
    const Mat3X p = surface.positions(s, t);
    for (Index i = 0; i < s.cols(); ++i) {
      const Vec3d wanted = Vec3d(1, 2, 3) + 1.5 * reference({s(0, i), s(1, i), s(2, i), t});
      error = std::max(error, (p.col(i) - wanted).cwiseAbs().maxCoeff());
    }
  }
  return error;
}

std::string said(const Archive& dict, const StateDictOptions& options = {}) {
  const std::string s = test::complaint<FileError>([&] { import_state_dict(dict, options); });
  CHECK(test::is_one_sentence(s));
  CHECK(s.rfind("weights.npz", 0) == 0);
  return s;
}

}  // namespace

TEST_CASE("state dict: the imported network is the reference's, in every order of the embedding", "[nn]") {
  const auto order =
      GENERATE(EmbeddingOrder::by_coordinate, EmbeddingOrder::space_then_time, EmbeddingOrder::all_together);
  const Reference reference(order);
  StateDictOptions options;
  options.translation = Vec3d(1, 2, 3);
  options.scale = 1.5;
  CHECK(largest_error(reference, import_state_dict<double>(reference.with_probe(), options)) < 1e-12);
  CHECK(largest_error(reference, import_state_dict<float>(reference.with_probe(), options)) < 1e-5);
  options.order = order;
  CHECK(largest_error(reference, import_state_dict<double>(reference.dict(), options)) < 1e-12);
  if (order != EmbeddingOrder::by_coordinate) {
    options.order.reset();
    CHECK(largest_error(reference, import_state_dict<double>(reference.dict(), options)) > 1e-3);
    options.order = EmbeddingOrder::by_coordinate;
    CHECK(said(reference.with_probe(), options).find("'probe.outputs'") != std::string::npos);
  }
}

TEST_CASE("state dict: layers can be named, and must where shapes leave them open", "[nn]") {
  Reference square(EmbeddingOrder::by_coordinate, 1);  // as wide as the encoding
  square.octaves = 1;
  square.width = 8;
  square.weights = {Eigen::MatrixXd::Random(8, 8), Eigen::MatrixXd::Random(8, 8), Eigen::MatrixXd::Random(8, 8),
                    Eigen::MatrixXd::Random(3, 8)};
  square.biases = {Eigen::VectorXd::Random(8), Eigen::VectorXd::Random(8), Eigen::VectorXd::Random(8),
                   Eigen::VectorXd::Random(3)};
  StateDictOptions options;
  options.translation = Vec3d(1, 2, 3);
  options.scale = 1.5;
  CHECK(said(square.dict(), options).find("name the layers") != std::string::npos);
  options.layers = {"start", "residual.5.fc1", "residual.5.fc2", "head"};
  CHECK(largest_error(square, import_state_dict<double>(square.dict(), options)) < 1e-12);
  options.layers = {"start", "head"};
  CHECK(said(square.dict(), options).find("4 layers, 2 are named") != std::string::npos);
  options.layers = {"start", "residual.5.fc1", "residual.5.fc2", "tail"};
  CHECK(said(square.dict(), options).find("no 'tail.weight'") != std::string::npos);
}

TEST_CASE("state dict: what is not the reference network is refused with one sentence", "[nn]") {
  const Reference reference(EmbeddingOrder::by_coordinate, 1);
  const auto with = [&](const std::string& array, const Eigen::MatrixXd& value) {
    Archive d = reference.dict();
    d.set(array, value);
    return said(d);
  };
  CHECK(with("norm.running_mean", Eigen::MatrixXd(5, 1)).find("belongs to no layer") != std::string::npos);
  with("norm.weight", Eigen::MatrixXd::Ones(5, 1));
  with("extra.weight", Eigen::MatrixXd::Ones(5, 5));
  with("start.weight", Eigen::MatrixXd::Ones(5, 23));
  with("start.weight", Eigen::MatrixXd::Ones(6, 24));
  with("start.bias", Eigen::MatrixXd::Ones(4, 1));
  with("head.weight", Eigen::MatrixXd::Ones(2, 5));
  with("residual.5.fc1.weight", Eigen::MatrixXd::Ones(3, 5));
  with("residual.5.fc1.bias", Eigen::MatrixXd::Constant(5, 1, std::nan("")));
  with("embedding.frequencies", Eigen::MatrixXd::Constant(3, 1, 1));
  with("probe.inputs", Eigen::MatrixXd::Ones(2, 3));
  CHECK(said(Archive("weights.npz")).find("no layer") != std::string::npos);
}

TEST_CASE("state dict: a file from PyTorch has PyTorch's values and derivatives", "[nn]") {
  const auto file = std::filesystem::path(__FILE__).parent_path() / "pytorch_network.npz";  // by pytorch_network.py
  const auto network = import_state_dict<double>(read_state_dict(file));
  const Vec3d value(0.6421155792999311, 0.9715410448413864, 0.9860258546831555);
  Eigen::Matrix<double, 3, 4> jacobian;
  jacobian << 1.5001555086110092, -0.034455030048596166, 0.05707895503210171, 0.029703996441356698, -0.0390964306513981,
      1.4921890753641882, -0.0044120164527082836, -0.027362228928140345, 0.033724487596608954, -0.012739023144898703,
      1.4398768346229278, 0.01558844839133714;
  const ChartBatch charts = charts_at(Vec3d(0.48, 0.6, 0.64));
  const MotionJets ours = motion_jets(network, charts, 0.3);
  const double accuracy = 1e-7;  // PyTorch has the frequencies in single precision
  CHECK((ours.f - value).norm() < accuracy);
  CHECK((ours.fu - jacobian.leftCols(3) * charts.e1).norm() < accuracy);
  CHECK((ours.fv - jacobian.leftCols(3) * charts.e2).norm() < accuracy);
  CHECK((ours.ft - jacobian.col(3)).norm() < accuracy);
}

}  // namespace state_dict_test
