// A fit that is killed twenty times, at random moments, leaves a loadable checkpoint each time and goes on from it to the
// surface that it gives undisturbed, to the last bit.
#if defined(__unix__) || defined(__APPLE__)
#include "catch.hpp"
#include "support/temporary_folder.hpp"

#include <dsns/io/archive_file.hpp>
#include <dsns/nn/fit_separable.hpp>

#include <sys/wait.h>
#include <unistd.h>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <optional>
#include <random>
#include <thread>

namespace fit_survives_kill_test {

using namespace dsns;

namespace {

struct Wave {
  template <class T>
  Vec3<T> operator()(const Vec3<T>& s, const T& t) const {
    using std::sin;
    return {s.x() * (2 + sin(3 * s.z() + 6 * t)), s.y() + t * s.x() * s.x(), s.z()};
  }
};

SeparableFitOptions options() {
  SeparableFitOptions o;
  o.frames = 8;
  o.harmonic_degree = 2;
  o.encoding.harmonic_degree = 4;
  o.width = 16;
  o.points = 500;
  o.batch = 128;
  o.steps = 1000;
  o.checkpoint.every = 0.003;
  return o;
}

/// A process of its own that fits, from the checkpoint where there is one, and leaves the checkpoint of the last step.
pid_t start_fit(const std::filesystem::path& path) {
  const pid_t child = fork();
  if (child != 0) return child;
  int status = 0;
  try {
    SeparableFitOptions o = options();
    std::optional<Archive> stopped;
    if (std::filesystem::exists(path)) stopped = read_archive(path);
    o.checkpoint.resume = stopped ? &*stopped : nullptr;
    o.checkpoint.write = [&](const Archive& archive) { write_archive(path, archive); };
    fit_separable_surface(Wave{}, o);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    status = 1;
  }
  _exit(status);
}

/// Whether the process ended by itself, and well; waits for it.
bool ended_well(pid_t child) {
  int status = 0;
  return waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

std::int64_t steps_of(const Archive& checkpoint) {
  surface_from(checkpoint);
  return checkpoint.integer("training.steps");
}

}  // namespace

TEST_CASE("fit: killed twenty times it goes on to the same surface", "[nn]") {
  const test::TemporaryFolder folder;
  const auto path = folder / "fit.part";
  std::mt19937 random(std::random_device{}());
  std::optional<std::chrono::steady_clock::duration> start;
  for (int killed = 0; killed < 20;) {
    const std::int64_t before = std::filesystem::exists(path) ? steps_of(read_archive(path)) : 0;
    const auto born = std::chrono::steady_clock::now();
    const pid_t child = start_fit(path);
    REQUIRE(child > 0);
    siginfo_t ended{};
    while (!std::filesystem::exists(path) && ended.si_pid == 0) {
      std::this_thread::yield();
      waitid(P_PID, id_t(child), &ended, WEXITED | WNOHANG | WNOWAIT);
    }
    if (!start) start = std::chrono::steady_clock::now() - born;  // what this machine needs before the first step
    std::this_thread::sleep_for(std::chrono::milliseconds(random() % 60) + *start * (random() % 1000) / 500);
    kill(child, SIGKILL);
    int status = 0;
    waitpid(child, &status, 0);
    REQUIRE(std::filesystem::exists(path));
    const std::int64_t after = steps_of(read_archive(path));  // throws where it cannot be read
    REQUIRE(after >= before);
    if (WIFEXITED(status)) {  // it was done before the kill: once more from the start
      REQUIRE(WEXITSTATUS(status) == 0);
      std::filesystem::remove(path);
    } else {
      ++killed;
    }
  }
  REQUIRE(ended_well(start_fit(path)));

  SeparableFitOptions undisturbed = options();
  Archive whole;
  undisturbed.checkpoint = {.write = [&](const Archive& archive) { whole = archive; }, .every = 1e9};
  fit_separable_surface(Wave{}, undisturbed);
  const Archive resumed = read_archive(path);
  for (const char* array : {"training.parameters", "optimizer.moment", "optimizer.square"})
    CHECK(resumed.get<Eigen::MatrixXf>(array) == whole.get<Eigen::MatrixXf>(array));
  CHECK(resumed.get<Eigen::MatrixXd>("training.loss") == whole.get<Eigen::MatrixXd>("training.loss"));
  CHECK(resumed.integer("training.steps") == options().steps);
  const auto some = [](const Archive& archive) { return surface_from(archive).positions(Mat3X::Identity(3, 3), 0.3); };
  CHECK(some(resumed) == some(whole));
}

}  // namespace fit_survives_kill_test
#endif
