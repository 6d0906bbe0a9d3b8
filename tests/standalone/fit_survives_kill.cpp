// A fit that is killed twenty times, at random moments, leaves a loadable checkpoint each time and goes on from it to the
// surface that it gives undisturbed, to the last bit.
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

/// Fits, from the checkpoint where there is one, and leaves the checkpoint of the last step.
[[noreturn]] void fit_in_child(const std::filesystem::path& path) {
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

std::int64_t steps_of(const Archive& checkpoint) {
  surface_from(checkpoint);
  return checkpoint.integer("training.steps");
}

}  // namespace

int main() {
  const auto folder = std::filesystem::temp_directory_path() / message("dsns_killed_", std::random_device{}());
  std::filesystem::create_directories(folder);
  const auto path = folder / "fit.part";
  int failures = 0, killed = 0;
  try {
    std::mt19937 random(std::random_device{}());
    std::optional<std::chrono::steady_clock::duration> start;
    while (killed < 20) {
      const std::int64_t before = std::filesystem::exists(path) ? steps_of(read_archive(path)) : 0;
      const auto born = std::chrono::steady_clock::now();
      const pid_t child = fork();
      if (child == 0) fit_in_child(path);
      while (!std::filesystem::exists(path)) std::this_thread::yield();
      if (!start) start = std::chrono::steady_clock::now() - born;  // what this machine needs before the first step
      std::this_thread::sleep_for(std::chrono::milliseconds(random() % 60) + *start * (random() % 1000) / 500);
      kill(child, SIGKILL);
      int status = 0;
      waitpid(child, &status, 0);
      const std::int64_t after = steps_of(read_archive(path));  // throws where it cannot be read
      failures += after < before;
      if (WIFEXITED(status)) {  // it was done before the kill: once more from the start
        failures += WEXITSTATUS(status) != 0;
        std::filesystem::remove(path);
        continue;
      }
      std::printf("kill %d at step %lld\n", ++killed, static_cast<long long>(after));
    }
    const pid_t child = fork();
    if (child == 0) fit_in_child(path);
    int status = 0;
    waitpid(child, &status, 0);
    failures += !WIFEXITED(status) || WEXITSTATUS(status) != 0;

    SeparableFitOptions undisturbed = options();
    Archive whole;
    undisturbed.checkpoint = {.write = [&](const Archive& archive) { whole = archive; }, .every = 1e9};
    fit_separable_surface(Wave{}, undisturbed);
    const Archive resumed = read_archive(path);
    for (const char* array : {"training.parameters", "optimizer.moment", "optimizer.square"})
      failures += resumed.get<Eigen::MatrixXf>(array) != whole.get<Eigen::MatrixXf>(array);
    failures += resumed.get<Eigen::MatrixXd>("training.loss") != whole.get<Eigen::MatrixXd>("training.loss");
    failures += resumed.integer("training.steps") != options().steps;
    const auto some = [](const Archive& archive) {
      return surface_from(archive).positions(Mat3X::Identity(3, 3), 0.3);
    };
    failures += some(resumed) != some(whole);
    std::printf("%d kills, %d failures, final error %.3g and undisturbed %.3g\n", killed, failures,
                resumed.get<Eigen::MatrixXd>("training.loss").reshaped().tail<1>()[0],
                whole.get<Eigen::MatrixXd>("training.loss").reshaped().tail<1>()[0]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    ++failures;
  }
  std::filesystem::remove_all(folder);
  return failures == 0 ? 0 : 1;
}
