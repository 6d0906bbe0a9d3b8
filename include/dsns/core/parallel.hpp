#pragma once
/// Threads are spawned only where a caller asks for more than one.
#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace dsns {

/// Calls body(i) for i in [0, n) on up to `threads` threads (the caller's among them). Which thread runs which i is
/// unspecified: a result that must not depend on the thread count belongs into slot i.
/// throws   the first exception a body threw, after all threads have stopped
template <class Body>
void parallel_for(int n, int threads, const Body& body) {
  const int workers = std::min(threads, n);
  if (workers <= 1) {
    for (int i = 0; i < n; ++i) body(i);
    return;
  }
  std::atomic<int> next{0};
  std::exception_ptr failure;
  std::mutex failure_lock;
  const auto work = [&] {
    try {
      for (int i = next++; i < n; i = next++) body(i);
    } catch (...) {
      const std::lock_guard lock(failure_lock);
      if (!failure) failure = std::current_exception();
      next = n;
    }
  };
  {
    std::vector<std::jthread> pool;
    for (int k = 1; k < workers; ++k) pool.emplace_back(work);
    work();
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace dsns
