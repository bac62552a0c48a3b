// A program run as a process, its times and what it printed.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/benchmarks/stopwatch.h"

namespace tiltmap::benchmarks {

using Arguments = std::vector<std::string>;

struct Ended {
  int exit_code = -1;  // -1: could not be started, or ended by a signal
  Timing timing;
  double peak_mb = 0.0;  // of its resident memory
  std::string output;  // standard output
};

// Files for its output are made in `scratch`.
Ended run(const std::filesystem::path& program, const Arguments& arguments,
          const std::filesystem::path& scratch);

}  // namespace tiltmap::benchmarks
