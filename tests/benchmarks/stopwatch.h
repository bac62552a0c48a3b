// Wall time and the process's CPU time of one call.
#pragma once

#include <chrono>
#include <ctime>
#include <limits>

namespace tiltmap::benchmarks {

struct Timing {
  double wall_ms = std::numeric_limits<double>::infinity();
  double cpu_ms = std::numeric_limits<double>::infinity();  // of all threads of this process

  // Each figure's own least: what the call takes when nothing else disturbs it.
  void keepQuietest(const Timing& other) {
    if (other.wall_ms < wall_ms) wall_ms = other.wall_ms;
    if (other.cpu_ms < cpu_ms) cpu_ms = other.cpu_ms;
  }
};

inline double processCpuMs() {
  std::timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_nsec) * 1e-6;
}

template <class Call>
Timing timed(Call&& call) {
  using Clock = std::chrono::steady_clock;
  const double cpu = processCpuMs();
  const auto begin = Clock::now();
  call();
  const auto end = Clock::now();
  return {std::chrono::duration<double, std::milli>(end - begin).count(), processCpuMs() - cpu};
}

}  // namespace tiltmap::benchmarks
