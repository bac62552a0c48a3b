// The pairs that registration is held against: simulated ones with their truth, and real scans.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/world/experiment.h"
#include "tests/benchmarks/pair_method.h"
#include "tests/benchmarks/table.h"

namespace tiltmap::benchmarks {

// Neighbours (i, i + 1) of one simulated drive, from its odometry.
std::vector<PairProblem> simulatedPairs(ExperimentId experiment, std::uint64_t seed);

// The folder of real scans: TILTMAP_SHARED_DATA, else ../shared/data beside the checkout; empty where absent.
std::filesystem::path sharedData();

// Runs the methods over each real set that is there and adds its rows; a note for each that is not.
void addRealRows(Table& table, const std::vector<PairMethod>& methods, int rounds,
                 const std::function<void(const std::string&)>& tell);

}  // namespace tiltmap::benchmarks
