#include "catch.hpp"
#include "support/sphere_points.hpp"
#include "support/temporary_folder.hpp"

#include <dsns/nn/surface_archive.hpp>

namespace surface_archive_test {

using namespace dsns;

namespace {

/// Every member differs from its default.
SurfaceEncoding unusual(int time) {
  return {.harmonic_degree = 3,
          .harmonic_decay = 0.7,
          .space_octaves = 2,
          .space_base = 0.3,
          .time_frequencies = time,
          .time_octaves = time,
          .time_base = 0.2};
}

template <class T>
BasicNeuralSurface<T> neural(Activation activation = Activation::tanh) {
  const SurfaceEncoding encoding = unusual(2);
  return {encoding, Mlp<T>({static_cast<int>(encoding.features()), 5, 1, 3, activation}, 7), Vec3d(1, 2, 0.1), 1.7};
}

template <class T>
BasicSeparableSurface<T> separable() {
  const SurfaceEncoding encoding = unusual(0);
  return {TemporalModes(Eigen::MatrixXd::Random(6, 2)),
          Eigen::MatrixXd::Random(9, 6),
          encoding,
          Mlp<T>({static_cast<int>(encoding.features()), 4, 2, 6, Activation::sine}, 7),
          Vec3d(1, 2, 0.1),
          1.7};
}

template <class S>
Archive stored(const S& surface) {
  Archive archive;
  store_surface(archive, surface);
  return parse_archive(to_bytes(archive), "walk.dsns");
}

const Mat3X points = Mat3X(Mat3X::Random(3, 9)).colwise().normalized();

template <class S>
void check_same(const S& surface) {
  const Archive archive = stored(surface);
  for (const double t : {0.0, 0.37, 1.0}) {
    CHECK(surface_from<S>(archive).positions(points, t) == surface.positions(points, t));
    CHECK(surface_from(archive).positions(points, t) == surface.positions(points, t));
  }
  CHECK(to_bytes(stored(surface_from<S>(archive))) == to_bytes(archive));
}

std::string said(const std::string& array, const Archive::Value& value, const Archive& good) {
  Archive archive = good;
  archive.set(array, value);
  const std::string s = test::complaint<FileError>([&] { surface_from(archive); });
  CAPTURE(array);
  CHECK(test::is_one_sentence(s));
  CHECK(s.rfind("walk.dsns", 0) == 0);
  return s;
}

Archive::Value integer(std::int64_t x) { return Archive::Integers(Archive::Integers::Constant(1, 1, x)); }

}  // namespace

TEST_CASE("surface archive: surfaces of all kinds come back to the bit", "[nn]") {
  check_same(neural<float>());
  check_same(neural<double>());
  check_same(separable<float>());
  check_same(separable<double>());
  for (const Activation a : {Activation::softplus, Activation::silu, Activation::sine}) check_same(neural<double>(a));
  const SeparableSurface s = separable<double>();
  check_same(SeparableSurface(s.time(), s.harmonics(), s.encoding(), {}, s.translation(), s.scale()));
  check_same(SeparableSurface(s.time(), Eigen::MatrixXd(0, 6), s.encoding(), s.network()));
}

TEST_CASE("surface archive: another kind or precision than asked for is refused", "[nn]") {
  CHECK_THROWS_AS(surface_from<NeuralSurface>(stored(separable<double>())), FileError);
  CHECK_THROWS_AS(surface_from<SeparableSurface>(stored(neural<double>())), FileError);
  CHECK_THROWS_AS(surface_from<NeuralSurface>(stored(neural<float>())), FileError);
  CHECK_THROWS_AS(surface_from(Archive("walk.dsns")), FileError);
}

TEST_CASE("surface archive: what a reader does not know is left alone", "[nn]") {
  Archive archive = stored(neural<double>());
  archive.set("weather", std::string("rain"));
  CHECK(surface_from(archive).positions(points, 0.3) == neural<double>().positions(points, 0.3));
}

TEST_CASE("surface archive: arrays that do not fit together are refused with one sentence", "[nn]") {
  const Archive network = stored(neural<double>()), modes = stored(separable<double>());
  said("surface", std::string("splines"), network);
  said("network.width", integer(6), network);
  said("network.width", integer(std::numeric_limits<std::int64_t>::max()), network);
  said("network.width", integer(100000), network);
  said("network.blocks", integer(-1), network);
  said("network.blocks", integer(1000), network);
  said("network.outputs", integer(4), network);
  said("network.activation", std::string("relu"), network);
  said("network.parameters", Eigen::MatrixXd(Eigen::MatrixXd::Zero(1, 1)), network);
  said("encoding.harmonic_degree", integer(1000), network);
  said("encoding.time_octaves", integer(1 << 30), network);
  said("scale", Eigen::MatrixXd(Eigen::MatrixXd::Constant(1, 1, std::nan(""))), network);
  said("translation", Eigen::MatrixXd(Eigen::MatrixXd::Zero(1, 3)), network);
  Eigen::MatrixXd broken = network.get<Eigen::MatrixXd>("network.parameters");
  broken(3) = std::nan("");
  said("network.parameters", broken, network);
  said("modes", Eigen::MatrixXd(Eigen::MatrixXd::Zero(6, 3)), modes);
  said("modes", Eigen::MatrixXd(0, 2), modes);
  said("modes", Eigen::MatrixXd(Eigen::MatrixXd::Zero(10001, 2)), modes);
  said("harmonics", Eigen::MatrixXd(Eigen::MatrixXd::Zero(8, 6)), modes);
  said("harmonics", Eigen::MatrixXd(Eigen::MatrixXd::Zero(9, 5)), modes);
  said("encoding.time_frequencies", integer(1), modes);
}

}  // namespace surface_archive_test
