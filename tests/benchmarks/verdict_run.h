// Whether the program's verdicts can be trusted: right and wrong registrations, good and bad stops.
#pragma once

#include <functional>
#include <string>
#include <utility>

#include "tests/benchmarks/table.h"

namespace tiltmap::benchmarks {

// What is promised. Thresholds were tuned on seeds above 100 only.
inline constexpr double kRightCalledGood = 0.9;  // share of right registrations, and of good stops
inline constexpr std::size_t kFewestWrong = 200, kFewestRight = 500;

// Registrations: over the simulated experiments and the real scans that are there. Adds a row for each kind,
// a sum, and how honest the covariances are. False where a wrong one was called good, too few right ones
// were, or the normalised errors squared are out of their chi-square bounds.
bool addVerdictRows(Table& table, std::pair<int, int> seeds,
                    const std::function<void(const std::string&)>& tell);
// Stops at the last line: good ones, too far ones, blocked views, dirty windows, other places, odometry that
// lies. False where a bad one was told to move on, or too few good ones were.
bool addStopRows(Table& table, std::pair<int, int> seeds,
                 const std::function<void(const std::string&)>& tell);

}  // namespace tiltmap::benchmarks
