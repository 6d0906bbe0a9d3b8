#include "catch.hpp"
#include "support/temporary_folder.hpp"

#include <dsns/nn/fit_separable.hpp>

namespace training_archive_test {

using namespace dsns;

namespace {

/// A sphere that swells at one side.
struct Swelling {
  double swell = 0.3;
  template <class T>
  Vec3<T> operator()(const Vec3<T>& s, const T& t) const {
    const T r = 1 + swell * t * s.x() * s.y();
    return {r * s.x(), r * s.y() + t, r * s.z()};
  }
};
static_assert(AnimatedSurface<Swelling>);

FitOptions general() {
  FitOptions o;
  o.encoding = {.harmonic_degree = 2, .time_frequencies = 1};
  o.width = 8;
  o.blocks = 1;
  o.points = 100;
  o.times = 5;
  o.batch = 90;
  o.steps = 230;
  o.seed = 5;
  return o;
}

SeparableFitOptions separable() {
  SeparableFitOptions o;
  o.frames = 6;
  o.harmonic_degree = 1;
  o.encoding = {.harmonic_degree = 3, .time_frequencies = 0};
  o.width = 8;
  o.blocks = 1;
  o.points = 200;
  o.batch = 90;
  o.steps = 230;
  o.seed = (std::uint64_t(3) << 40) + 5;
  return o;
}

FitSummary training(const FitSummary& s) { return s; }
FitSummary training(const SeparableFitSummary& s) { return s.training; }

template <class Options>
auto fit(const Options& o, const Swelling& target = {}) {
  if constexpr (std::is_same_v<Options, FitOptions>)
    return fit_neural_surface(target, o);
  else
    return fit_separable_surface(target, o);
}

template <class S>
std::string bytes_of(const S& surface) {
  Archive archive;
  store_surface(archive, surface);
  return to_bytes(archive);
}

/// All checkpoints of a fit, as files hold them.
template <class Options>
std::vector<Archive> checkpoints(Options o) {
  std::vector<Archive> all;
  o.checkpoint.every = 0;
  o.checkpoint.write = [&](const Archive& a) { all.push_back(parse_archive(to_bytes(a), "walk.part")); };
  fit(o);
  return all;
}

template <class Options>
void check_goes_on(Options o) {
  const auto whole = fit(o);
  const std::vector<Archive> saved = checkpoints(o);
  REQUIRE(saved.size() == 231);  // before every step and after the last
  for (const std::size_t k : {0u, 1u, 2u, 57u, 129u, 229u, 230u}) {
    CAPTURE(k);
    Options rest = o;
    rest.threads = 2;
    rest.checkpoint.resume = &saved[k];
    int first = -1;
    rest.checkpoint.every = 1e9;
    rest.checkpoint.write = [&](const Archive& a) {
      if (first < 0) first = static_cast<int>(a.integer("training.steps"));
    };
    const auto resumed = fit(rest);
    CHECK(first == int(k));
    CHECK(bytes_of(resumed.surface) == bytes_of(whole.surface));
    CHECK(training(resumed.summary).loss == training(whole.summary).loss);
    CHECK(training(resumed.summary).steps == 230);
    CHECK(training(resumed.summary).stopped == FitStop::steps);
  }
  // The surface of the last checkpoint is the result.
  const Mat3X s = Mat3X::Identity(3, 3);
  CHECK((surface_from(saved.back()).positions(s, 0.4) - whole.surface.positions(s, 0.4)).norm() < 1e-5);
}

template <class Options>
std::string refusal(const Archive& saved, Options o, const Swelling& target = {}) {
  o.checkpoint.resume = &saved;
  const std::string s = test::complaint<InvalidArgument>([&] { fit(o, target); });
  CHECK(test::is_one_sentence(s));
  CAPTURE(s);
  CHECK(s.rfind("walk.part is of ", 0) == 0);
  return s;
}

}  // namespace

TEST_CASE("training archive: a general fit goes on to the same bits from anywhere", "[nn]") {
  FitOptions o = general();
  o.optimizer.kind = GENERATE(OptimizerKind::soap, OptimizerKind::adam, OptimizerKind::rmsprop);
  if (o.optimizer.kind == OptimizerKind::adam) o.loss.tangents = 0.1;
  check_goes_on(o);
}

TEST_CASE("training archive: a separable fit goes on to the same bits from anywhere", "[nn]") {
  check_goes_on(separable());
}

TEST_CASE("training archive: a fit in double precision goes on to the same bits", "[nn]") {
  FitOptions o = general();
  const auto run = [&] { return detail::fit_layout<double, jet_layouts::value>(Swelling{}, o, {}); };
  const std::string whole = bytes_of(run().surface);
  std::vector<Archive> saved;
  o.checkpoint.every = 0;
  o.checkpoint.write = [&](const Archive& a) { saved.push_back(a); };
  run();
  o.checkpoint = {.resume = &saved[99]};
  CHECK(bytes_of(run().surface) == whole);
  CHECK(bytes_of(surface_from<NeuralSurface>(saved.back())) == whole);
  CHECK_THROWS_AS(fit(o), Error);  // in single precision
}

TEST_CASE("training archive: a fit that reached its target stays there", "[nn]") {
  FitOptions o = general();
  o.target_msd = 1.001 * fit(o).summary.loss[60];
  const FitResult whole = fit(o);
  REQUIRE(whole.summary.stopped == FitStop::target_msd);
  const std::vector<Archive> saved = checkpoints(o);
  o.checkpoint.resume = &saved.back();
  const FitResult again = fit(o);
  CHECK(again.summary.stopped == FitStop::target_msd);
  CHECK(again.summary.steps == whole.summary.steps);
  CHECK(bytes_of(again.surface) == bytes_of(whole.surface));
}

TEST_CASE("training archive: seconds that were spent are not given again", "[nn]") {
  FitOptions o = general();
  o.steps = 10000000;
  o.seconds = 1e5;
  Archive saved("walk.part");
  struct Enough {};
  o.checkpoint.every = 0;
  o.checkpoint.write = [&](const Archive& a) {
    saved = a;
    if (a.integer("training.steps") == 20) throw Enough();
  };
  CHECK_THROWS_AS(fit(o), Enough);
  const double budget = saved.number("training.budget");  // what the preparation left
  CHECK(budget <= 1e5);
  CHECK(budget > 1e5 - 1000);
  CHECK(saved.number("training.seconds") > 0);
  CHECK(saved.number("training.seconds") < 1e4);
  saved.set("training.seconds", budget - 0.02);
  o.checkpoint = {.resume = &saved};
  const FitSummary rest = fit(o).summary;
  CHECK(rest.stopped == FitStop::seconds);
  CHECK(rest.steps > 20);
  saved.set("training.seconds", budget);
  CHECK(fit(o).summary.steps == 20);
}

TEST_CASE("training archive: a checkpoint of another fit is refused", "[nn]") {
  const Archive saved = checkpoints(general())[40];
  CHECK_NOTHROW([&] {
    FitOptions o = general();
    o.checkpoint.resume = &saved;
    fit(o);
  }());
  const auto with = [](auto change) {
    FitOptions o = general();
    change(o);
    return o;
  };
  CHECK(refusal(saved, with([](FitOptions& o) { o.width = 9; })).find("'width' is 8 there and 9 here") !=
        std::string::npos);
  refusal(saved, with([](FitOptions& o) { o.steps = 231; }));
  refusal(saved, with([](FitOptions& o) { o.seconds = 9; }));
  refusal(saved, with([](FitOptions& o) { o.seed = std::uint64_t(1) << 63 | 5; }));
  refusal(saved, with([](FitOptions& o) { o.encoding.harmonic_decay = 1; }));
  refusal(saved, with([](FitOptions& o) { o.optimizer.kind = OptimizerKind::adam; }));
  refusal(saved, with([](FitOptions& o) { o.optimizer.soap.refresh = 3; }));
  refusal(saved, with([](FitOptions& o) { o.loss.normals = 1; }));
  refusal(saved, general(), Swelling{0.31});
  refusal(saved, separable());
  const Archive other = checkpoints(separable())[3];
  refusal(other, general());
  refusal(other, separable(), Swelling{0.31});
}

TEST_CASE("training archive: a checkpoint without a training, or with a false one, is refused", "[nn]") {
  const Archive saved = checkpoints(general())[40];
  const auto refuse = [&](const std::string& array, const Archive::Value& value) {
    Archive archive = saved;
    archive.set(array, value);
    FitOptions o = general();
    o.checkpoint.resume = &archive;
    CAPTURE(array);
    CHECK(test::is_one_sentence(test::complaint<FileError>([&] { fit(o); })));
  };
  const auto number = [](double x) { return Eigen::MatrixXd(Eigen::MatrixXd::Constant(1, 1, x)); };
  const auto integer = [](std::int64_t x) { return Archive::Integers(Archive::Integers::Constant(1, 1, x)); };
  refuse("training.steps", integer(-1));
  refuse("training.steps", integer(std::int64_t(1) << 40));
  refuse("training.steps", integer(200));  // with the errors of 40
  refuse("training.seconds", number(std::nan("")));
  refuse("training.seconds", number(1e300));
  refuse("training.loss", number(1));
  refuse("training.parameters", number(1));
  refuse("optimizer.steps", integer(-5));
  refuse("optimizer.moment", Eigen::MatrixXf(3, 1));
  Archive bare;
  store_surface(bare, surface_from<BasicNeuralSurface<float>>(saved));
  FitOptions o = general();
  o.checkpoint.resume = &bare;
  CHECK_THROWS_AS(fit(o), FileError);
}

}  // namespace training_archive_test
