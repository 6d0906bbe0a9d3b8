#include <dsns/core/errors.hpp>
#include <dsns/core/parallel.hpp>

#include <atomic>
#include <thread>
#include <vector>

#include "catch.hpp"

namespace parallel_test {

using namespace dsns;

TEST_CASE("parallel_for visits every index once for any number of threads", "[parallel]") {
  const int threads = GENERATE(0, 1, 2, 7);
  const int n = GENERATE(0, 1, 3, 1000);
  std::vector<int> visits(static_cast<std::size_t>(n), 0);
  parallel_for(n, threads, [&](int i) { ++visits[static_cast<std::size_t>(i)]; });
  for (const int count : visits) REQUIRE(count == 1);
}

TEST_CASE("parallel_for with one thread stays on the caller's, in order", "[parallel]") {
  std::vector<int> order;
  const auto caller = std::this_thread::get_id();
  parallel_for(5, 1, [&](int i) {
    CHECK(std::this_thread::get_id() == caller);
    order.push_back(i);
  });
  CHECK(order == std::vector{0, 1, 2, 3, 4});
}

TEST_CASE("parallel_for runs bodies at the same time", "[parallel]") {
  // Each body waits for the other: one thread alone would never get past the first.
  std::atomic<int> arrived{0};
  parallel_for(2, 2, [&](int) {
    ++arrived;
    while (arrived < 2) std::this_thread::yield();
  });
  CHECK(arrived == 2);
}

TEST_CASE("parallel_for passes a body's exception on and starts no further work", "[parallel]") {
  const int threads = GENERATE(1, 4);
  std::atomic<int> calls{0};
  const auto body = [&](int i) {
    ++calls;
    require<UnusableMesh>(i != 0, "frame 0 is broken");
    std::this_thread::yield();
  };
  CHECK_THROWS_AS(parallel_for(1'000'000, threads, body), UnusableMesh);
  CHECK(calls < 1'000'000);
}

}  // namespace parallel_test
