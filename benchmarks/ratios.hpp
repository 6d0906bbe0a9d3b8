#pragma once
/// Two pieces of code timed in turns in one process: on a shared machine only their ratio means something.
#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <map>
#include <string>
#include <vector>

/// Time of this thread alone: other processes do not count.
inline double seconds() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

struct Timing {
  double microseconds, ratio;
};

/// Medians over several turns of a, then b.
template <class A, class B>
Timing side_by_side(const A& a, const B& b) {
  const auto repetitions = [](const auto& f) {
    f();
    const double start = seconds();
    f();
    return std::max(1, int(0.01 / std::max(seconds() - start, 1e-9)));
  };
  const int na = repetitions(a), nb = repetitions(b);
  std::vector<double> times, ratios;
  const double stop = seconds() + 1;
  while (times.size() < 15 && (times.size() < 5 || seconds() < stop)) {
    const double start = seconds();
    for (int i = 0; i < na; ++i) a();
    const double middle = seconds();
    for (int i = 0; i < nb; ++i) b();
    const double end = seconds();
    times.push_back((middle - start) / na);
    ratios.push_back(times.back() / ((end - middle) / nb));
  }
  const auto median = [](std::vector<double>& v) {
    std::nth_element(v.begin(), v.begin() + std::ptrdiff_t(v.size() / 2), v.end());
    return v[v.size() / 2];
  };
  return {1e6 * median(times), median(ratios)};
}

/// Ratios by row and column.
using Results = std::map<std::string, std::map<std::string, double>>;

/// {row: {column: ratio}}
/// returns  whether the file could be written, after saying so where it could not
inline bool write_json(const Results& results, const std::string& path) {
  std::ofstream file(path);
  const char* separator = "{";
  for (const auto& [name, row] : results) {
    file << separator << "\n  \"" << name << "\": {";
    const char* comma = "";
    for (const auto& [column, ratio] : row) {
      file << comma << '"' << column << "\": " << ratio;
      comma = ", ";
    }
    file << '}';
    separator = ",";
  }
  file << "\n}\n";
  if (file.flush()) return true;
  std::fprintf(stderr, "cannot write %s\n", path.c_str());
  return false;
}
