#pragma once

#include <algorithm>
#include <ctime>
#include <functional>
#include <vector>

// What all benchmarks measure with. Ratios are of medians of rounds in which the contestants take turns, so that a
// change of the clock or of the neighbours' load meets all of them alike.
namespace rubato::benchmarks {

/// CPU time of this process [s].
inline double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

inline double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Median CPU time of each task [s], over `rounds` rounds in turn after one that warms up.
inline std::vector<double> median_times(const std::vector<std::function<void()>>& tasks, int rounds) {
  std::vector<std::vector<double>> times(tasks.size());
  for (int round = -1; round < rounds; ++round)
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      const double start = cpu_seconds();
      tasks[i]();
      if (round >= 0) times[i].push_back(cpu_seconds() - start);
    }
  std::vector<double> medians;
  for (const auto& of_task : times) medians.push_back(median(of_task));
  return medians;
}

/// Keeps the compiler from dropping a computation whose result nobody reads.
inline void keep(double value) { asm volatile("" : : "x"(value) : "memory"); }

}  // namespace rubato::benchmarks
