#include <dsns/io/archive_file.hpp>
#include <dsns/mesh/sphere_map_archive.hpp>

#include "catch.hpp"
#include "support/sphere_points.hpp"
#include "support/sphere_warps.hpp"
#include "support/temporary_folder.hpp"

namespace sphere_map_archive_test {

using namespace dsns;

namespace {

SphereDiffeomorphism smooth() { return test::turned_warp(4, 5, 9, Vec3d(1, 0.3, -0.5)); }
PiecewiseLinearDiffeomorphism linear() { return piecewise_linear(smooth(), icosphere(3)).map; }

template <class G>
Archive stored(const G& gamma) {
  Archive archive;
  store_sphere_map(archive, gamma);
  return parse_archive(to_bytes(archive), "gamma.dsns");
}

template <class G>
void check_same(const G& gamma) {
  const Mat3X s = test::sphere_points();
  const test::TemporaryFolder folder;
  Archive archive;
  store_sphere_map(archive, gamma);
  write_archive(folder / "gamma.dsns", archive);
  const G read = sphere_map_from<G>(read_archive(folder / "gamma.dsns"));
  CHECK(read(s) == gamma(s));
  CHECK(read.inverse(s) == gamma.inverse(s));
  CHECK(to_bytes(stored(read)) == to_bytes(archive));

  const std::string bytes = test::contents(folder / "gamma.dsns");
  for (const std::size_t size : {std::size_t(0), std::size_t(40), bytes.size() / 2, bytes.size() - 1})
    CHECK_THROWS_AS(read_archive(folder.write("short.dsns", bytes.substr(0, size))), FileError);
  std::string damaged = bytes;
  damaged[bytes.size() / 2] = static_cast<char>(damaged[bytes.size() / 2] ^ 1);
  CHECK_THROWS_AS(read_archive(folder.write("damaged.dsns", damaged)), FileError);
}

template <class G>
void refused(const std::string& array, const Archive::Value& value, const Archive& good) {
  Archive archive = good;
  archive.set(array, value);
  const std::string said = test::complaint<FileError>([&] { sphere_map_from<G>(archive); });
  CAPTURE(array, said);
  CHECK(test::is_one_sentence(said));
  CHECK(said.rfind("gamma.dsns", 0) == 0);
}

}  // namespace

TEST_CASE("sphere map archive: both models come back to the bit, from whole files only", "[mesh]") {
  check_same(smooth());
  check_same(inverted(smooth()));
  check_same(SphereDiffeomorphism());
  check_same(linear());
  check_same(PiecewiseLinearDiffeomorphism(latitude_longitude_sphere(5, 8)));
}

TEST_CASE("sphere map archive: the other model is refused, and no map", "[mesh]") {
  CHECK_THROWS_AS(sphere_map_from<PiecewiseLinearDiffeomorphism>(stored(smooth())), FileError);
  CHECK_THROWS_AS(sphere_map_from<SphereDiffeomorphism>(stored(linear())), FileError);
  CHECK_THROWS_AS(sphere_map_from<SphereDiffeomorphism>(Archive("gamma.dsns")), FileError);
}

TEST_CASE("sphere map archive: arrays that make no diffeomorphism are refused with one sentence", "[mesh]") {
  const Archive exponentials = stored(smooth()), triangles = stored(linear());
  const auto number = [](std::int64_t x) -> Archive::Value {
    return Archive::Integers(Archive::Integers::Constant(1, 1, x));
  };
  refused<SphereDiffeomorphism>("sphere_map.rotation", Eigen::MatrixXd(2 * Mat3::Identity()), exponentials);
  refused<SphereDiffeomorphism>("sphere_map.rotation", Eigen::MatrixXd(-Mat3::Identity()), exponentials);
  refused<SphereDiffeomorphism>("sphere_map.increments", number(4), exponentials);
  refused<SphereDiffeomorphism>("sphere_map.increments", number(-1), exponentials);
  refused<SphereDiffeomorphism>("sphere_map.increment.0", Eigen::MatrixXd(Eigen::MatrixXd::Zero(8, 2)), exponentials);
  refused<SphereDiffeomorphism>("sphere_map.increment.0", Eigen::MatrixXd(Eigen::MatrixXd::Zero(9, 1)), exponentials);
  refused<SphereDiffeomorphism>("sphere_map.increment.1",
                                Eigen::MatrixXd(Eigen::MatrixXd::Constant(9, 2, std::nan(""))), exponentials);
  refused<SphereDiffeomorphism>("sphere_map.increment.1", Eigen::MatrixXd(Eigen::MatrixXd::Constant(25, 2, 3.0)),
                                exponentials);

  using Linear = PiecewiseLinearDiffeomorphism;
  const Mat3X images = linear().images();
  refused<Linear>("sphere_map.images", Eigen::MatrixXd(-images), triangles);
  refused<Linear>("sphere_map.images", Eigen::MatrixXd(images.leftCols(9)), triangles);
  refused<Linear>("sphere_map.images", Eigen::MatrixXd(1.1 * images), triangles);
  refused<Linear>("sphere_map.images", Eigen::MatrixXd(std::nan("") * images), triangles);
  refused<Linear>("sphere_map.vertices", Eigen::MatrixXd(images.topRows(2)), triangles);
  Archive::Integers faces = linear().faces().cast<std::int64_t>();
  faces(0) = images.cols();
  refused<Linear>("sphere_map.faces", faces, triangles);
  faces(0) = (std::int64_t(1) << 40);
  refused<Linear>("sphere_map.faces", faces, triangles);
  refused<Linear>("sphere_map.faces", Archive::Integers(3, 0), triangles);
}

}  // namespace sphere_map_archive_test
