// Whole simulated drives through the program: registered, chained, relaxed, over several seeds.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <utility>

#include "core/world/experiment.h"
#include "tests/benchmarks/table.h"

namespace tiltmap::benchmarks {

// `tiltmap register` and `tiltmap relax` as processes on one thread: the median over the seeds of their wall
// and CPU time, what they say themselves (without start, reading and storing the project), and the root mean
// square error over the stops but the first, median and worst over the seeds, against the truth and the noise
// floor.
void addDriveRows(Table& table, ExperimentId experiment, std::pair<int, int> seeds,
                  const std::filesystem::path& program, const std::filesystem::path& scratch, int rounds,
                  const std::function<void(const std::string&)>& tell);

}  // namespace tiltmap::benchmarks
